//! Filters side by side: eight runs in the lanes of vector registers, two in a browser, each with the bits of the single filter.
//!
//! ```text
//! runs ──alike──▶ batches ──steps in lanes──▶ outcomes
//! ```
//!
//! The lanes are those of the core's engine; here are the choice of the instruction set while running, and the batches. Since no
//! operation is fused, all instructions give the same bits. [`outcomes`] runs a filter that has no lanes by itself.
//!
//! ```
//! use kalmanscope_core::{Run, Scenario};
//! use kalmanscope_lanes::{InstructionSet, LaneRun, outcomes};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scenario = Scenario { duration: 10.0, ..Scenario::default() };
//! let mut run = Run::new(&Scenario { filters: vec![], ..scenario.clone() })?;
//! run.finish();
//! let guesses: Vec<Scenario> = (0..12)
//!     .map(|i| {
//!         let mut guess = scenario.clone();
//!         guess.filters[0].initial_mean[kalmanscope_core::Channel::NATURAL_FREQUENCY] = 4.0 + 0.5 * f64::from(i);
//!         guess
//!     })
//!     .collect();
//! let runs: Vec<LaneRun> = guesses.iter().map(|scenario| LaneRun { scenario, place: 0, record: run.record() }).collect();
//! let outcomes = outcomes(InstructionSet::best(), &runs, &[])?;
//! assert!(outcomes.iter().all(|outcome| (outcome.mean[2] - 6.0).abs() < 0.5));
//! # Ok(())
//! # }
//! ```

#[cfg(not(target_arch = "wasm32"))]
use kalmanscope_core::internals::engine::Baseline;
#[cfg(any(target_arch = "x86_64", target_arch = "wasm32"))]
use kalmanscope_core::internals::engine::Known;
use kalmanscope_core::internals::engine::{self, Setup, SetupRun};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Record, RunError, Scenario};

/// One filter of a scenario, to be run over a record.
#[derive(Clone, Copy, Debug)]
pub struct LaneRun<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The place of the filter in it.
    pub place: usize,
    /// The record.
    pub record: &'a Record,
}

/// Whether lanes serve a run: any that the [engine](Setup::new) serves. [`outcomes`] runs others too, like a single filter.
///
/// # Errors
/// Those of [`Setup::new`].
pub fn serves(run: &LaneRun<'_>) -> Result<bool, RunError> {
    Ok(Setup::new(run.scenario, run.place, run.record)?.is_some())
}

/// The outcomes of some runs, in their order, with these instructions, or the best ones below them that the processor has. Runs that
/// differ in numbers only, over one record or over records of the same length and dt, run side by side. Each has the bits of
/// [`Outcome::at`], whatever the other runs, with looks at the filters at these samples, which are in order.
///
/// # Errors
/// Those of [`Setup::new`], for the first run that has one.
pub fn outcomes(level: InstructionSet, runs: &[LaneRun<'_>], samples: &[usize]) -> Result<Vec<Outcome>, RunError> {
    let setups: Result<Vec<Option<Setup>>, RunError> =
        runs.iter().map(|run| Setup::new(run.scenario, run.place, run.record)).collect();
    let setups = setups?;
    let mut results: Vec<Option<Outcome>> = vec![None; runs.len()];
    for group in groups(&setups, runs) {
        for members in group.chunks(LANES) {
            let batch: Vec<SetupRun<'_>> = members.iter().map(|(_, run)| *run).collect();
            for ((place, _), outcome) in members.iter().zip(level.outcomes(&batch, samples)) {
                results[*place] = Some(outcome);
            }
        }
    }
    let single = |(result, run): (Option<Outcome>, &LaneRun<'_>)| match result {
        Some(outcome) => Ok(outcome),
        None => Outcome::at(run.scenario, run.place, run.record, samples),
    };
    results.into_iter().zip(runs).map(single).collect()
}

fn groups<'a>(setups: &'a [Option<Setup>], runs: &[LaneRun<'a>]) -> Vec<Vec<(usize, SetupRun<'a>)>> {
    let mut groups: Vec<Vec<(usize, SetupRun<'a>)>> = Vec::new();
    for (place, (setup, LaneRun { record, .. })) in setups.iter().zip(runs).enumerate() {
        let Some(setup) = setup else { continue };
        let run = SetupRun { setup, record };
        match groups.iter_mut().find(|group| group[0].1.goes_with(&run)) {
            Some(group) => group.push((place, run)),
            None => groups.push(vec![(place, run)]),
        }
    }
    for group in &mut groups {
        group.sort_by_key(|(_, run)| std::ptr::from_ref(run.record).addr());
    }
    groups
}

/// The number of lanes: eight numbers are a line of a cache, and a browser has vectors of two.
pub const LANES: usize = if cfg!(target_arch = "wasm32") { 2 } else { 8 };

#[cfg(not(target_arch = "wasm32"))]
type Numbers = engine::Lanes<LANES>;
#[cfg(target_arch = "wasm32")]
type Numbers = engine::LanePair;

/// A set of instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum InstructionSet {
    /// The instructions that every processor of the target has: SSE2 on x86-64. In a page, those of WebAssembly with vectors.
    Baseline,
    /// AVX2.
    Avx2,
}

impl InstructionSet {
    /// Those that this processor has, the best one last.
    pub fn available() -> Vec<Self> {
        #[cfg(target_arch = "x86_64")]
        if fearless_simd::Level::new().as_avx2().is_some() {
            return vec![Self::Baseline, Self::Avx2];
        }
        vec![Self::Baseline]
    }

    /// The best one that this processor has.
    pub fn best() -> Self {
        Self::available().last().copied().unwrap_or(Self::Baseline)
    }

    fn outcomes(self, batch: &[SetupRun<'_>], samples: &[usize]) -> Vec<Outcome> {
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

/// The compiler knows the sizes of the usual oscillators, so that their loops become straight code.
#[cfg(any(target_arch = "x86_64", target_arch = "wasm32"))]
fn of_size<L: engine::Level>(level: L, batch: &[SetupRun<'_>], samples: &[usize]) -> Vec<Outcome> {
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
