//! Floor 5: how well a recogniser does, beside baselines. Knows the [`crate::primitive::Recogniser`] trait and no recogniser.
