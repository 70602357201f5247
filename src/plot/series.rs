//! Quantities over time, reducible to pixel columns.

use std::ops::Range;

use kalmanscope_core::Record;

use super::columns::{BandColumn, Column, reduce, reduce_between};

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

    /// The part in the window, `(from, to)` \[s\], as at most `columns` columns.
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

    /// The part in the window, `(from, to)` \[s\], as at most `columns` columns.
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
