//! Round numbers along an axis.

use egui_plot::GridMark;

use crate::text::fixed;

/// Multiples of 1, 2 or 5 times a power of ten, about `count` of them.
pub(super) fn ticks((low, high): (f64, f64), count: f32) -> Vec<GridMark> {
    let rough = (high - low) / f64::from(count.max(2.0));
    if !rough.is_finite() || rough <= 0.0 {
        return Vec::new();
    }
    let decade = 10_f64.powf(rough.log10().floor());
    let step_size = [1.0, 2.0, 5.0].map(|m| m * decade).into_iter().find(|s| *s >= rough).unwrap_or(10.0 * decade);
    let (first, last) = ((low / step_size).ceil() as i64, (high / step_size).floor() as i64);
    (first..=last).map(|i| GridMark { value: i as f64 * step_size, step_size }).collect()
}

/// A tick's text, with just the digits that tell it from its neighbours.
pub(super) fn tick(value: f64, step: f64) -> String {
    let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
    fixed(if value.abs() < 1e-3 * step { 0.0 } else { value }, decimals)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(bounds: (f64, f64), count: f32) -> Vec<f64> {
        ticks(bounds, count).iter().map(|mark| mark.value).collect()
    }

    #[test]
    fn ticks_are_round_and_about_as_many_as_asked_for() {
        assert_eq!(values((0.0, 20.0), 5.0), [0.0, 5.0, 10.0, 15.0, 20.0]);
        assert_eq!(values((4.71, 6.3), 4.0), [5.0, 5.5, 6.0]);
        for (count, span) in [(2.0, 0.013), (5.0, 7.7), (9.0, 41_000.0)] {
            let found = values((-0.3 * span, 0.7 * span), count).len() as f32;
            assert!(found <= count + 1.0 && found >= count / 2.5 - 1.0, "{found} ticks instead of {count}");
        }
        assert!(values((1.0, 1.0), 5.0).is_empty() && values((f64::NEG_INFINITY, f64::INFINITY), 5.0).is_empty());
    }

    #[test]
    fn a_tick_has_the_digits_that_it_needs() {
        assert_eq!(
            [tick(0.05, 0.01), tick(-2.0, 1.0), tick(1e-19, 0.5), tick(30.0, 10.0)],
            ["0.05", "−2", "0.0", "30"]
        );
    }
}
