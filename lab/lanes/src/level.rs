//! The choice of an instruction set while running.

#[cfg(not(target_arch = "wasm32"))]
use kalmanscope_core::internals::engine::Baseline;
#[cfg(any(target_arch = "x86_64", target_arch = "wasm32"))]
use kalmanscope_core::internals::engine::Known;
use kalmanscope_core::internals::engine::{self, Run};
use kalmanscope_core::score::Outcome;

/// The number of lanes: eight numbers are a line of a cache, and a browser has vectors of two.
pub const LANES: usize = if cfg!(target_arch = "wasm32") { 2 } else { 8 };

#[cfg(not(target_arch = "wasm32"))]
type Numbers = engine::Lanes<LANES>;
#[cfg(target_arch = "wasm32")]
type Numbers = engine::LanePair;

/// A set of instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// The instructions that every processor of the target has: SSE2 on x86-64. In a page, those of WebAssembly with vectors.
    Baseline,
    /// AVX2.
    Avx2,
}

impl Level {
    /// Those that this processor has, the best one last.
    pub fn available() -> Vec<Self> {
        [Self::Baseline, Self::Avx2].into_iter().filter(|level| level.is_available()).collect()
    }

    /// The best one that this processor has.
    pub fn best() -> Self {
        Self::available().last().copied().unwrap_or(Self::Baseline)
    }

    #[cfg(target_arch = "x86_64")]
    fn is_available(self) -> bool {
        self == Self::Baseline || fearless_simd::Level::new().as_avx2().is_some()
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn is_available(self) -> bool {
        self == Self::Baseline
    }

    /// The outcomes of a batch with these instructions, or with the best ones below them that the processor has.
    pub(crate) fn outcomes(self, batch: &[Run<'_>], samples: &[usize]) -> Vec<Outcome> {
        #[cfg(target_arch = "x86_64")]
        if self > Self::Baseline
            && let Some(token) = fearless_simd::Level::new().as_avx2()
        {
            return of_size(Avx2(token), batch, samples);
        }
        // Versions of known sizes take long to compile, and old processors are few.
        #[cfg(not(target_arch = "wasm32"))]
        return engine::outcomes::<Numbers, _>(Baseline, batch, samples);
        #[cfg(target_arch = "wasm32")]
        of_size(Simd128, batch, samples)
    }
}

/// The usual oscillators have sizes that the compiler knows.
#[cfg(any(target_arch = "x86_64", target_arch = "wasm32"))]
fn of_size<L: engine::Level>(level: L, batch: &[Run<'_>], samples: &[usize]) -> Vec<Outcome> {
    let model = &batch[0].setup.design.model;
    match (model.size, model.moving()) {
        (4, 2) => engine::outcomes::<Numbers, _>(Known::<_, 4, 2>(level), batch, samples),
        (5, 2) => engine::outcomes::<Numbers, _>(Known::<_, 5, 2>(level), batch, samples),
        _ => engine::outcomes::<Numbers, _>(level, batch, samples),
    }
}

#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
struct Avx2(fearless_simd::Avx2);

#[cfg(target_arch = "x86_64")]
impl engine::Level for Avx2 {
    type Plain = Self;

    #[inline(always)]
    fn plain(self) -> Self {
        self
    }

    #[inline(never)]
    fn apart<R>(self, work: impl FnOnce() -> R) -> R {
        fearless_simd::Simd::vectorize(self.0, work)
    }
}

#[cfg(target_arch = "wasm32")]
#[derive(Clone, Copy)]
struct Simd128;

#[cfg(target_arch = "wasm32")]
impl engine::Level for Simd128 {
    type Plain = Self;

    #[inline(always)]
    fn plain(self) -> Self {
        self
    }

    #[inline(always)]
    fn apart<R>(self, work: impl FnOnce() -> R) -> R {
        // Most work has one caller, which keeps numbers in registers if it takes the work in.
        #[inline]
        #[target_feature(enable = "simd128")]
        fn with_vectors<R>(work: impl FnOnce() -> R) -> R {
            work()
        }
        with_vectors(work)
    }
}
