//! Quantities over time, reducible to pixel columns.

use std::ops::Range;

use kalmanscope_core::Record;

/// A quantity at every sample; NaN where it does not exist.
pub(crate) struct Series<'a> {
    len: usize,
    reduce: Box<dyn Fn(Range<usize>, usize) -> Vec<Column> + 'a>,
}

impl<'a> Series<'a> {
    pub(crate) fn new<I: Iterator<Item = f64>>(len: usize, values: impl Fn(Range<usize>) -> I + 'a) -> Self {
        Self { len, reduce: Box::new(move |range, columns| reduce(range, columns, &values)) }
    }

    pub(crate) fn of(values: &'a [f64]) -> Self {
        Self::new(values.len(), |samples| values[samples].iter().copied())
    }

    /// `make` makes the values of some of the samples up to `len`; it is called once for all that are shown.
    pub(crate) fn made(len: usize, make: impl Fn(Range<usize>) -> Vec<f64> + 'a) -> Self {
        let made = move |range: Range<usize>, columns| {
            let (first, values) = (range.start, make(range.clone()));
            reduce(range, columns, |samples| values[samples.start - first..samples.end - first].iter().copied())
        };
        Self { len, reduce: Box::new(made) }
    }

    /// The series through a monotonic function, which is called for the extremes only.
    pub(crate) fn through(self, function: fn(f64) -> f64) -> Self {
        let Self { len, reduce } = self;
        let through = move |column: Column| {
            let (low, high) = (function(column.low), function(column.high));
            (low.is_finite() && high.is_finite()).then_some(Column { low, high, ..column })
        };
        let reduce = move |range, columns| reduce(range, columns).into_iter().filter_map(through).collect();
        Self { len, reduce: Box::new(reduce) }
    }

    pub(crate) fn columns(&self, record: &Record, window: (f64, f64), columns: usize) -> Vec<Column> {
        (self.reduce)(samples_in(record, window, self.len), columns)
    }
}

pub(crate) struct Band<'a> {
    len: usize,
    reduce: Box<dyn Fn(Range<usize>, usize) -> Vec<BandColumn> + 'a>,
}

impl<'a> Band<'a> {
    pub(crate) fn around(means: &'a [f64], variances: &'a [f64]) -> Self {
        let edges = |(mean, variance): (&f64, &f64)| {
            let half = 2.0 * variance.sqrt();
            (mean - half, mean + half)
        };
        let edges = move |samples: Range<usize>| means[samples.clone()].iter().zip(&variances[samples]).map(edges);
        Self { len: means.len(), reduce: Box::new(move |range, columns| reduce_between(range, columns, edges)) }
    }

    /// `make` makes both edges at some of the samples up to `len`; it is called once for all that are shown.
    pub(crate) fn made(len: usize, make: impl Fn(Range<usize>) -> Vec<(f64, f64)> + 'a) -> Self {
        let reduce = move |range: Range<usize>, columns| {
            let (first, edges) = (range.start, make(range.clone()));
            reduce_between(range, columns, |samples| edges[samples.start - first..samples.end - first].iter().copied())
        };
        Self { len, reduce: Box::new(reduce) }
    }

    /// Two standard deviations on either side of zero; `variances` gives those of some of the samples up to `len`.
    pub(crate) fn around_zero<I: Iterator<Item = f64>>(len: usize, variances: impl Fn(Range<usize>) -> I + 'a) -> Self {
        // One root per column instead of one per sample.
        let around = |column: Column| {
            let edges = |variance: f64| (-2.0 * variance.sqrt(), 2.0 * variance.sqrt());
            let (low, high) = edges(column.high);
            let ends = column.ends().map(|ends| ends.map(edges));
            BandColumn { samples: column.samples, low, high, ends, widest: high - low }
        };
        let reduce = move |range, columns| reduce(range, columns, &variances).into_iter().map(around).collect();
        Self { len, reduce: Box::new(reduce) }
    }

    pub(crate) fn columns(&self, record: &Record, window: (f64, f64), columns: usize) -> Vec<BandColumn> {
        (self.reduce)(samples_in(record, window, self.len), columns)
    }
}

/// The samples in the window and one more on either side, if they exist.
fn samples_in(record: &Record, (from, to): (f64, f64), len: usize) -> Range<usize> {
    let index = |time: f64| ((time - record.time(0)) / record.dt()).clamp(0.0, len as f64);
    let first = index(from).floor() as usize;
    let last = (index(to).ceil() as usize + 1).min(len);
    first.saturating_sub(1).min(last)..last
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Column {
    pub(crate) samples: (usize, usize),
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// Whether it ends no lower than it begins; a line then goes from the smallest to the largest value.
    pub(crate) rising: bool,
    pub(crate) at_ends: bool,
}

impl Column {
    fn new(samples: (usize, usize), [low, high]: [f64; 2], [first, last]: [f64; 2]) -> Self {
        let at_ends = low == first.min(last) && high == first.max(last);
        Self { samples, low, high, rising: first <= last, at_ends }
    }

    pub(crate) fn ends(&self) -> Option<[f64; 2]> {
        self.at_ends.then_some(if self.rising { [self.low, self.high] } else { [self.high, self.low] })
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BandColumn {
    pub(crate) samples: (usize, usize),
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) ends: Option<[(f64, f64); 2]>,
    pub(crate) widest: f64,
}

impl BandColumn {
    fn new(samples: (usize, usize), [low, high]: [f64; 2], ends: [(f64, f64); 2], widest: f64) -> Self {
        let [first, last] = ends;
        let at_ends = low == first.0.min(last.0) && high == first.1.max(last.1);
        Self { samples, low, high, ends: at_ends.then_some(ends), widest }
    }
}

/// Reduces a series to at most `columns` + 1 columns; `values` gives the values of some samples. Values that are not
/// finite are left out. Columns begin at multiples of their width, so that they do not move while the range slides.
pub(crate) fn reduce<I: Iterator<Item = f64>>(
    range: Range<usize>,
    columns: usize,
    values: impl Fn(Range<usize>) -> I,
) -> Vec<Column> {
    by_column(range, columns, |samples| {
        let (first, last) = (samples.start, samples.end - 1);
        let mut all = values(samples.clone());
        let begin = all.next()?;
        let (mut low, mut high, mut end) = (begin, begin, begin);
        // Comparisons without branches, and as few as possible: this loop runs over every sample of every series.
        for x in all {
            low = if x < low { x } else { low };
            high = if x > high { x } else { high };
            end = x;
        }
        // NaN loses every comparison, except as the first value.
        if low.is_finite() && high.is_finite() && end.is_finite() {
            return Some(Column::new((first, last), [low, high], [begin, end]));
        }
        let mut finite = samples.clone().zip(values(samples)).filter(|(_, x)| x.is_finite());
        let (first, begin) = finite.next()?;
        let one = ((first, first), [begin; 2], [begin; 2]);
        let (samples, extremes, ends) = finite.fold(one, |((first, _), [low, high], [begin, _]), (k, x)| {
            ((first, k), [low.min(x), high.max(x)], [begin, x])
        });
        Some(Column::new(samples, extremes, ends))
    })
}

/// The same for a band between two edges, the lower first. A column with a value that is not finite is left out.
pub(crate) fn reduce_between<I: Iterator<Item = (f64, f64)>>(
    range: Range<usize>,
    columns: usize,
    edges: impl Fn(Range<usize>) -> I,
) -> Vec<BandColumn> {
    by_column(range, columns, |samples| {
        let (first, last) = (samples.start, samples.end - 1);
        let mut all = edges(samples);
        let begin = all.next()?;
        let ((mut low, mut high), mut widest, mut end) = (begin, begin.1 - begin.0, begin);
        for (l, h) in all {
            let width = h - l;
            widest = if width > widest { width } else { widest };
            low = if l < low { l } else { low };
            high = if h > high { h } else { high };
            end = (l, h);
        }
        let finite = (high - low).is_finite() && (end.1 - end.0).is_finite();
        finite.then(|| BandColumn::new((first, last), [low, high], [begin, end], widest))
    })
}

#[inline]
fn by_column<C>(range: Range<usize>, columns: usize, column: impl Fn(Range<usize>) -> Option<C>) -> Vec<C> {
    let width = stride(range.len(), columns);
    let mut reduced = Vec::with_capacity(range.len() / width + 2);
    let mut start = range.start;
    let mut end = (start / width + 1) * width;
    while start < range.end {
        if let Some(column) = column(start..end.min(range.end)) {
            reduced.push(column);
        }
        (start, end) = (end, end + width);
    }
    reduced
}

fn stride(samples: usize, columns: usize) -> usize {
    samples.div_ceil(columns.max(1)).max(1)
}

/// The range of the values without the outermost `share` at either end, so that a few extremes do not flatten the rest.
pub(crate) fn central_range(mut values: Vec<f64>, share: f64) -> Option<(f64, f64)> {
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
        let columns = reduce(3..6, 100, |r| r.map(|k| k as f64));
        assert_eq!(
            columns.iter().map(|c| (c.samples, c.low, c.high)).collect::<Vec<_>>(),
            [((3, 3), 3.0, 3.0), ((4, 4), 4.0, 4.0), ((5, 5), 5.0, 5.0)]
        );
    }

    #[test]
    fn no_peak_is_lost_and_columns_do_not_wander() {
        let value = |k: usize| if k == 777 { 50.0 } else { (k as f64 * 0.1).sin() };
        for start in 0..40 {
            let columns = reduce(start..start + 4000, 100, |samples| samples.map(value));
            assert!(columns.len() <= 101);
            assert!(columns.iter().any(|c| c.high == 50.0 && c.low > -1.1));
            assert!(columns[1..].iter().all(|c| c.samples.0 % 40 == 0));
        }
    }

    #[test]
    fn undefined_values_are_left_out() {
        let value = |k: usize| if k < 4 || k == 7 { f64::NAN } else { 1.0 };
        let columns = reduce(0..10, 5, |samples| samples.map(value));
        assert_eq!(columns.iter().map(|c| c.samples).collect::<Vec<_>>(), [(4, 5), (6, 6), (8, 9)]);
        let columns = reduce(4..10, 1, |samples| samples.map(value));
        assert_eq!(columns.iter().map(|c| (c.samples, c.high)).collect::<Vec<_>>(), [((4, 5), 1.0), ((6, 9), 1.0)]);
        assert!(reduce(5..5, 10, |samples| samples.map(value)).is_empty());
        assert!(reduce(4..6, 0, |samples| samples.map(value)).len() == 1, "a plot of no width");
    }

    #[test]
    fn a_band_is_known_at_both_ends_of_a_column_if_they_hold_all_of_it() {
        let edges = |k: usize| (k as f64, if k == 4 { 20.0 } else { k as f64 + 2.0 });
        let columns = reduce_between(0..6, 2, |samples| samples.map(edges));
        let [narrow, wide] = columns[..] else { panic!("{columns:?}") };
        assert_eq!(narrow.ends, Some([(0.0, 2.0), (2.0, 4.0)]));
        assert_eq!((narrow.low, narrow.high, narrow.widest), (0.0, 4.0, 2.0));
        assert_eq!((wide.ends, wide.low, wide.high, wide.widest), (None, 3.0, 20.0, 16.0));
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
