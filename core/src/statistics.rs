//! Numbers that follow from samples: scores, diagnostics, spectra, bounds, free runs, start values.

pub(crate) mod cramer_rao;
pub mod diagnostics;
pub mod free_decay;
pub mod free_run;
pub mod frequency_response;
pub(crate) mod model_classes;
pub mod score;
pub(crate) mod spectrum;
pub mod suggest;
