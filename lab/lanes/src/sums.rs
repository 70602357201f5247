//! Running sums of the scores: those of [`Scores`](kalmanscope_core::Scores) in lanes.

use kalmanscope_core::diagnostics::{ErrorSums, Total};
use kalmanscope_core::internals::ChannelSums;
use kalmanscope_core::internals::kernel::Gaussian;
use kalmanscope_core::internals::{LogSum, log_likelihood};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Channel, Stop};

use crate::belief::{Belief, Triangle};
use crate::lane::{LANES, Lane, Mask};
use crate::observation::Observations;
use crate::plant::Plant;

/// Limits the relative error of an estimate that has settled.
const SETTLED: f64 = 0.05;

/// Limits the rounding error of an estimate, relative to its largest value.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The sums of a channel.
#[derive(Clone, Copy)]
struct Tracked<T> {
    squares: T,
    inside: T,
    settled: T,
    recent: T,
    largest_truth: T,
    largest_mean: T,
}

/// The sums of all lanes.
pub(crate) struct Sums<T, const N: usize> {
    tracked: [Tracked<T>; N],
    nees: T,
    nees_degrees: T,
    nees_samples: T,
    nis: T,
    /// The degrees of freedom and samples of the NIS that all lanes have, and those that a lane has more.
    measured: [u32; 2],
    more: [[i32; LANES]; 2],
    /// The product of determinants, and the sum of logarithms that each lane has taken.
    product: T,
    taken: [f64; LANES],
}

impl<T: Lane, const N: usize> Sums<T, N> {
    pub(crate) fn new(token: T::Token) -> Self {
        let zero = T::splat(token, 0.0);
        let tracked = Tracked {
            squares: zero,
            inside: zero,
            settled: zero,
            recent: zero,
            largest_truth: zero,
            largest_mean: zero,
        };
        Self {
            tracked: [tracked; N],
            nees: zero,
            nees_degrees: zero,
            nees_samples: zero,
            nis: zero,
            measured: [0; 2],
            more: [[0; LANES]; 2],
            product: T::splat(token, 1.0),
            taken: [0.0; LANES],
        }
    }

    /// Adds the errors of the beliefs at sample `k`, where the truth is known. Returns their NEES, or NaN without one.
    #[inline(always)]
    pub(crate) fn compare<P: Plant<N>, const E: usize>(
        &mut self,
        belief: &Belief<T, N, E>,
        truth: [T; N],
        k: usize,
        is_recent: bool,
    ) -> T {
        let zero = belief.mean[0].of(0.0);
        let one = zero.of(1.0);
        // A negative natural frequency is the same oscillator as its mirror image.
        let is_mirrored = belief.mean[2].lt(zero);
        let mut errors = [zero; N];
        let mut factor = belief.cov;
        for i in 0..N {
            let sums = &mut self.tracked[i];
            let own = if P::CHANNELS[i].is_mirrored() { T::select(is_mirrored, -truth[i], truth[i]) } else { truth[i] };
            let (error, size) = (belief.mean[i] - own, truth[i].abs());
            let square = error * error;
            let variance = belief.cov(i, i);
            sums.squares = sums.squares + square;
            sums.inside = sums.inside + T::select(square.le(zero.of(4.0) * variance), one, zero);
            sums.largest_truth = sums.largest_truth.max(size);
            let is_near = error.abs().le(zero.of(SETTLED) * size);
            // Samples only grow. To write to some lanes of a number in memory would be slow.
            sums.settled = sums.settled.max(T::select(is_near, zero, zero.of((k + 1) as f64)));
            if is_recent {
                sums.recent = sums.recent + square;
            }
            sums.largest_mean = sums.largest_mean.max(belief.mean[i].abs());
            let floor = zero.of(ROUNDING * ROUNDING) * sums.largest_mean * sums.largest_mean;
            factor[Triangle::<N>::AT[i][i]] = T::select(zero.lt(variance), variance + floor, zero);
            errors[i] = error;
        }
        self.add_nees(errors, factor)
    }

    /// Adds `eᵀ P⁻¹ e` over the components of positive variance, where P is positive definite.
    #[inline(always)]
    fn add_nees<const E: usize>(&mut self, mut errors: [T; N], cov: [T; E]) -> T {
        let zero = errors[0].of(0.0);
        let one = zero.of(1.0);
        let mut factor = cov;
        let (mut sum, mut degrees) = (zero, zero);
        let mut counts_all = T::always(zero.token());
        for j in 0..N {
            let (variance, pivot) = (cov[Triangle::<N>::AT[j][j]], factor[Triangle::<N>::AT[j][j]]);
            let counts = zero.lt(variance);
            let is_positive = (zero.of(4.0 * N as f64 * f64::EPSILON) * variance).lt(pivot);
            counts_all = counts_all & (!counts | is_positive);
            let inverse = T::select(counts, one / pivot, zero);
            degrees = degrees + T::select(counts, one, zero);
            sum = sum + errors[j] * errors[j] * inverse;
            for i in j + 1..N {
                let share = factor[Triangle::<N>::AT[i][j]] * inverse;
                errors[i] = errors[i] - share * errors[j];
                for k in j + 1..=i {
                    factor[Triangle::<N>::AT[i][k]] =
                        factor[Triangle::<N>::AT[i][k]] - share * factor[Triangle::<N>::AT[k][j]];
                }
            }
        }
        // Not a number is not equal to itself.
        let counts = counts_all & zero.lt(degrees) & sum.le(sum);
        self.nees = self.nees + T::select(counts, sum, zero);
        self.nees_degrees = self.nees_degrees + T::select(counts, degrees, zero);
        self.nees_samples = self.nees_samples + T::select(counts, one, zero);
        T::select(counts, sum, zero.of(f64::NAN))
    }

    /// Takes in the NIS and det S of `measured` sensors.
    #[inline(always)]
    pub(crate) fn measure(&mut self, nis: T, determinant: T, measured: u32) {
        self.nis = self.nis + nis;
        self.measured[0] += measured;
        self.measured[1] += u32::from(measured > 0);
        let next = self.product * determinant;
        let (low, high) = (nis.of(*LogSum::RANGE.start()), nis.of(*LogSum::RANGE.end()));
        let in_range = low.le(next) & next.le(high);
        if in_range.all() {
            self.product = next;
        } else {
            self.take_logarithms(determinant);
        }
    }

    /// Where some products leave the range.
    #[inline(never)]
    fn take_logarithms(&mut self, determinant: T) {
        let (mut products, determinants) = (self.product.to_array(), determinant.to_array());
        for lane in 0..LANES {
            let mut sum = LogSum { taken: self.taken[lane], product: products[lane] };
            // Determinants out of range have been taken already.
            sum.add(determinants[lane], || 0.0);
            (self.taken[lane], products[lane]) = (sum.taken, sum.product);
        }
        self.product = T::from_array(determinant.token(), products);
    }

    /// Corrects the number of sensors with a measurement in a lane, and adds a logarithm.
    pub(crate) fn correct(&mut self, lane: usize, measured: u32, expected: u32, ln_determinant: f64) {
        self.more[0][lane] += measured as i32 - expected as i32;
        self.more[1][lane] += i32::from(measured > 0) - i32::from(expected > 0);
        self.taken[lane] += ln_determinant;
    }

    /// The outcome of a lane after `samples` samples, from its first and last belief. `None` if a truth is NaN, since
    /// the sums are then NaN too.
    pub(crate) fn outcome(
        &self,
        lane: usize,
        samples: usize,
        [first, last]: [&Gaussian<N>; 2],
        observations: &Observations<'_, N>,
        stop: Option<Stop>,
    ) -> Option<Outcome> {
        let Self { nees, nees_degrees, nees_samples, nis, measured, more, product, taken, .. } = self;
        let of = |numbers: &T| numbers.to_array()[lane];
        let count = |at: usize| measured[at].saturating_add_signed(more[at][lane]);
        let nis = Total { sum: of(nis), degrees: count(0), samples: count(1) };
        let ln_determinants = LogSum { taken: taken[lane], product: of(product) }.value();
        let sums = self.channels(lane, samples, [first, last], observations);
        if sums.iter().any(|(_, sums)| sums.total.squares.is_nan()) {
            return None;
        }
        Some(Outcome {
            samples,
            nees: Total { sum: of(nees), degrees: of(nees_degrees) as u32, samples: of(nees_samples) as u32 },
            nis,
            log_likelihood: if nis.degrees > 0 { log_likelihood(nis.sum, ln_determinants, nis.degrees) } else { 0.0 },
            stop,
            diverged: stop.is_some() || sums.iter().any(|(_, sums)| sums.is_lost()),
            channels: sums.iter().filter_map(|(channel, sums)| Some((*channel, sums.score(samples)?))).collect(),
            mean: last.mean.iter().copied().collect(),
            std: (0..N).map(|i| last.cov[(i, i)].sqrt()).collect(),
            looks: Vec::new(),
        })
    }

    /// The sums of the channels with a known truth.
    fn channels(
        &self,
        lane: usize,
        samples: usize,
        [first, last]: [&Gaussian<N>; 2],
        observations: &Observations<'_, N>,
    ) -> Vec<(Channel, ChannelSums)> {
        if observations.truth.is_none() {
            return Vec::new();
        }
        let recent = samples.saturating_sub(last_fifth(observations.samples)) as u32;
        let of = |place: usize| {
            let (channel, Tracked { squares, inside, settled, recent: late, largest_truth, .. }) =
                (observations.channels[place], self.tracked[place]);
            let error =
                |belief: &Gaussian<N>, k: usize| observations.error(lane, k, belief, place).unwrap_or([f64::NAN; 2]);
            let sums = ChannelSums {
                total: ErrorSums {
                    squares: squares.to_array()[lane],
                    known: samples as u32,
                    inside: inside.to_array()[lane] as u32,
                },
                first_error: error(first, 0)[1].abs(),
                largest_truth: largest_truth.to_array()[lane],
                settled: settled.to_array()[lane] as usize,
                recent: (late.to_array()[lane], recent),
                error: error(last, samples - 1)[0],
                std: last.cov[(place, place)].sqrt(),
                initial_std: first.cov[(place, place)].sqrt(),
            };
            (channel, sums)
        };
        (0..N).map(of).collect()
    }
}

/// The first sample of a record's last fifth.
pub(crate) fn last_fifth(samples: usize) -> usize {
    samples * 4 / 5
}
