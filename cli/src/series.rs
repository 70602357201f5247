//! Long series as pictures: few points that keep the extremes, and the range of a value axis.

use kalmanscope_core::internals::sort_numbers;

/// A point in data coordinates: time \[s\] and value.
pub(crate) type Point = (f64, f64);

/// Samples `first..last` that share one column of the picture.
fn columns(samples: usize, columns: usize) -> impl Iterator<Item = (usize, usize)> {
    let columns = columns.clamp(1, samples.max(1));
    (0..columns).map(move |c| (c * samples / columns, (c + 1) * samples / columns)).filter(|(first, last)| first < last)
}

/// The line through `samples` values, reduced to the lowest and the highest of each column.
pub(crate) fn line(samples: usize, max_columns: usize, value: impl Fn(usize) -> Point) -> Vec<Point> {
    // The reduction would keep as many points.
    if samples <= 2 * max_columns {
        return (0..samples).map(value).collect();
    }
    let mut points = Vec::with_capacity(2 * max_columns);
    for (first, last) in columns(samples, max_columns) {
        let defined = || (first..last).map(&value).filter(|p| !p.1.is_nan());
        let low = defined().min_by(|a, b| a.1.total_cmp(&b.1));
        let high = defined().max_by(|a, b| a.1.total_cmp(&b.1));
        match (low, high) {
            (Some(low), Some(high)) if low.0 < high.0 => points.extend([low, high]),
            (Some(low), Some(high)) if low.0 > high.0 => points.extend([high, low]),
            (Some(one), _) => points.push(one),
            _ => points.push((value(first).0, f64::NAN)),
        }
    }
    points
}

/// An outline for each part without a gap. `edges` gives time, lower and upper edge of a sample; NaN for a gap.
pub(crate) fn bands(
    samples: usize,
    max_columns: usize,
    range: (f64, f64),
    edges: impl Fn(usize) -> (f64, f64, f64),
) -> Vec<Vec<Point>> {
    let mut outlines = Vec::new();
    let (mut upper, mut lower) = (Vec::new(), Vec::new());
    let mut close = |upper: &mut Vec<Point>, lower: &mut Vec<Point>| {
        upper.extend(lower.drain(..).rev());
        if upper.len() > 2 {
            outlines.push(std::mem::take(upper));
        }
        upper.clear();
    };
    for (first, last) in columns(samples, max_columns) {
        // The last column ends with the record, the others at the beginning of the next.
        let time = edges(if last == samples { last - 1 } else { first }).0;
        let low = (first..last).map(|k| edges(k).1).fold(f64::INFINITY, f64::min);
        let high = (first..last).map(|k| edges(k).2).fold(f64::NEG_INFINITY, f64::max);
        if low > high {
            close(&mut upper, &mut lower);
            continue;
        }
        upper.push((time, high.clamp(range.0, range.1)));
        lower.push((time, low.clamp(range.0, range.1)));
    }
    close(&mut upper, &mut lower);
    outlines
}

pub(crate) fn thinned(samples: usize, max: usize) -> impl Iterator<Item = usize> {
    (0..samples).step_by(samples.div_ceil(max.max(1)).max(1))
}

/// Limits the values of an axis, so that its span is finite.
const LARGEST: f64 = 1e300;

pub(crate) fn padded((low, high): (f64, f64)) -> (f64, f64) {
    let [low, high] = [low, high].map(|value| value.clamp(-LARGEST, LARGEST));
    let size = low.abs().max(high.abs());
    let span = high - low;
    // Else the rounding of a constant would fill the whole plot.
    if span > 1e-6 * size {
        (low - 0.06 * span, high + 0.06 * span)
    } else if size > 0.0 {
        (low - 0.05 * size, high + 0.05 * size)
    } else {
        (-1.0, 1.0)
    }
}

pub(crate) type Range = Option<(f64, f64)>;

pub(crate) fn union(a: Range, b: Range) -> Range {
    match (a, b) {
        (Some(a), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
        (one, other) => one.or(other),
    }
}

/// The range of the values without the `out` lowest and the `out` highest; `None` if no value is left.
pub(crate) fn without_tails(values: impl Iterator<Item = f64>, out: usize) -> Range {
    let mut values: Vec<f64> = values.filter(|x| x.is_finite()).collect();
    sort_numbers(&mut values);
    let kept = values.get(out..values.len().checked_sub(out)?)?;
    Some((*kept.first()?, *kept.last()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reduced_line_keeps_its_extremes_and_its_order() {
        let value = |k: usize| (k as f64, if k == 4321 { 50.0 } else { (k as f64 * 0.1).sin() });
        let points = line(10_000, 100, value);
        assert!(points.len() <= 200);
        assert!(points.contains(&(4321.0, 50.0)));
        assert!(points.windows(2).all(|p| p[0].0 < p[1].0));
        assert_eq!(line(150, 100, value).len(), 150);
        assert!(line(0, 100, value).is_empty());
    }

    #[test]
    fn a_band_spans_the_whole_record_within_the_range() {
        let [outline] = &bands(1000, 10, (-1.0, 1.0), |k| (k as f64, -5.0, k as f64 / 1000.0))[..] else { panic!() };
        assert_eq!(outline.len(), 20);
        assert_eq!((outline[0].0, outline[9].0), (0.0, 999.0));
        assert!(outline.iter().all(|p| (-1.0..=1.0).contains(&p.1)));
        assert_eq!(outline[19], (0.0, -1.0));
    }

    #[test]
    fn a_band_has_a_gap_where_it_is_not_known() {
        let edges = |k: usize| if k == 0 || k == 5 { (k as f64, f64::NAN, f64::NAN) } else { (k as f64, -1.0, 1.0) };
        let parts = bands(10, 100, (-2.0, 2.0), edges);
        let times = |part: &Vec<Point>| part.iter().map(|point| point.0).collect::<Vec<_>>();
        assert_eq!(
            parts.iter().map(times).collect::<Vec<_>>(),
            [vec![1.0, 2.0, 3.0, 4.0, 4.0, 3.0, 2.0, 1.0], vec![6.0, 7.0, 8.0, 9.0, 9.0, 8.0, 7.0, 6.0]]
        );
    }

    #[test]
    fn dots_are_few_and_ranges_are_whole_finite_and_never_empty() {
        for samples in [0, 1, 1499, 1500, 1501, 100_000] {
            let count = thinned(samples, 1500).count();
            assert!(count <= 1500 && (count > 0 || samples == 0), "{samples}: {count}");
        }
        let hundred: Vec<f64> = (0..=100).map(f64::from).collect();
        for (values, out, range) in [
            (&hundred[..], 0, Some((0.0, 100.0))),
            (&hundred, 10, Some((10.0, 90.0))),
            (&[f64::NAN, 3.0], 0, Some((3.0, 3.0))),
            (&[f64::NAN], 0, None),
            (&[1.0, 2.0], 1, None),
            (&[1.0, 2.0], 3, None),
        ] {
            assert_eq!(without_tails(values.iter().copied(), out), range);
        }
        for range in [(-f64::MAX, f64::MAX), (f64::MAX, f64::MAX), (-1.0, f64::MAX)] {
            let (low, high) = padded(range);
            assert!((high - low).is_finite() && high > low, "{range:?}");
        }
        for range in [(0.0, 0.0), (6.0, 6.0), (-3.0, -3.0), (1.0, 2.0)] {
            let (low, high) = padded(range);
            assert!(low < range.0 && high > range.1, "{range:?}");
        }
    }
}
