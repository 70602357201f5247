//! The input of a window: its mean and root mean square, and where it exceeds its limits.

use std::ops::Range;

use super::granule::{AFTER, GRANULE, pieces, samples_of};
use super::series::Series;
use crate::judgement::diagnosis::innovations::{CROSS_LAGS, LARGEST};
use crate::judgement::diagnosis::lagged::sum_of;

/// The samples before a granule that its products with the input reach back to.
pub(super) const BEFORE: usize = CROSS_LAGS - 1 - AFTER;

/// The input at some samples, at most a granule of them, and at those before and after that their products reach.
pub(super) type NearInput = [f64; BEFORE + GRANULE + AFTER];

/// The samples that the products of a granule with the input reach.
fn reach(number: usize) -> Range<usize> {
    let samples = samples_of(number);
    samples.start - BEFORE..samples.end + AFTER
}

/// The input of a granule \[m/s²\].
#[derive(Clone, Copy, Debug)]
pub(super) struct GranuleInput {
    moments: Moments,
    /// The least and the largest input that its products reach.
    extremes: (f64, f64),
}

impl GranuleInput {
    /// The input of the granule with this number; `input` begins with sample `first`.
    pub(super) fn new(number: usize, input: &[f64], first: usize) -> Self {
        let (samples, reach) = (samples_of(number), reach(number));
        let near = &input[reach.start - first..reach.end - first];
        // Four side by side, for vector instructions.
        let (chunks, rest) = near.as_chunks::<4>();
        let (mut low, mut high) = ([rest[0]; 4], [rest[0]; 4]);
        for chunk in chunks {
            for ((low, high), &f) in low.iter_mut().zip(&mut high).zip(chunk) {
                *low = if f < *low { f } else { *low };
                *high = if f > *high { f } else { *high };
            }
        }
        let both = low.iter().chain(&high).chain(rest);
        let extremes = both.fold((rest[0], rest[0]), |(low, high), f| (low.min(*f), high.max(*f)));
        Self { moments: Moments::of(&input[samples.start - first..samples.end - first]), extremes }
    }

    /// The input that the products of the granule with this number reach, less its mean; `input` begins with sample `first`.
    pub(super) fn near(&self, number: usize, input: &[f64], first: usize) -> NearInput {
        let begin = reach(number).start - first;
        std::array::from_fn(|i| input[begin + i] - self.moments.mean)
    }

    /// The mean.
    pub(super) fn mean(&self) -> f64 {
        self.moments.mean
    }
}

/// The mean of some numbers and the sum of the squares of their distances from it.
#[derive(Clone, Copy, Debug)]
struct Moments {
    count: f64,
    mean: f64,
    square: f64,
}

impl Moments {
    fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = sum_of(values, |f| f) / count;
        Self { count, mean, square: sum_of(values, |f| (f - mean) * (f - mean)) }
    }

    /// The sum of the squares of the distances from another number.
    fn square_about(&self, other: f64) -> f64 {
        let distance = self.mean - other;
        self.square + self.count * distance * distance
    }
}

/// The input of a window.
pub(super) struct WindowInput<'a> {
    input: &'a [f64],
    first: usize,
    window: Range<usize>,
    granules: &'a Series<GranuleInput>,
    mean: f64,
    /// Limits the distance from the mean.
    limit: f64,
}

impl<'a> WindowInput<'a> {
    /// The input of a window; `input` begins with sample `first`, and `granules` are those of the window.
    ///
    /// Source of the sums of parts: Chan, Golub and LeVeque (1983), Algorithms for computing the sample variance, *The American
    /// Statistician* 37.
    pub(super) fn new(
        input: &'a [f64],
        first: usize,
        window: Range<usize>,
        granules: &'a Series<GranuleInput>,
    ) -> Self {
        let moments = pieces(&window, &window).map(|piece| match piece.granule {
            Some(number) => granules.at(number).moments,
            None => Moments::of(&input[piece.samples.start - first..piece.samples.end - first]),
        });
        let moments: Vec<Moments> = moments.collect();
        let count = window.len().max(1) as f64;
        let mean = moments.iter().map(|one| one.count * one.mean).sum::<f64>() / count;
        let square = moments.iter().map(|one| one.square_about(mean)).sum::<f64>() / count;
        Self { input, first, window, granules, mean, limit: LARGEST * square.sqrt() }
    }

    /// The input of a granule, where nothing that its products reach exceeds the limits.
    pub(super) fn within_limits(&self, number: usize) -> Option<&GranuleInput> {
        let granule = self.granules.at(number);
        let (low, high) = granule.extremes;
        (low - self.mean >= -self.limit && high - self.mean <= self.limit).then_some(granule)
    }

    /// The mean.
    pub(super) fn mean(&self) -> f64 {
        self.mean
    }

    /// The sum of the squares of a granule's input, less the mean.
    pub(super) fn square(&self, granule: &GranuleInput) -> f64 {
        granule.moments.square_about(self.mean)
    }

    /// The input that the products of some samples reach, less the mean and limited; 0 outside the window and after what they
    /// reach.
    pub(super) fn near(&self, samples: &Range<usize>) -> NearInput {
        let mut near = [0.0; BEFORE + GRANULE + AFTER];
        let begin = samples.start.saturating_sub(BEFORE).max(self.window.start);
        let end = (samples.end + AFTER).min(self.window.end);
        let known = &self.input[begin - self.first..end - self.first];
        for (near, f) in near[BEFORE + begin - samples.start..].iter_mut().zip(known) {
            *near = (f - self.mean).max(-self.limit).min(self.limit);
        }
        near
    }
}
