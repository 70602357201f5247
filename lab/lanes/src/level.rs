//! The choice of an instruction set while running.

use kalmanscope_core::internals::kernel::Method;
use kalmanscope_core::score::Outcome;

#[cfg(not(target_arch = "wasm32"))]
use crate::array::Array;
use crate::lane::LANES;
use crate::observation::{Observations, Run};
use crate::plant::Plant;
use crate::run::run;

/// A set of instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// That of every processor of the target: SSE2 on x86-64.
    Baseline,
    /// AVX2.
    Avx2,
    /// AVX-512, as processors have it since Ice Lake.
    Avx512,
}

impl Level {
    /// Those that this processor has, the best one last.
    pub fn available() -> Vec<Self> {
        [Self::Baseline, Self::Avx2, Self::Avx512].into_iter().filter(|level| level.is_available()).collect()
    }

    /// The best one that this processor has.
    pub fn best() -> Self {
        Self::available().last().copied().unwrap_or(Self::Baseline)
    }

    #[cfg(target_arch = "x86_64")]
    fn is_available(self) -> bool {
        let best = fearless_simd::Level::new();
        match self {
            Self::Baseline => true,
            Self::Avx2 => best.as_avx2().is_some(),
            Self::Avx512 => best.as_avx512().is_some(),
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn is_available(self) -> bool {
        self == Self::Baseline
    }

    /// Runs a batch with these instructions, or with the best ones below them that the processor has.
    pub(crate) fn run<P: Plant<N>, const N: usize, const E: usize>(
        self,
        runs: &[Run<'_, P, N>; LANES],
        observations: &Observations<'_, N>,
        samples: &[usize],
    ) -> [Option<Outcome>; LANES] {
        let is_ukf = runs[0].filter.method == Method::SigmaPoints;
        #[cfg(target_arch = "x86_64")]
        if self > Self::Baseline {
            let best = fearless_simd::Level::new();
            if let Some(token) = best.as_avx512().filter(|_| self == Self::Avx512) {
                return with_vectors::<_, P, N, E>(token, is_ukf, runs, observations, samples);
            }
            if let Some(token) = best.as_avx2() {
                return with_vectors::<_, P, N, E>(token, is_ukf, runs, observations, samples);
            }
        }
        #[cfg(target_arch = "wasm32")]
        return if is_ukf {
            with_pairs::<P, N, E, true>(runs, observations, samples)
        } else {
            with_pairs::<P, N, E, false>(runs, observations, samples)
        };
        #[cfg(not(target_arch = "wasm32"))]
        if is_ukf {
            run::<P, Array, N, E, true>((), runs, observations, samples)
        } else {
            run::<P, Array, N, E, false>((), runs, observations, samples)
        }
    }
}

#[cfg(target_arch = "wasm32")]
#[inline(never)]
#[target_feature(enable = "simd128")]
fn with_pairs<P: Plant<N>, const N: usize, const E: usize, const UKF: bool>(
    runs: &[Run<'_, P, N>; LANES],
    observations: &Observations<'_, N>,
    samples: &[usize],
) -> [Option<Outcome>; LANES] {
    run::<P, crate::pair::Pair, N, E, UKF>((), runs, observations, samples)
}

#[cfg(target_arch = "x86_64")]
fn with_vectors<S: fearless_simd::Simd, P: Plant<N>, const N: usize, const E: usize>(
    token: S,
    is_ukf: bool,
    runs: &[Run<'_, P, N>; LANES],
    observations: &Observations<'_, N>,
    samples: &[usize],
) -> [Option<Outcome>; LANES] {
    use crate::vector::Vector;
    if is_ukf {
        token.vectorize(
            #[inline(always)]
            || run::<P, Vector<S>, N, E, true>(token, runs, observations, samples),
        )
    } else {
        token.vectorize(
            #[inline(always)]
            || run::<P, Vector<S>, N, E, false>(token, runs, observations, samples),
        )
    }
}
