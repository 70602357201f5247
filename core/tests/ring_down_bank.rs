//! Start values of free decays without an input, made here and not by the core.

use kalmanscope_core::Quantity;

use crate::ring_down::{RingDown, right};

#[test]
fn start_values_of_a_decay_are_right() {
    let share = right(0..40);
    assert!(share >= 0.95, "{share}");
}

#[test]
fn a_decay_that_ends_in_noise_has_good_start_values() {
    let decay = RingDown {
        natural_frequency: 6.0,
        damping_ratio: 0.05,
        rate: 50.0,
        periods: 80.0,
        sensor: Quantity::DISPLACEMENT,
        noise: 0.02,
        seed: 3,
    };
    let (is_right, text) = decay.outcome();
    assert!(is_right, "{text}");
}
