//! Laws of the loop through a body: what disturbs it is taken in and given back, and nothing grows.
