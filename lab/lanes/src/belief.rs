//! Beliefs and noise of filters side by side.

use crate::lane::{LANES, Lane};
use crate::plant::Plant;
use kalmanscope_core::internals::kernel::OscillatorFilter;
use kalmanscope_core::internals::kernel::{Gaussian, Matrix, Vector};

/// The lower triangle of a symmetric N × N matrix, column by column.
pub(crate) struct Triangle<const N: usize>;

impl<const N: usize> Triangle<N> {
    /// The place of each entry.
    pub(crate) const AT: [[usize; N]; N] = {
        let mut at = [[0; N]; N];
        let (mut j, mut place) = (0, 0);
        while j < N {
            let mut i = j;
            while i < N {
                (at[i][j], at[j][i]) = (place, place);
                (i, place) = (i + 1, place + 1);
            }
            j += 1;
        }
        at
    };
}

/// Mean, and the lower triangle of the covariance, which has E entries.
#[derive(Clone, Copy)]
pub(crate) struct Belief<T, const N: usize, const E: usize> {
    pub(crate) mean: [T; N],
    pub(crate) cov: [T; E],
}

impl<T: Lane, const N: usize, const E: usize> Belief<T, N, E> {
    pub(crate) fn new(token: T::Token, beliefs: &[Gaussian<N>; LANES]) -> Self {
        let mean = |i: usize| T::from_array(token, std::array::from_fn(|lane| beliefs[lane].mean[i]));
        let mut cov = [T::splat(token, 0.0); E];
        for j in 0..N {
            for i in j..N {
                cov[Triangle::<N>::AT[i][j]] =
                    T::from_array(token, std::array::from_fn(|lane| beliefs[lane].cov[(i, j)]));
            }
        }
        Self { mean: std::array::from_fn(mean), cov }
    }

    /// The beliefs of all lanes.
    pub(crate) fn split(&self) -> [Gaussian<N>; LANES] {
        let (mean, cov) = (self.mean.map(T::to_array), self.cov.map(T::to_array));
        std::array::from_fn(|lane| Gaussian {
            mean: Vector::from_fn(|i, _| mean[i][lane]),
            cov: Matrix::from_fn(|i, j| cov[Triangle::<N>::AT[i][j]][lane]),
        })
    }

    /// An entry of the covariance.
    #[inline(always)]
    pub(crate) fn cov(&self, i: usize, j: usize) -> T {
        self.cov[Triangle::<N>::AT[i][j]]
    }

    /// Whether a belief can be one: finite, and without a negative variance.
    #[inline(always)]
    pub(crate) fn is_valid(&self) -> T::Mask {
        let zero = self.mean[0].of(0.0);
        let mut sum = zero;
        let mut valid = zero.le(self.cov[0]);
        for i in 0..N {
            let mut row = self.mean[i];
            for j in 0..N {
                row = row + self.cov(i, j);
            }
            sum = sum + row;
            valid = valid & zero.le(self.cov(i, i));
        }
        valid & sum.is_finite()
    }

    /// `λ P + Q`; a variance that rounding made negative becomes zero.
    #[inline(always)]
    pub(crate) fn spread(&mut self, noise: &Noise<T, N>) {
        let zero = noise.fading.of(0.0);
        for j in 0..N {
            for i in j..N {
                // A sum with zero makes zero of -0.
                let process = if i == j { noise.process[i] } else { zero };
                self.cov[Triangle::<N>::AT[i][j]] = self.cov[Triangle::<N>::AT[i][j]] * noise.fading + process;
            }
            let variance = &mut self.cov[Triangle::<N>::AT[j][j]];
            *variance = T::select(variance.lt(zero), zero, *variance);
        }
    }
}

/// The noise and the decay that the filters assume.
#[derive(Clone, Copy)]
pub(crate) struct Noise<T, const N: usize> {
    /// Diagonal of Q.
    pub(crate) process: [T; N],
    pub(crate) fading: T,
    /// η \[1/s\]: zero in all lanes or in none.
    pub(crate) eta: T,
    /// exp(-η dt)
    pub(crate) decay: T,
}

impl<T: Lane, const N: usize> Noise<T, N> {
    pub(crate) fn new<P: Plant<N>>(token: T::Token, filters: [&OscillatorFilter<P, N>; LANES]) -> Self {
        let of = |f: &dyn Fn(&OscillatorFilter<P, N>) -> f64| T::from_array(token, filters.map(f));
        Self {
            process: std::array::from_fn(|i| of(&|filter| filter.noise.process[(i, i)])),
            fading: of(&|filter| filter.noise.fading),
            eta: of(&|filter| filter.plant.eta()),
            decay: of(&|filter| libm::exp(-filter.plant.eta() * filter.dt)),
        }
    }
}
