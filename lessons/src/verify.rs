//! Tries the checks of lessons over seeds.

use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};

use kalmanscope_core::{Scenario, Source};
use kalmanscope_diagnosis::Value;

use crate::check::Check;
use crate::{AnalysedRun, Claim, Lesson, LessonError, grid, records};

/// Runs a lesson with each seed and evaluates its checks, in the order of the file. A measured record is the same with
/// each seed.
///
/// # Errors
/// [`LessonError`] where the lesson's scenarios are impossible, which [`Lesson::from_toml`] rules out.
pub fn verify(lesson: &Lesson, seeds: impl IntoIterator<Item = u64>) -> Result<Vec<Claim>, LessonError> {
    verify_with(lesson, seeds, &records::source)
}

/// As [`verify`], with a source of samples for each scenario, which has the seed. So a lesson on one measured record is
/// tried on others of its kind.
///
/// # Errors
/// As [`verify`], and those of `source`.
pub fn verify_with(
    lesson: &Lesson,
    seeds: impl IntoIterator<Item = u64>,
    source: &dyn Fn(&Scenario) -> Result<Source, LessonError>,
) -> Result<Vec<Claim>, LessonError> {
    let claim = |step: usize, check: &Check| {
        let (lesson, check) = (lesson.title.clone(), check.clone());
        Claim { lesson, step, check, values: Vec::new() }
    };
    let steps = lesson.steps.iter().enumerate();
    let mut claims: Vec<Claim> =
        steps.flat_map(|(number, step)| step.checks.iter().map(move |check| claim(number, check))).collect();
    let (first, scenarios) = (lesson.first_scenario()?, lesson.scenarios()?);
    for seed in seeds {
        let run = |scenario: &Scenario| {
            let scenario = Scenario { seed, ..scenario.clone() };
            AnalysedRun::on(&scenario, source(&scenario)?)
        };
        let mut before = run(&first)?;
        for (number, (step, scenario)) in lesson.steps.iter().zip(&scenarios).enumerate() {
            let changed = if step.change.is_some() { Some(run(scenario)?) } else { None };
            let now = changed.as_ref().unwrap_or(&before);
            let mut tried: Vec<&mut Claim> = claims
                .iter_mut()
                .filter(|claim| claim.step == number && claim.check.seed.is_none_or(|only| only == seed))
                .collect();
            let checks: Vec<&Check> = tried.iter().map(|claim| &claim.check).collect();
            let shares = shares(&checks, scenario, &run).map_err(|error| error.in_step(number))?;
            for (claim, share) in tried.iter_mut().zip(shares) {
                let value = share.map_or_else(|| claim.check.value(now, &before), |share| Ok(Value::Number(share)));
                claim.values.push((seed, value.map_err(|error| error.in_step(number))?));
            }
            // A step without a change keeps the run before it: nothing runs twice.
            before = changed.unwrap_or(before);
        }
    }
    Ok(claims)
}

/// As [`verify`], for several lessons, on a thread for each processor. The claims are in the order of the lessons.
///
/// # Errors
/// As [`verify`].
///
/// # Panics
/// Where a filter panics, which is a fault of the program.
pub fn verify_all(lessons: &[Lesson], seeds: &[u64]) -> Result<Vec<Claim>, LessonError> {
    // A seed of a lesson is a task: lessons differ much in their cost.
    let tasks: Vec<(usize, u64)> =
        seeds.iter().flat_map(|&seed| (0..lessons.len()).map(move |lesson| (lesson, seed))).collect();
    let next = AtomicUsize::new(0);
    let work = || {
        let task = || tasks.get(next.fetch_add(1, Ordering::Relaxed)).copied();
        std::iter::from_fn(task)
            .map(|(lesson, seed)| Ok((lesson, verify(&lessons[lesson], [seed])?)))
            .collect::<Result<Vec<_>, LessonError>>()
    };
    let threads = std::thread::available_parallelism().map_or(1, NonZero::get);
    let done = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        let results = workers.into_iter().map(|worker| worker.join().unwrap_or_else(|e| std::panic::resume_unwind(e)));
        results.collect::<Result<Vec<_>, LessonError>>()
    })?;
    let mut claims = lessons.iter().map(|lesson| verify(lesson, [])).collect::<Result<Vec<_>, LessonError>>()?;
    for (lesson, tried) in done.into_iter().flatten() {
        for (claim, one) in claims[lesson].iter_mut().zip(tried) {
            claim.values.extend(one.values);
        }
    }
    let mut claims: Vec<Claim> = claims.into_iter().flatten().collect();
    for claim in &mut claims {
        claim.values.sort_unstable_by_key(|(seed, _)| *seed);
    }
    Ok(claims)
}

/// The shares of the cells in which checks hold: each cell of a grid is run once for all checks over that grid.
fn shares(
    checks: &[&Check],
    scenario: &Scenario,
    run: &dyn Fn(&Scenario) -> Result<AnalysedRun, LessonError>,
) -> Result<Vec<Option<f64>>, LessonError> {
    let grid = |place: usize| checks[place].cells.as_ref().map(|cells| (&cells.x, &cells.y));
    let mut shares = vec![None; checks.len()];
    for first in 0..checks.len() {
        let Some(cells) = checks[first].cells.as_ref().filter(|_| shares[first].is_none()) else { continue };
        let same: Vec<usize> = (first..checks.len()).filter(|&other| grid(other) == grid(first)).collect();
        let scenarios = grid::cells(scenario, &cells.axes()?)?;
        let mut hits = vec![0_usize; same.len()];
        for scenario in &scenarios {
            let outcome = run(scenario)?;
            for (&place, hits) in same.iter().zip(&mut hits) {
                *hits += usize::from(checks[place].holds_in(&outcome)?);
            }
        }
        for (place, hits) in same.into_iter().zip(hits) {
            shares[place] = Some(hits as f64 / scenarios.len() as f64);
        }
    }
    Ok(shares)
}
