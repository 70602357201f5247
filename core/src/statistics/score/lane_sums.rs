//! Running sums of the scores of a run, or of several in lanes.

use kalmanscope_filters::engine::belief::ErrorSquare;
use kalmanscope_filters::engine::level::Level;
use kalmanscope_filters::engine::number::{Mask, Number};
use kalmanscope_filters::gaussian_likelihood::{LogSum, log_likelihood};
use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::{Channel, Stop};

use crate::statistics::diagnostics::Total;
use crate::statistics::diagnostics::accuracy::Tracked;
use crate::statistics::score::{ChannelSums, Outcome, SampleScore};

#[derive(Clone, Copy, Debug)]
pub(crate) struct Squares<T> {
    sum: T,
    pub(crate) degrees: T,
    samples: T,
}

#[derive(Clone, Debug)]
pub(crate) struct ScoreSums<T> {
    frequency: Option<usize>,
    last_fifth: usize,
    /// Counted from the record's beginning.
    pub(crate) samples: usize,
    pub(crate) tracked: Vec<Tracked<T>>,
    square: ErrorSquare<T>,
    pub(crate) nees: Squares<T>,
    pub(crate) nis: Squares<T>,
    /// NEES and NIS of the last sample; NaN where there is none.
    pub(crate) last: [T; 2],
    ln_determinants: LogProducts<T>,
    mean: Vec<T>,
    variance: Vec<T>,
}

impl<T: Number> ScoreSums<T> {
    pub(super) fn new(channels: &[Channel], is_known: impl Fn(Channel) -> bool, all: usize, first: usize) -> Self {
        let (zero, none) = (T::of(0.0), T::of(f64::NAN));
        let track = |(place, &channel)| Tracked::new(channel, place, first);
        let known = channels.iter().enumerate().filter(|(_, channel)| is_known(**channel));
        let tracked: Vec<_> = known.map(track).collect();
        let squares = Squares { sum: zero, degrees: zero, samples: zero };
        Self {
            frequency: Channel::NATURAL_FREQUENCY.place_in(channels),
            last_fifth: all * 4 / 5,
            samples: first,
            square: ErrorSquare::new(mapped(&tracked, &|tracked| tracked.place)),
            tracked,
            nees: squares,
            nis: squares,
            last: [none; 2],
            ln_determinants: LogProducts::new(),
            mean: vec![none; channels.len()],
            variance: vec![none; channels.len()],
        }
    }

    #[inline(always)]
    pub(super) fn take_belief<L: Level>(&mut self, level: L, belief: [&[T]; 2], truth: &[T]) {
        let is_whole = self.tracked.len() == level.size(belief[0].len());
        level.apart(
            #[inline(always)]
            || match is_whole {
                true if const { L::IS_KNOWN } => self.take_tracked::<L, true>(level, belief, truth),
                _ => self.take_tracked::<L, false>(level, belief, truth),
            },
        );
    }

    #[inline(always)]
    fn take_tracked<L: Level, const WHOLE: bool>(&mut self, level: L, [of_mean, cov]: [&[T]; 2], truth: &[T]) {
        let Self { frequency, last_fifth, samples, tracked, square, nees, last, mean, variance, .. } = self;
        let n = level.size(of_mean.len());
        let count = if WHOLE { n } else { tracked.len() };
        let (tracked, mean, variance) = (&mut tracked[..count], &mut mean[..n], &mut variance[..n]);
        mean.copy_from_slice(&of_mean[..n]);
        for i in 0..n {
            variance[i] = cov[i * n + i];
        }
        let mut sign = T::of(1.0);
        if let Some(place) = *frequency {
            sign = T::select(mean[place].lt(T::of(0.0)), T::of(-1.0), sign);
        }
        let is_recent = *samples >= *last_fifth;
        for (at, (tracked, &truth)) in tracked.iter_mut().zip(truth).enumerate() {
            let sign = if tracked.channel.is_mirrored() { sign } else { T::of(1.0) };
            let place = if WHOLE { at } else { tracked.place };
            let error = mean[place] - sign * truth;
            tracked.take(error, truth, variance[place], *samples, is_recent);
            tracked.error = sign * error;
            square.errors[at] = error;
        }
        if *samples == 0 {
            tracked.iter_mut().for_each(|tracked| tracked.initial_variance = variance[tracked.place]);
        }
        *samples += 1;
        last[0] = T::of(f64::NAN);
        if !tracked.is_empty() {
            let (sum, degrees) = square.of::<L, WHOLE>(level, [of_mean, cov]);
            let counts = T::of(0.0).lt(degrees);
            nees.add(T::select(counts, sum, T::of(0.0)), degrees);
            last[0] = T::select(counts, sum, last[0]);
        }
    }

    /// NIS zero and det S one stand for no measurement. `ln_determinant` is for a lane whose det S is too large or too small for a number.
    #[inline(always)]
    pub(super) fn take_update(
        &mut self,
        [nis, determinant]: [T; 2],
        measured: T,
        ln_determinant: impl Fn(usize) -> f64,
    ) {
        self.nis.add(nis, measured);
        self.last[1] = T::select(T::of(0.0).lt(measured), nis, T::of(f64::NAN));
        self.ln_determinants.add(determinant, ln_determinant);
    }

    pub(super) fn sample_score(&self, lane: usize) -> SampleScore {
        let mut channels = vec![[f64::NAN; 2]; self.mean.len()];
        for tracked in &self.tracked {
            if let Some(score) = self.sums(tracked, lane).score(self.samples) {
                channels[tracked.place] = [score.error, score.std];
            }
        }
        let [nees, nis] = self.last.map(|last| last.lane(lane));
        SampleScore { nees, nis, channels }
    }

    pub(super) fn outcome(&self, lane: usize, stop: Option<Stop>) -> Outcome {
        let sums: Vec<_> = mapped(&self.tracked, &|tracked| (tracked.channel, self.sums(tracked, lane)));
        Outcome {
            samples: self.samples,
            nees: self.nees.total(lane),
            nis: self.nis.total(lane),
            log_likelihood: self.log_likelihood(lane),
            stop,
            diverged: stop.is_some() || sums.iter().any(|(_, sums)| sums.is_lost()),
            channels: sums.iter().filter_map(|(channel, sums)| Some((*channel, sums.score(self.samples)?))).collect(),
            mean: mapped(&self.mean, &|mean| mean.lane(lane)),
            std: mapped(&self.variance, &|variance| variance.lane(lane).sqrt()),
            sample_scores: Vec::new(),
        }
    }

    pub(super) fn log_likelihood(&self, lane: usize) -> f64 {
        let Total { sum, degrees, .. } = self.nis.total(lane);
        if degrees > 0 { log_likelihood(sum, self.ln_determinants.value(lane), degrees) } else { 0.0 }
    }

    fn sums(&self, tracked: &Tracked<T>, lane: usize) -> ChannelSums {
        let of = |number: T| number.lane(lane);
        ChannelSums {
            total: tracked.total(lane),
            first_error: of(tracked.first_error),
            largest_truth: of(tracked.largest_truth),
            settled: of(tracked.settled) as usize,
            recent: (of(tracked.recent), of(tracked.recent_known) as u32),
            error: of(tracked.error),
            std: of(self.variance[tracked.place]).sqrt(),
            initial_std: of(tracked.initial_variance).sqrt(),
        }
    }
}

impl<T: Number> Squares<T> {
    #[inline(always)]
    fn add(&mut self, square: T, degrees: T) {
        self.sum = self.sum + square;
        self.degrees = self.degrees + degrees;
        self.samples = self.samples + T::select(T::of(0.0).lt(degrees), T::of(1.0), T::of(0.0));
    }

    pub(crate) fn total(&self, lane: usize) -> Total {
        let Self { sum, degrees, samples } = *self;
        Total { sum: sum.lane(lane), degrees: degrees.lane(lane) as u32, samples: samples.lane(lane) as u32 }
    }
}

#[derive(Clone, Debug)]
pub(super) struct LogProducts<T> {
    product: T,
    taken: Vec<f64>,
}

impl<T: Number> LogProducts<T> {
    pub(super) fn new() -> Self {
        Self { product: T::of(1.0), taken: vec![0.0; T::LANES] }
    }

    /// Adds the logarithm of a factor. `ln` computes it in a lane where the factor is too large or too small for a number.
    #[inline(always)]
    pub(super) fn add(&mut self, factor: T, ln: impl Fn(usize) -> f64) {
        let next = self.product * factor;
        let [low, high] = [*LogSum::RANGE.start(), *LogSum::RANGE.end()].map(T::of);
        let is_in_range = low.le(next) & next.le(high) & low.le(factor) & factor.le(high);
        if is_in_range.all() {
            self.product = next;
        } else {
            self.take_logarithms(factor, ln);
        }
    }

    #[cold]
    #[inline(never)]
    fn take_logarithms(&mut self, factor: T, ln: impl Fn(usize) -> f64) {
        for (lane, taken) in self.taken.iter_mut().enumerate() {
            let mut sum = LogSum { taken: *taken, product: self.product.lane(lane) };
            sum.add(factor.lane(lane), || ln(lane));
            *taken = sum.taken;
            self.product.set_lane(lane, sum.product);
        }
    }

    pub(super) fn clear(&mut self) {
        self.product = T::of(1.0);
        self.taken.fill(0.0);
    }

    pub(super) fn value(&self, lane: usize) -> f64 {
        LogSum { taken: self.taken[lane], product: self.product.lane(lane) }.value()
    }
}
