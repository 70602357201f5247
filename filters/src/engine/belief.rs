//! The belief of a filter about the state, and the noise that it assumes.

use super::columns::entry;
use super::level::{Level, each};
use super::number::{Function, Mask, Number};

/// A normal distribution over n components, in each lane.
#[derive(Clone, Debug)]
pub struct GaussianBelief<T> {
    /// y, n numbers.
    pub mean: Vec<T>,
    /// P, n × n; only the lower triangle is read.
    pub cov: Vec<T>,
}

#[derive(Clone, Debug)]
pub struct FilterNoise<T> {
    /// The diagonal of Q.
    pub process: Vec<T>,
    /// Q, n × n, its lower triangle, where it is not diagonal; else empty.
    pub matrix: Vec<T>,
    /// The diagonal of R.
    pub sensors: Vec<T>,
    /// The fading factor λ ≥ 1 on the predicted covariance.
    pub fading: T,
}

impl<T: Number> FilterNoise<T> {
    pub(super) fn fill_matrix(&mut self) {
        let n = self.process.len();
        self.matrix = vec![T::of(0.0); n * n];
        self.process.iter().enumerate().for_each(|(i, variance)| self.matrix[i * (n + 1)] = *variance);
    }

    pub(super) fn entry(&self, i: usize, j: usize) -> T {
        match self.matrix.is_empty() {
            false => self.matrix[j * self.process.len() + i],
            true if i == j => self.process[i],
            true => T::of(0.0),
        }
    }

    pub fn diagonal(&self) -> impl Iterator<Item = T> {
        (0..self.process.len()).map(|i| self.entry(i, i))
    }

    pub(super) fn variance(&mut self, i: usize) -> &mut T {
        let n = self.process.len();
        if self.matrix.is_empty() { &mut self.process[i] } else { &mut self.matrix[i * (n + 1)] }
    }
}

impl<T: Number> GaussianBelief<T> {
    #[inline(always)]
    pub(crate) fn size(&self) -> usize {
        self.mean.len()
    }

    /// Makes it a copy of another one of the same size, in its own memory, which a derived `clone_from` would not use.
    pub fn copy_from(&mut self, other: &Self) {
        self.mean.copy_from_slice(&other.mean);
        self.cov.copy_from_slice(&other.cov);
    }

    /// `λ P + Q` in place of P. A variance that rounding made negative becomes zero.
    #[inline(always)]
    pub(crate) fn spread<L: Level>(&mut self, level: L, noise: &FilterNoise<T>) {
        let n = level.size(self.size());
        if !noise.matrix.is_empty() {
            for j in 0..n {
                for at in j * n + j..(j + 1) * n {
                    self.cov[at] = self.cov[at] * noise.fading + noise.matrix[at];
                }
            }
            return self.clamp();
        }
        let (cov, process) = (&mut self.cov[..n * n], &noise.process[..n]);
        for j in 0..n {
            for entry in &mut cov[j * n + j..(j + 1) * n] {
                *entry = *entry * noise.fading;
            }
            let variance = cov[j * n + j] + process[j];
            cov[j * n + j] = T::select(variance.lt(T::of(0.0)), T::of(0.0), variance);
        }
    }

    #[inline(always)]
    pub(crate) fn clamp(&mut self) {
        let n = self.size();
        for j in 0..n {
            let variance = self.cov[j * n + j];
            self.cov[j * n + j] = T::select(variance.lt(T::of(0.0)), T::of(0.0), variance);
        }
    }

    /// Keeps this share of a component, and adds an independent one of this variance.
    #[inline(always)]
    pub(crate) fn renew(&mut self, place: usize, kept: T, variance: T) {
        // Adding zero makes +0 of the -0 of a share of zero.
        let (n, zero) = (self.size(), T::of(0.0));
        self.mean[place] = self.mean[place] * kept + zero;
        for i in 0..n {
            let at = if i >= place { place * n + i } else { i * n + place };
            self.cov[at] = self.cov[at] * kept + zero;
        }
        let own = &mut self.cov[place * (n + 1)];
        *own = *own * kept + variance;
    }

    #[inline(always)]
    pub fn check<L: Level>(&self, level: L) -> [T::Mask; 2] {
        let n = level.size(self.size());
        let (mean, cov) = (&self.mean[..n], &self.cov[..n * n]);
        let mut sum = T::of(0.0);
        let mut is_positive = T::Mask::of(true);
        for j in 0..n {
            // A sum is finite only if all its terms are, short of an overflow, which is as bad.
            let mut column = mean[j];
            for &entry in &cov[j * n + j..(j + 1) * n] {
                column = column + entry;
            }
            sum = sum + column;
            is_positive = is_positive & !cov[j * n + j].lt(T::of(0.0));
        }
        [sum.is_finite(), is_positive]
    }

    /// Gives a lane that has stopped numbers that never overflow. Lanes hold no root.
    pub fn park(&mut self, lane: usize) {
        let n = self.size();
        self.mean.iter_mut().for_each(|mean| mean.set_lane(lane, 0.0));
        for (at, entry) in self.cov.iter_mut().enumerate() {
            entry.set_lane(lane, if at % (n + 1) == 0 { 1.0 } else { 0.0 });
        }
    }
}

/// Converts mean and covariance to first order: the mean of θ is `exp` of that of `ln θ`, its std θ times that of `ln θ`. `unit` gets θ.
pub fn convert<T: Number>(
    logarithms: &[usize],
    unit: &mut [T],
    [mean, cov]: [&[T]; 2],
    belief: &mut GaussianBelief<T>,
) {
    belief.mean.copy_from_slice(mean);
    belief.cov.copy_from_slice(cov);
    for &place in logarithms {
        belief.mean[place] = mean[place].call(Function::Exp);
        unit[place] = belief.mean[place];
    }
    for (column, by) in belief.cov.chunks_exact_mut(unit.len()).zip(&*unit) {
        column.iter_mut().zip(&*unit).for_each(|(entry, unit)| *entry = *entry * (*unit * *by));
    }
}

/// Q of a shorter step is its share of Q, and λ a power; both are kept for the next step of the same length.
#[derive(Clone, Debug)]
pub(super) struct NoiseShare<T> {
    share: f64,
    noise: FilterNoise<T>,
}

impl<T: Number> NoiseShare<T> {
    pub(super) fn new(whole: &FilterNoise<T>) -> Self {
        Self { share: 1.0, noise: FilterNoise { sensors: Vec::new(), ..whole.clone() } }
    }

    #[inline(always)]
    pub(super) fn of<'a>(&'a mut self, share: f64, whole: &'a FilterNoise<T>) -> &'a FilterNoise<T> {
        if share == 1.0 {
            return whole;
        }
        if share != self.share {
            self.take(share, whole);
        }
        &self.noise
    }

    #[inline(never)]
    fn take(&mut self, share: f64, whole: &FilterNoise<T>) {
        let FilterNoise { process, matrix, fading, .. } = &mut self.noise;
        for (own, whole) in process.iter_mut().zip(&whole.process).chain(matrix.iter_mut().zip(&whole.matrix)) {
            *own = *whole * share;
        }
        *fading = T::from_lanes(|lane| libm::pow(whole.fading.lane(lane), share));
        self.share = share;
    }
}

/// Limits the rounding error of an estimate over a long record, relative to its largest value.
const ESTIMATE_ROUNDING: f64 = 64.0 * f64::EPSILON;

#[derive(Clone, Debug, Default)]
pub struct ErrorSquare<T> {
    pub places: Vec<usize>,
    pub errors: Vec<T>,
    /// The largest absolute mean of each channel so far; the rounding error of an estimate is relative to it.
    sizes: Vec<T>,
    variances: Vec<T>,
    factor: Vec<T>,
}

impl<T: Number> ErrorSquare<T> {
    pub fn new(places: Vec<usize>) -> Self {
        let (count, zeros) = (places.len(), |count: usize| vec![T::of(0.0); count]);
        Self {
            places,
            errors: zeros(count),
            sizes: zeros(count),
            variances: zeros(count),
            factor: zeros(count * count),
        }
    }

    /// `eᵀ P⁻¹ e` by the factor `P = L D Lᵀ` over the components of positive variance, and their number: zero where there is
    /// none, P is not positive definite or e is not a number. A variance is at least that of the rounding error.
    ///
    /// Source: Golub and Van Loan (2013), *Matrix Computations*, section 4.1.2.
    ///
    /// The places may be those of the `WHOLE` state.
    #[inline(always)]
    pub fn of<L: Level, const WHOLE: bool>(&mut self, level: L, [mean, cov]: [&[T]; 2]) -> (T, T) {
        let Self { places, errors, sizes, variances, factor } = self;
        let (zero, one) = (T::of(0.0), T::of(1.0));
        let n = level.size(mean.len());
        let count = if WHOLE { n } else { places.len() };
        let (mean, cov) = (&mean[..n], &cov[..n * n]);
        let (errors, sizes) = (&mut errors[..count], &mut sizes[..count]);
        let (variances, factor) = (&mut variances[..count], &mut factor[..count * count]);
        for j in 0..count {
            let place = |at: usize| if WHOLE { at } else { places[at] };
            for i in j..count {
                factor[j * count + i] = entry(cov, n, place(i), place(j));
            }
            sizes[j] = sizes[j].max(mean[place(j)].abs());
            let floor = sizes[j] * sizes[j] * (ESTIMATE_ROUNDING * ESTIMATE_ROUNDING);
            let variance = factor[j * count + j];
            variances[j] = T::select(zero.lt(variance), variance + floor, zero);
            factor[j * count + j] = variances[j];
        }
        let (mut sum, mut degrees, mut is_positive) = (zero, zero, T::Mask::of(true));
        each!(level, 0, count, |j| {
            let (variance, pivot) = (variances[j], factor[j * count + j]);
            let counts = zero.lt(variance);
            is_positive = is_positive & (!counts | (variance * (4.0 * count as f64 * f64::EPSILON)).lt(pivot));
            let inverse = T::select(counts, one / pivot, zero);
            degrees = degrees + T::select(counts, one, zero);
            sum = sum + errors[j] * errors[j] * inverse;
            for k in j + 1..count {
                let share = factor[j * count + k] * inverse;
                errors[k] = errors[k] - share * errors[j];
                for i in k..count {
                    factor[k * count + i] = factor[k * count + i] - factor[j * count + i] * share;
                }
            }
        });
        let counts = is_positive & sum.is_number();
        (sum, T::select(counts, degrees, zero))
    }
}
