//! Round numbers along axes, linear or logarithmic.

use std::ops::RangeInclusive;

use egui_plot::GridMark;

use crate::text::{fixed, significant};

/// Multiples of 1, 2 or 5 times a power of ten: about `count`, at least two if they fit, as one tick shows no scale.
pub(crate) fn ticks((low, high): (f64, f64), count: f32) -> Vec<GridMark> {
    let rough = (high - low) / f64::from(count.max(2.0));
    if !rough.is_finite() || rough <= 0.0 {
        return Vec::new();
    }
    let decade = 10_f64.powf(rough.log10().floor());
    let steps = [10.0, 5.0, 2.0, 1.0, 0.5].map(|m| m * decade);
    let marks = |step_size: f64| {
        let (first, last) = ((low / step_size).ceil() as i64, (high / step_size).floor() as i64);
        (first..=last).map(move |i| GridMark { value: i as f64 * step_size, step_size })
    };
    let chosen = steps.iter().rposition(|step| *step >= rough).unwrap_or(0);
    let finer = steps.iter().skip(chosen + 1).map(|step| marks(*step));
    let finer = finer.take_while(|marks| marks.clone().count() as f32 <= CROWDED * count);
    let coarse = marks(steps[chosen]);
    std::iter::once(coarse.clone()).chain(finer).find(|marks| marks.clone().count() > 1).unwrap_or(coarse).collect()
}

/// [`tick`], but empty if the text would be cut off at the right or overlap the other axis's texts at the bottom.
pub(crate) fn tick_inside(mark: GridMark, range: &RangeInclusive<f64>, length: f32, side: Side) -> String {
    let text = tick(mark.value, mark.step_size);
    let share = (mark.value - range.start()) / (range.end() - range.start());
    let (room, least) = match side {
        Side::Bottom => (1.0 - share, HALF_DIGIT * text.chars().count() as f32),
        Side::Left => (share, HALF_LINE),
    };
    if room as f32 * length < least { String::new() } else { text }
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    Bottom,
    Left,
}

/// Half the width and half the height of a tick's text, approximately \[points\].
const HALF_DIGIT: f32 = 3.4;
const HALF_LINE: f32 = 4.0;

/// Limits the number of ticks relative to the request, above which labels overlap.
const CROWDED: f32 = 2.2;

pub(crate) fn tick(value: f64, step: f64) -> String {
    if step < 1e-4 && value.abs() < 100.0 * step {
        return significant(if value.abs() < 1e-3 * step { 0.0 } else { value }, 3);
    }
    let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
    // Zero may be 1e-17 by rounding, and must not be labelled as -0.
    fixed(if value.abs() < 1e-3 * step { 0.0 } else { value }, decimals)
}

/// Ticks of an axis of logarithms: multiples of powers of ten where labels `apart` from each other fit at 1, 2 and 5,
/// else the powers alone, and round numbers where the axis shows less than a decade \[points\].
pub(crate) fn log_ticks((low, high): (f64, f64), length: f32, apart: f32) -> Vec<GridMark> {
    let decade = f64::from(length / apart) / (high - low);
    if !decade.is_finite() || decade <= 0.0 {
        return Vec::new();
    }
    if high - low < LESS_THAN_A_DECADE {
        let linear = ticks((10_f64.powf(low), 10_f64.powf(high)), length / apart);
        return linear.iter().map(|mark| GridMark { value: mark.value.log10(), step_size: LABELLED }).collect();
    }
    // The condition is two labels within 0.3 decades, the distance from 1 to 2.
    let labelled = |digit: i32| digit == 1 || (decade >= 1.8 && matches!(digit, 2 | 5));
    let every = if decade < 0.6 { (0.6 / decade).ceil() as i32 } else { 1 };
    // A plot may be zoomed out without end, but there are no more powers than these.
    let powers = low.max(-MOST_DECADES).floor() as i32..=high.min(MOST_DECADES).ceil() as i32;
    let powers = powers.filter(|power| power % every == 0);
    let mark = |power: i32, digit: i32| GridMark {
        value: f64::from(power) + f64::from(digit).log10(),
        step_size: match digit {
            1 => f64::from(every),
            _ if labelled(digit) => LABELLED,
            _ => UNLABELLED,
        },
    };
    let digits = if decade < 0.9 { 1..=1 } else { 1..=9 };
    let marks = powers.flat_map(|power| digits.clone().map(move |digit| mark(power, digit)));
    marks.filter(|mark| (low..=high).contains(&mark.value)).collect()
}

/// Labels of a logarithmic axis are chosen with its ticks, and fade only where none would fit \[points\].
pub(crate) const LOG_TICKS_FADE: egui::Rangef = egui::Rangef { min: 6.0, max: 10.0 };
/// Limits the range in which multiples of a power of ten would be too few \[decades\].
const LESS_THAN_A_DECADE: f64 = 0.7;
/// Limits the powers of ten that are marked: there are no greater numbers.
const MOST_DECADES: f64 = 308.0;
const LABELLED: f64 = 0.3;
const UNLABELLED: f64 = 0.05;

pub(crate) fn log_tick(mark: GridMark) -> String {
    if mark.step_size >= LABELLED { significant(10_f64.powf(mark.value), 3) } else { String::new() }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ValueScale {
    /// The ends; logarithms to the base of ten where the scale is logarithmic.
    pub(crate) ends: (f64, f64),
    pub(crate) is_logarithmic: bool,
}

impl ValueScale {
    pub(crate) fn new(from: f64, to: f64, is_logarithmic: bool) -> Self {
        let ends = if is_logarithmic { (from.log10(), to.log10()) } else { (from, to) };
        Self { ends, is_logarithmic }
    }

    /// `count` cells in equal steps from middle to middle of the outermost; the scale reaches half a step beyond them.
    pub(crate) fn of_cells(from: f64, to: f64, count: usize, is_logarithmic: bool) -> Self {
        let Self { ends: (from, to), .. } = Self::new(from, to, is_logarithmic);
        let steps = count.saturating_sub(1).max(1) as f64;
        let step = if from == to { 1.0 } else { (to - from) / steps };
        let half = if count > 1 { 0.5 * step } else { 0.5 };
        Self { ends: (from - half, to + half), is_logarithmic }
    }

    /// The share of the scale at which a value lies, 0 and 1 at its ends; NaN where a logarithmic scale has no such value.
    pub(crate) fn share(&self, value: f64) -> f64 {
        let (from, to) = self.ends;
        ((if self.is_logarithmic { value.log10() } else { value }) - from) / (to - from)
    }

    pub(crate) fn ticks(&self, length: f32, apart: f32) -> Vec<(f64, String)> {
        let (from, to) = self.ends;
        let bounds = (from.min(to), from.max(to));
        let marks = if self.is_logarithmic {
            log_ticks(bounds, length, apart).into_iter().map(|mark| (mark.value, log_tick(mark))).collect::<Vec<_>>()
        } else {
            ticks(bounds, length / apart)
                .into_iter()
                .map(|mark| (mark.value, tick(mark.value, mark.step_size)))
                .collect()
        };
        marks.into_iter().map(|(value, text)| ((value - from) / (to - from), text)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(bounds: (f64, f64), count: f32) -> Vec<f64> {
        ticks(bounds, count).iter().map(|mark| mark.value).collect()
    }

    #[test]
    fn an_axis_without_an_end_has_few_ticks() {
        for wide in [400.0, 1e6, 1e12, 1e300] {
            for (low, high) in [(-wide, wide), (-wide, 0.0), (0.0, wide)] {
                assert!((1..=20).contains(&log_ticks((low, high), 600.0, 75.0).len()), "{low} to {high}");
                assert!((1..=20).contains(&ticks((low, high), 8.0).len()), "{low} to {high}");
            }
        }
        assert_eq!(log_ticks((1e9, 2e9), 600.0, 75.0).len(), 0);
    }

    #[test]
    fn ticks_are_round_and_about_as_many_as_asked_for() {
        assert_eq!(values((0.0, 20.0), 5.0), [0.0, 5.0, 10.0, 15.0, 20.0]);
        assert_eq!(values((4.71, 6.3), 4.0), [5.0, 5.5, 6.0]);
        assert_eq!(values((-0.4, 1.3), 1.3), [0.0, 1.0]);
        for (count, span) in [(2.0, 0.013), (5.0, 7.7), (9.0, 41_000.0)] {
            let found = values((-0.3 * span, 0.7 * span), count).len() as f32;
            assert!(found <= count + 1.0 && found >= count / 2.5 - 1.0, "{found} ticks instead of {count}");
        }
        assert!(values((1.0, 1.0), 5.0).is_empty() && values((f64::NEG_INFINITY, f64::INFINITY), 5.0).is_empty());
    }

    #[test]
    fn a_tick_has_the_digits_that_it_needs() {
        assert_eq!(
            [tick(0.05, 0.01), tick(-2.0, 1.0), tick(1e-19, 0.5), tick(30.0, 10.0), tick(-4e-9, 2e-9)],
            ["0.05", "−2", "0.0", "30", "−4e−9"]
        );
    }
    #[test]
    fn logarithmic_ticks_are_as_dense_as_there_is_room() {
        let labels = |bounds, length| -> Vec<String> {
            log_ticks(bounds, length, 75.0).into_iter().map(log_tick).filter(|label| !label.is_empty()).collect()
        };
        assert_eq!(labels((0.0, 1.7), 400.0), ["1", "2", "5", "10", "20", "50"]);
        assert_eq!(labels((-2.1, 1.1), 300.0), ["0.01", "0.1", "1", "10"]);
        assert_eq!(labels((-4.0, 4.0), 200.0), ["0.0001", "0.01", "1", "100", "10000"]);
        assert_eq!(labels((0.74, 0.82), 400.0), ["5.5", "6", "6.5"]);
        assert_eq!(log_ticks((0.0, 1.0), 400.0, 75.0).len(), 10);
        assert!(log_ticks((1.0, 1.0), 400.0, 75.0).is_empty());
        assert!(log_ticks((f64::NEG_INFINITY, f64::INFINITY), 400.0, 75.0).is_empty());
    }

    #[test]
    fn cells_fill_the_scale() {
        for is_logarithmic in [false, true] {
            let scale = ValueScale::of_cells(1.0, 16.0, 4, is_logarithmic);
            assert!((scale.share(1.0) - 0.125).abs() < 1e-12 && (scale.share(16.0) - 0.875).abs() < 1e-12);
        }
        assert!((ValueScale::of_cells(5.0, 5.0, 1, false).share(5.0) - 0.5).abs() < 1e-12);
    }
}
