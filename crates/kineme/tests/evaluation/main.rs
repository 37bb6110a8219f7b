//! Metrics over clips and streams, and the baselines beside which recognisers stand.

mod baselines;
mod clips;
mod paces;
mod routes;
mod streams;
