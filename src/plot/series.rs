//! Quantities over time, reducible to pixel columns.

use std::ops::Range;

use kalmanscope_core::Record;

pub(crate) trait Edges {
    fn edges(self) -> (f64, f64);
}

impl Edges for f64 {
    fn edges(self) -> (f64, f64) {
        (self, self)
    }
}

impl Edges for (f64, f64) {
    fn edges(self) -> (f64, f64) {
        self
    }
}

pub(crate) struct PlotSeries<'a> {
    len: usize,
    reduce: Box<dyn Fn(Range<usize>, usize) -> Vec<PlotColumn> + 'a>,
}

impl<'a> PlotSeries<'a> {
    pub(crate) fn new<V: Edges, I: Iterator<Item = V>>(len: usize, values: impl Fn(Range<usize>) -> I + 'a) -> Self {
        Self { len, reduce: Box::new(move |range, columns| reduce(range, columns, &values)) }
    }

    pub(crate) fn of(values: &'a [f64]) -> Self {
        Self::new(values.len(), |samples| values[samples].iter().copied())
    }

    pub(crate) fn each<V: Edges>(len: usize, value: impl Fn(usize) -> V + Copy + 'a) -> Self {
        Self::new(len, move |samples| samples.map(value))
    }

    pub(crate) fn made<V: Edges + Copy>(len: usize, make: impl Fn(Range<usize>) -> Vec<V> + 'a) -> Self {
        let made = move |range: Range<usize>, columns| {
            let (first, values) = (range.start, make(range.clone()));
            reduce(range, columns, |samples| values[samples.start - first..samples.end - first].iter().copied())
        };
        Self { len, reduce: Box::new(made) }
    }

    pub(crate) fn around(means: &'a [f64], variances: &'a [f64]) -> Self {
        Self::each(means.len(), |k| {
            let half = 2.0 * variances[k].sqrt();
            (means[k] - half, means[k] + half)
        })
    }

    /// The band of two standard deviations around zero, where the series is a variance: one root per column.
    pub(crate) fn around_zero(self) -> Self {
        self.through(|variance| 2.0 * variance.sqrt()).mapped(|column| PlotColumn { low: -column.high, ..column })
    }

    /// The series through a monotonic function, which is called for the extremes only.
    pub(crate) fn through(self, function: fn(f64) -> f64) -> Self {
        self.mapped(move |column| PlotColumn { low: function(column.low), high: function(column.high), ..column })
    }

    fn mapped(self, map: impl Fn(PlotColumn) -> PlotColumn + 'a) -> Self {
        let Self { len, reduce } = self;
        let is_finite = |column: &PlotColumn| column.low.is_finite() && column.high.is_finite();
        let mapped = move |range, columns| reduce(range, columns).into_iter().map(&map).filter(is_finite).collect();
        Self { len, reduce: Box::new(mapped) }
    }

    pub(crate) fn columns(&self, record: &Record, window: (f64, f64), columns: usize) -> Vec<PlotColumn> {
        (self.reduce)(samples_in(record, window, self.len), columns)
    }
}

fn samples_in(record: &Record, (from, to): (f64, f64), len: usize) -> Range<usize> {
    let index = |time: f64| ((time - record.time(0)) / record.dt()).clamp(0.0, len as f64);
    let first = index(from).floor() as usize;
    let last = (index(to).ceil() as usize + 1).min(len);
    // One sample beyond each edge, so that lines reach the frame.
    first.saturating_sub(1).min(last)..last
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PlotColumn {
    pub(crate) samples: (usize, usize),
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// Whether it ends no lower than it begins; a line then goes from the smallest to the largest value.
    pub(crate) rising: bool,
}

/// Reduces a series to at most `columns` + 1 columns; `values` gives the values of some samples. Values that are not
/// finite are left out. Columns begin at multiples of their width, so that they do not move while the range slides.
pub(crate) fn reduce<V: Edges, I: Iterator<Item = V>>(
    range: Range<usize>,
    columns: usize,
    values: impl Fn(Range<usize>) -> I,
) -> Vec<PlotColumn> {
    let width = range.len().div_ceil(columns.max(1)).max(1);
    let mut reduced = Vec::with_capacity(range.len() / width + 2);
    let mut start = range.start;
    while start < range.end {
        let end = (start / width + 1) * width;
        reduced.extend(column(start..end.min(range.end), &values));
        start = end;
    }
    reduced
}

#[inline]
fn column<V: Edges, I: Iterator<Item = V>>(
    samples: Range<usize>,
    values: impl Fn(Range<usize>) -> I,
) -> Option<PlotColumn> {
    let mut all = values(samples.clone()).map(V::edges);
    let (begin, top) = all.next()?;
    let (mut low, mut high, mut end) = (begin, top, begin);
    // Comparisons without branches, and as few as possible: this loop runs over every sample of every series.
    for (l, h) in all {
        low = if l < low { l } else { low };
        high = if h > high { h } else { high };
        end = l;
    }
    // NaN loses every comparison, except as the first value.
    if low.is_finite() && high.is_finite() && end.is_finite() {
        return Some(PlotColumn { samples: (samples.start, samples.end - 1), low, high, rising: begin <= end });
    }
    let all = samples.clone().zip(values(samples).map(V::edges));
    let mut finite = all.filter(|(_, (low, high))| low.is_finite() && high.is_finite());
    let (first, (low, high)) = finite.next()?;
    let one = (low, PlotColumn { samples: (first, first), low, high, rising: true });
    let (_, column) = finite.fold(one, |(begin, column), (k, (low, high))| {
        let (samples, rising) = ((column.samples.0, k), begin <= low);
        (begin, PlotColumn { samples, low: column.low.min(low), high: column.high.max(high), rising })
    });
    Some(column)
}

/// The range of the values without the outermost `share` at either end, so that a few extremes do not flatten the rest.
pub(crate) fn central_range(mut values: Vec<f64>, share: f64) -> Option<(f64, f64)> {
    if values.is_empty() {
        return None;
    }
    let last = values.len() - 1;
    let cut = (share * last as f64) as usize;
    // Two selections take less time than a sort, and this runs for each chart that is drawn again.
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
    fn a_band_holds_all_of_its_samples() {
        let edges = |k: usize| (k as f64, if k == 4 { 20.0 } else { k as f64 + 2.0 });
        let columns = reduce(0..6, 2, |samples| samples.map(edges));
        assert_eq!(columns.iter().map(|c| (c.low, c.high)).collect::<Vec<_>>(), [(0.0, 4.0), (3.0, 20.0)]);
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
