//! The range of a value axis.

use kalmanscope_core::Run;
use kalmanscope_core::internals::sort_numbers;

use super::panel::Panel;
use super::series;

/// The number of samples above which outliers are left out.
const SAMPLES: usize = 4000;

/// The range of a plot: all of the truth, nearly all of the measurements and estimates, and most of the
/// bands. It leaves out values that would flatten the rest, such as a wide initial band or a diverged filter.
pub(super) fn of(run: &Run, panel: Panel) -> (f64, f64) {
    let record = run.record();
    let out = |tail: f64| (record.len().min(SAMPLES) as f64 * tail) as usize;
    let truth = panel.truth(record).and_then(|values| without_tails(values.iter().copied(), 0));
    let seen = |values: &[f64]| {
        let thinned = series::thinned(record.len(), SAMPLES).map(|k| values[k]);
        without_tails(thinned, out(0.002))
    };
    let measured = panel.measured(record).and_then(seen);
    let mut estimated = None;
    let mut banded = None;
    for estimates in run.estimates() {
        let Some(curve) = panel.curve(estimates, record) else { continue };
        let mean = |k: usize| curve(k).0;
        let spread = |k: usize| 2.0 * curve(k).1;
        // Shares are those of the whole record, so that a filter that stopped early counts little.
        let samples = || series::thinned(record.len(), SAMPLES).filter(|&k| k < estimates.len());
        estimated = union(estimated, without_tails(samples().map(mean), out(0.005)));
        banded = union(banded, without_tails(samples().map(|k| mean(k) - spread(k)), out(0.1)));
        banded = union(banded, without_tails(samples().map(|k| mean(k) + spread(k)), out(0.1)));
    }
    let known = union(truth, measured);
    let range = match known {
        Some((low, high)) => {
            let room = 6.0 * (high - low).max(0.5 * low.abs().max(high.abs()));
            let near = |(a, b): (f64, f64)| (a.max(low - room), b.min(high + room));
            let wanted = union(estimated, banded);
            union(known, if room > 0.0 { wanted.map(near) } else { wanted })
        }
        None => union(estimated, banded),
    };
    padded(range.unwrap_or((0.0, 0.0)))
}

/// Limits the values of an axis, so that its span is finite.
const LARGEST: f64 = 1e300;

fn padded((low, high): (f64, f64)) -> (f64, f64) {
    let [low, high] = [low, high].map(|value| value.clamp(-LARGEST, LARGEST));
    let size = low.abs().max(high.abs());
    let span = high - low;
    if span > 1e-6 * size {
        (low - 0.06 * span, high + 0.06 * span)
    } else if size > 0.0 {
        (low - 0.05 * size, high + 0.05 * size)
    } else {
        (-1.0, 1.0)
    }
}

type Range = Option<(f64, f64)>;

fn union(a: Range, b: Range) -> Range {
    match (a, b) {
        (Some(a), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
        (one, other) => one.or(other),
    }
}

/// The range of the values without the `out` lowest and the `out` highest; `None` if no value is left.
fn without_tails(values: impl Iterator<Item = f64>, out: usize) -> Range {
    let mut values: Vec<f64> = values.filter(|x| x.is_finite()).collect();
    sort_numbers(&mut values);
    let kept = values.get(out..values.len().checked_sub(out)?)?;
    Some((*kept.first()?, *kept.last()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails_are_left_out() {
        let values = || (0..=100).map(f64::from);
        assert_eq!(without_tails(values(), 0), Some((0.0, 100.0)));
        assert_eq!(without_tails(values(), 10), Some((10.0, 90.0)));
        assert_eq!(without_tails([f64::NAN, 3.0].into_iter(), 0), Some((3.0, 3.0)));
        assert_eq!(without_tails([f64::NAN].into_iter(), 0), None);
        assert_eq!(without_tails([1.0, 2.0].into_iter(), 1), None);
        assert_eq!(without_tails([1.0, 2.0].into_iter(), 3), None);
    }

    #[test]
    fn a_range_can_be_divided_whatever_the_values() {
        for range in [(-f64::MAX, f64::MAX), (f64::MAX, f64::MAX), (-1.0, f64::MAX)] {
            let (low, high) = padded(range);
            assert!((high - low).is_finite() && high > low, "{range:?}");
        }
    }

    #[test]
    fn a_range_is_never_empty() {
        for range in [(0.0, 0.0), (6.0, 6.0), (-3.0, -3.0), (1.0, 2.0)] {
            let (low, high) = padded(range);
            assert!(low < range.0 && high > range.1, "{range:?}");
        }
    }
}
