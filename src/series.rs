//! Long series reduced to what a screen can show: minimum and maximum per pixel column.

use std::ops::Range;

/// The smallest and the largest value of one pixel column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// The first sample of the column.
    pub sample: usize,
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Whether it is drawn from the smallest to the largest: where it ends higher than it begins.
    pub rising: bool,
}

/// Reduces `value(k)` for the samples `k` in `range` to at most `columns` + 1 columns. Values that are not finite are left
/// out. Columns begin at multiples of their width, so that they stay put while the range slides.
pub fn reduce(range: Range<usize>, columns: usize, value: impl Fn(usize) -> f64) -> Vec<Column> {
    reduce_between(range, columns, |k| {
        let x = value(k);
        (x, x)
    })
}

/// The same of everything between two series: `edges(k)` has the lower first.
pub fn reduce_between(range: Range<usize>, columns: usize, edges: impl Fn(usize) -> (f64, f64)) -> Vec<Column> {
    let width = stride(range.len(), columns);
    let mut reduced = Vec::with_capacity(range.len() / width + 2);
    let mut start = range.start;
    while start < range.end {
        let end = ((start / width + 1) * width).min(range.end);
        // Comparisons without branches: this loop sees every sample of every series.
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for k in start..end {
            let (l, h) = edges(k);
            low = if l < low { l } else { low };
            high = if h > high { h } else { high };
        }
        if low.is_finite() && high.is_finite() {
            let rising = edges(start).0 <= edges(end - 1).0;
            reduced.push(Column { sample: start, low, high, rising });
        } else {
            reduced.extend(finite_column(start..end, &edges));
        }
        start = end;
    }
    reduced
}

/// The column of the finite values among some samples, if there are any.
fn finite_column(range: Range<usize>, edges: impl Fn(usize) -> (f64, f64)) -> Option<Column> {
    let sample = range.start;
    let finite = range.map(edges).filter(|(l, h)| l.is_finite() && h.is_finite());
    let (low, high) = finite.reduce(|(low, high), (l, h)| (low.min(l), high.max(h)))?;
    Some(Column { sample, low, high, rising: true })
}

/// Samples per pixel column.
fn stride(samples: usize, columns: usize) -> usize {
    samples.div_ceil(columns.max(1)).max(1)
}

/// The range that holds all values but the outermost `share` at either end: a few extreme samples must not flatten the
/// rest.
pub fn central_range(mut values: Vec<f64>, share: f64) -> Option<(f64, f64)> {
    if values.is_empty() {
        return None;
    }
    let last = values.len() - 1;
    let cut = (share * last as f64) as usize;
    let (_, &mut low, _) = values.select_nth_unstable_by(cut, f64::total_cmp);
    let (_, &mut high, _) = values.select_nth_unstable_by(last - cut, f64::total_cmp);
    Some((low, high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_samples_stay_as_they_are() {
        let columns = reduce(3..6, 100, |k| k as f64);
        assert_eq!(
            columns.iter().map(|c| (c.sample, c.low, c.high)).collect::<Vec<_>>(),
            [(3, 3.0, 3.0), (4, 4.0, 4.0), (5, 5.0, 5.0)]
        );
    }

    #[test]
    fn no_peak_is_lost_and_columns_do_not_wander() {
        let value = |k: usize| if k == 777 { 50.0 } else { (k as f64 * 0.1).sin() };
        for start in 0..40 {
            let columns = reduce(start..start + 4000, 100, value);
            assert!(columns.len() <= 101);
            assert!(columns.iter().any(|c| c.high == 50.0 && c.low > -1.1));
            assert!(columns[1..].iter().all(|c| c.sample % 40 == 0));
        }
    }

    #[test]
    fn undefined_values_are_left_out() {
        let columns = reduce(0..10, 5, |k| if k < 4 { f64::NAN } else { 1.0 });
        assert_eq!(columns.iter().map(|c| c.sample).collect::<Vec<_>>(), [4, 6, 8]);
        assert!(reduce(5..5, 10, |_| 1.0).is_empty());
        assert!(reduce(0..10, 0, |_| 1.0).len() == 1, "a plot of no width");
    }

    #[test]
    fn the_central_range_forgets_outliers_only() {
        let mut values: Vec<f64> = (0..1000).map(f64::from).collect();
        values.push(1e9);
        assert_eq!(central_range(values, 0.01), Some((10.0, 990.0)));
        assert_eq!(central_range(vec![2.0], 0.01), Some((2.0, 2.0)));
        assert_eq!(central_range(vec![], 0.01), None);
    }
}
