//! Beliefs and noise of filters side by side.

use crate::lane::{LANES, Lane};
use kalmanscope_core::kernel::abreast::OscillatorFilter;
use kalmanscope_core::kernel::gaussian::{Gaussian, Matrix, Vector};

/// The number of components of the state `[x, v, ωₙ, ζ]`.
pub(crate) const N: usize = 4;

/// The place of each entry of a symmetric matrix in its lower triangle, column by column.
pub(crate) const AT: [[usize; N]; N] = [[0, 1, 2, 3], [1, 4, 5, 6], [2, 5, 7, 8], [3, 6, 8, 9]];

/// Mean, and the lower triangle of the covariance.
#[derive(Clone, Copy)]
pub(crate) struct Belief<T> {
    pub(crate) mean: [T; N],
    pub(crate) cov: [T; 10],
}

impl<T: Lane> Belief<T> {
    pub(crate) fn new(token: T::Token, beliefs: &[Gaussian<N>; LANES]) -> Self {
        let mean = |i: usize| T::from_array(token, std::array::from_fn(|lane| beliefs[lane].mean[i]));
        let mut cov = [T::splat(token, 0.0); 10];
        for j in 0..N {
            for i in j..N {
                cov[AT[i][j]] = T::from_array(token, std::array::from_fn(|lane| beliefs[lane].cov[(i, j)]));
            }
        }
        Self { mean: std::array::from_fn(mean), cov }
    }

    /// The beliefs of all lanes.
    pub(crate) fn split(&self) -> [Gaussian<N>; LANES] {
        let (mean, cov) = (self.mean.map(T::to_array), self.cov.map(T::to_array));
        std::array::from_fn(|lane| Gaussian {
            mean: Vector::from_fn(|i, _| mean[i][lane]),
            cov: Matrix::from_fn(|i, j| cov[AT[i][j]][lane]),
        })
    }

    /// An entry of the covariance.
    #[inline(always)]
    pub(crate) fn cov(&self, i: usize, j: usize) -> T {
        self.cov[AT[i][j]]
    }

    /// Whether a belief can be one: finite, and without a negative variance.
    #[inline(always)]
    pub(crate) fn is_valid(&self) -> T::Mask {
        let zero = self.mean[0].of(0.0);
        let mut sum = zero;
        let mut valid = zero.le(self.cov[0]);
        for i in 0..N {
            let row = self.mean[i] + self.cov(i, 0) + self.cov(i, 1) + self.cov(i, 2) + self.cov(i, 3);
            sum = sum + row;
            valid = valid & zero.le(self.cov(i, i));
        }
        valid & sum.is_finite()
    }

    /// `λ P + Q`; a variance that is zero but for rounding may have come out on the wrong side.
    #[inline(always)]
    pub(crate) fn spread(&mut self, noise: &Noise<T>) {
        let zero = noise.fading.of(0.0);
        for j in 0..N {
            for i in j..N {
                // A sum with zero makes zero of -0.
                let process = if i == j { noise.process[i] } else { zero };
                self.cov[AT[i][j]] = self.cov[AT[i][j]] * noise.fading + process;
            }
            let variance = &mut self.cov[AT[j][j]];
            *variance = T::select(variance.lt(zero), zero, *variance);
        }
    }
}

/// The noise and the decay that the filters assume.
#[derive(Clone, Copy)]
pub(crate) struct Noise<T> {
    /// Diagonal of Q.
    pub(crate) process: [T; N],
    pub(crate) fading: T,
    /// η \[1/s\]: zero in all lanes or in none.
    pub(crate) eta: T,
    /// exp(-η dt)
    pub(crate) decay: T,
}

impl<T: Lane> Noise<T> {
    pub(crate) fn new(token: T::Token, filters: [&OscillatorFilter; LANES]) -> Self {
        let of = |f: &dyn Fn(&OscillatorFilter) -> f64| T::from_array(token, filters.map(f));
        Self {
            process: std::array::from_fn(|i| of(&|filter| filter.noise.process[(i, i)])),
            fading: of(&|filter| filter.noise.fading),
            eta: of(&|filter| filter.eta),
            decay: of(&|filter| libm::exp(-filter.eta * filter.dt)),
        }
    }
}
