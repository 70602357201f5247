//! The tests, one per file.

mod autocorrelation;
mod bound;
mod collapse;
mod cross_correlation;
mod depletion;
mod divergence;
mod errors;
mod growth;
mod innovations;
mod line;
mod mean;
mod range;
mod recovery;

use super::evidence::Test;

/// Every test. A new one is a file and a line here.
pub static TESTS: &[&Test] = &[
    &divergence::TEST,
    &range::TEST,
    &collapse::TEST,
    &depletion::TEST,
    &growth::WIND_UP,
    &errors::ELLIPSOID,
    &errors::CHANNELS,
    &innovations::SENSORS,
    &innovations::TOGETHER,
    &autocorrelation::TEST,
    &cross_correlation::TEST,
    &mean::TEST,
    &line::TEST,
    &growth::UNLEARNT,
    &bound::TEST,
    &recovery::TEST,
];
