//! Runs that the engine runs side by side.

use kalmanscope_core::RunError;
#[cfg(target_arch = "x86_64")]
use kalmanscope_core::internals::engine::Known;
use kalmanscope_core::internals::engine::{self, Baseline, Run, Setup};
use kalmanscope_core::score::Outcome;

use crate::lane::LANES;
use crate::lane_run::LaneRun;
use crate::level::Level;

type Lanes = engine::Lanes<LANES>;

/// The instructions of AVX2.
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

/// Whether the engine takes a run.
///
/// # Errors
/// Those of [`Setup::new`].
pub(crate) fn serves(run: &LaneRun<'_>) -> Result<bool, RunError> {
    Ok(Setup::new(run.scenario, run.place, run.record)?.is_some())
}

/// Runs those without an outcome that the engine serves.
///
/// # Errors
/// Those of [`Setup::new`], for the first run that has one.
pub(crate) fn run(
    level: Level,
    runs: &[LaneRun<'_>],
    samples: &[usize],
    results: &mut [Option<Outcome>],
) -> Result<(), RunError> {
    let mut setups = Vec::new();
    for (place, (run, result)) in runs.iter().zip(&*results).enumerate() {
        if result.is_none()
            && let Some(setup) = Setup::new(run.scenario, run.place, run.record)?
        {
            setups.push((place, setup));
        }
    }
    for group in groups(&setups, runs) {
        for members in group.chunks(LANES) {
            let batch: Vec<Run<'_>> =
                members.iter().map(|(place, setup)| Run { setup, record: runs[*place].record }).collect();
            for ((place, _), outcome) in members.iter().zip(outcomes(level, &batch, samples)) {
                results[*place] = Some(outcome);
            }
        }
    }
    Ok(())
}

/// A run's place, and its filter.
type Member<'a> = &'a (usize, Setup);

/// The runs that can go side by side; those over one record come together.
fn groups<'a>(setups: &'a [(usize, Setup)], runs: &[LaneRun<'_>]) -> Vec<Vec<Member<'a>>> {
    let mut groups: Vec<Vec<Member<'a>>> = Vec::new();
    let run = |(place, setup): Member<'a>| Run { setup, record: runs[*place].record };
    for member in setups {
        match groups.iter_mut().find(|group| run(group[0]).goes_with(&run(member))) {
            Some(group) => group.push(member),
            None => groups.push(vec![member]),
        }
    }
    for group in &mut groups {
        group.sort_by_key(|(place, _)| std::ptr::from_ref(runs[*place].record).addr());
    }
    groups
}

/// The outcomes of a batch with these instructions, or with the best ones below them that the processor has.
#[cfg_attr(not(target_arch = "x86_64"), expect(unused_variables, reason = "there is one level"))]
fn outcomes(level: Level, batch: &[Run<'_>], samples: &[usize]) -> Vec<Outcome> {
    #[cfg(target_arch = "x86_64")]
    if level > Level::Baseline
        && let Some(token) = fearless_simd::Level::new().as_avx2()
    {
        return of_size(Avx2(token), batch, samples);
    }
    engine::outcomes::<Lanes, _>(Baseline, batch, samples)
}

/// The usual oscillators have sizes that the compiler knows. With [`Baseline`], of old processors and pages, one version for all
/// sizes is enough: more take long to compile.
#[cfg(target_arch = "x86_64")]
fn of_size(level: Avx2, batch: &[Run<'_>], samples: &[usize]) -> Vec<Outcome> {
    let model = &batch[0].setup.design.model;
    match (model.size, model.moving()) {
        (4, 2) => engine::outcomes::<Lanes, _>(Known::<_, 4, 2>(level), batch, samples),
        (5, 2) => engine::outcomes::<Lanes, _>(Known::<_, 5, 2>(level), batch, samples),
        _ => engine::outcomes::<Lanes, _>(level, batch, samples),
    }
}
