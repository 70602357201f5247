//! Bounds of channels: a filter reports the moments of its belief between the ends.
//!
//! ```text
//! y ← y + k (μ - yᵢ),  P ← P + k (s² - Pᵢᵢ) kᵀ,  k = P eᵢ / Pᵢᵢ
//! ```
//!
//! for one channel after the other, with the mean μ and the standard deviation s of N(yᵢ, Pᵢᵢ) between the ends. The filter itself goes
//! on from its own belief. So what is told is exact where that is: a constant with a normal prior that is cut at the ends has the
//! normal posterior, cut there. If the filter went on from what is told, the same end would count anew at each sample.
//!
//! Source: Simon (2010), Kalman filtering with state constraints: a survey of linear and nonlinear algorithms.

use super::{Estimator, State};
use crate::data::record::Parts;
use crate::mathematics::truncated_normal::truncated;
use crate::samples::passage::Passages;
use crate::samples::sink::{Sample, Sink};
use crate::{Channel, FilterError, FilterSettings, Stop};

#[derive(Clone, Debug, Default)]
pub(crate) struct Truncation {
    /// Places among the channels, each with its ends.
    places: Vec<(usize, [f64; 2])>,
    mean: Vec<f64>,
    cov: Vec<f64>,
    along: Vec<f64>,
}

impl Truncation {
    pub(crate) fn of(settings: &FilterSettings, channels: &[Channel]) -> Self {
        let place = |channel: Channel| channel.place_in(channels);
        let places = settings.bounds.iter().filter_map(|(channel, between)| Some((place(channel)?, between.ends())));
        Self { places: places.collect(), ..Self::default() }
    }

    pub(crate) fn apply<'a>(&'a mut self, mean: &'a [f64], cov: &'a [f64]) -> (&'a [f64], &'a [f64]) {
        if self.places.is_empty() {
            return (mean, cov);
        }
        let Self { places, mean: own, cov: own_cov, along } = self;
        own.clear();
        own.extend_from_slice(mean);
        own_cov.clear();
        own_cov.extend_from_slice(cov);
        let n = own.len();
        for &(i, ends) in &*places {
            let variance = own_cov[i * n + i];
            if !(variance > 0.0 && own[i].is_finite()) {
                continue;
            }
            let [mean, std] = truncated([own[i], variance.sqrt()], ends);
            along.clear();
            along.extend(own_cov[i * n..(i + 1) * n].iter().map(|entry| entry / variance));
            let by = mean - own[i];
            own.iter_mut().zip(&*along).for_each(|(mean, along)| *mean += along * by);
            own[i] = mean;
            let more = std * std - variance;
            for row in 0..n {
                for column in 0..=row {
                    let entry = own_cov[row * n + column] + more * (along[row] * along[column]);
                    (own_cov[row * n + column], own_cov[column * n + row]) = (entry, entry);
                }
            }
        }
        // A later channel may have moved one before it.
        places.iter().for_each(|&(i, [least, most])| own[i] = own[i].clamp(least, most));
        (own, own_cov)
    }
}

pub(crate) struct Bounded {
    inner: Box<dyn Estimator>,
    truncation: Truncation,
}

impl Bounded {
    pub(crate) fn new(inner: Box<dyn Estimator>, truncation: Truncation) -> Self {
        Self { inner, truncation }
    }
}

impl Estimator for Bounded {
    fn begin(&self, sink: &mut dyn Sink) -> Result<(), FilterError> {
        self.inner.begin(&mut Truncating { truncation: &mut self.truncation.clone(), sink })
    }

    fn step(&mut self, before: f64, force: f64, measured: &[f64], sink: &mut dyn Sink) -> Result<(), FilterError> {
        let Self { inner, truncation } = self;
        inner.step(before, force, measured, &mut Truncating { truncation, sink })
    }

    fn step_through(&mut self, parts: &Parts, sink: &mut dyn Sink) -> Result<(), FilterError> {
        let Self { inner, truncation } = self;
        inner.step_through(parts, &mut Truncating { truncation, sink })
    }

    fn keep_passages(&mut self) -> bool {
        self.inner.keep_passages()
    }

    fn state(&self) -> Option<State> {
        self.inner.state()
    }

    fn restore(&mut self, state: &State) -> Result<(), FilterError> {
        self.inner.restore(state)
    }
}

pub(crate) struct Truncating<'a> {
    pub(crate) truncation: &'a mut Truncation,
    pub(crate) sink: &'a mut dyn Sink,
}

impl Sink for Truncating<'_> {
    fn push(&mut self, sample: &Sample<'_>) {
        let (mean, cov) = self.truncation.apply(sample.mean, sample.cov);
        self.sink.push(&Sample { mean, cov, ..*sample });
    }

    fn stop_at(&mut self, stop: Stop) {
        self.sink.stop_at(stop);
    }

    fn wants_prior(&self) -> bool {
        self.sink.wants_prior()
    }

    fn passages(&mut self) -> Option<&mut Passages> {
        self.sink.passages()
    }
}
