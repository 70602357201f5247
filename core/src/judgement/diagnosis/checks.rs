//! The tests.

mod estimates;
mod innovations;
mod particles;

use super::evidence::Test;

/// Every test. A new one is an item of a file and a line here.
pub static TESTS: &[&Test] = &[
    &estimates::DIVERGENCE,
    &estimates::RANGE,
    &particles::SAMPLE,
    &particles::DIVERSITY,
    &estimates::WIND_UP,
    &estimates::ELLIPSOID,
    &estimates::CHANNELS,
    &innovations::SENSORS,
    &innovations::TOGETHER,
    &innovations::WHITENESS,
    &innovations::PAIRS,
    &innovations::AT_ONCE,
    &innovations::INPUT,
    &innovations::MEAN,
    &innovations::LINES,
    &estimates::UNLEARNT,
    &estimates::BOUND,
    &estimates::RECOVERY,
];
