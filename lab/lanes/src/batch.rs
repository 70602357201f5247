//! Runs in batches of those that are alike.

use kalmanscope_core::kernel::abreast::{Method, OscillatorFilter};
use kalmanscope_core::kernel::model::Output;
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Record, RunError, Scenario};

use crate::lane::LANES;
use crate::level::Level;
use crate::observation::{CHANNELS, MOST, Observations, Run, knows_truth};

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

/// Whether a run goes in lanes: a KF, EKF or UKF of the linear oscillator with at most three sensors, for displacement,
/// velocity or acceleration, with or without fading, decay of the parameters and a delay of the input, under an input that is
/// held. [`outcomes`] takes any other run too, at the pace of a single filter.
///
/// # Errors
/// Those of [`Pass::new`](kalmanscope_core::Pass::new).
pub fn serves(run: &LaneRun<'_>) -> Result<bool, RunError> {
    Ok(prepare(run)?.is_some())
}

/// The outcomes of some runs, in their order, with the best instructions that this processor has. Runs that differ in numbers
/// only, over one record or over records of the same length and dt, go side by side. Each has the bits of [`Outcome::of`].
///
/// # Errors
/// Those of [`Pass::new`](kalmanscope_core::Pass::new), for the first run that has one.
pub fn outcomes(runs: &[LaneRun<'_>]) -> Result<Vec<Outcome>, RunError> {
    outcomes_with(Level::best(), runs, &[])
}

/// [`outcomes`] with these instructions, or the best ones below them that the processor has, and with looks at the filters at
/// these samples, which are in order, as those of [`Outcome::at`].
///
/// # Errors
/// Those of [`outcomes`].
pub fn outcomes_with(level: Level, runs: &[LaneRun<'_>], samples: &[usize]) -> Result<Vec<Outcome>, RunError> {
    let filters = runs.iter().map(prepare).collect::<Result<Vec<_>, _>>()?;
    let mut results: Vec<Option<Outcome>> = vec![None; runs.len()];
    for group in groups(&filters, runs) {
        for places in group.chunks(LANES) {
            run_batch(level, places, &filters, runs, samples, &mut results);
        }
    }
    let single = |(result, run): (Option<Outcome>, &LaneRun<'_>)| match result {
        Some(outcome) => Ok(outcome),
        None => Outcome::at(run.scenario, run.place, run.record, samples),
    };
    results.into_iter().zip(runs).map(single).collect()
}

/// The filter of a run, if it goes in lanes.
fn prepare(run: &LaneRun<'_>) -> Result<Option<OscillatorFilter>, RunError> {
    let LaneRun { scenario, place, record } = *run;
    let filter = OscillatorFilter::new(scenario, place, record)?;
    Ok(filter.filter(|filter| {
        let outputs = || filter.outputs.iter().flatten();
        let is_known = |output: &Output| matches!(output, Output::State(0 | 1) | Output::Rate(1));
        let is_truth_whole = knows_truth(record) || CHANNELS.iter().all(|&channel| record.truth(channel).is_none());
        outputs().all(is_known)
            && outputs().count() <= MOST
            && record.forgotten() == 0
            && !record.is_empty()
            && is_truth_whole
            && !has_certain_component(filter)
    }))
}

/// Whether a UKF knows a component for certain: every step would be special.
fn has_certain_component(filter: &OscillatorFilter) -> bool {
    let OscillatorFilter { method, initial, noise, .. } = filter;
    let is_certain = |i: usize| initial.cov[(i, i)] == 0.0 && noise.process[(i, i)] == 0.0;
    *method == Method::SigmaPoints && (2..4).any(is_certain)
}

/// The properties that all lanes of a batch must share.
#[derive(PartialEq)]
struct Kind<'a> {
    method: Method,
    decays: bool,
    dt: f64,
    samples: usize,
    outputs: &'a [Option<Output>],
    knows_truth: bool,
}

/// The places of runs that can go side by side; those over one record stand together.
fn groups(filters: &[Option<OscillatorFilter>], runs: &[LaneRun<'_>]) -> Vec<Vec<usize>> {
    let mut groups: Vec<(Kind<'_>, Vec<usize>)> = Vec::new();
    for (place, (filter, run)) in filters.iter().zip(runs).enumerate() {
        let Some(OscillatorFilter { method, eta, dt, outputs, .. }) = filter else { continue };
        let kind = Kind {
            method: *method,
            decays: *eta != 0.0,
            dt: *dt,
            samples: run.record.len(),
            outputs,
            knows_truth: knows_truth(run.record),
        };
        match groups.iter_mut().find(|(other, _)| *other == kind) {
            Some((_, places)) => places.push(place),
            None => groups.push((kind, vec![place])),
        }
    }
    let mut places: Vec<Vec<usize>> = groups.into_iter().map(|(_, places)| places).collect();
    for group in &mut places {
        group.sort_by_key(|&place| std::ptr::from_ref(runs[place].record).addr());
    }
    places
}

/// Runs as many filters as there are lanes, or fewer; lanes that are left over repeat the last one.
fn run_batch(
    level: Level,
    places: &[usize],
    filters: &[Option<OscillatorFilter>],
    runs: &[LaneRun<'_>],
    samples: &[usize],
    results: &mut [Option<Outcome>],
) {
    // A batch costs more than one filter alone.
    let [_, _, ..] = places else { return };
    let of = |place: usize| Some(Run { filter: filters[place].as_ref()?, record: runs[place].record });
    let all: Option<Vec<Run<'_>>> = places.iter().map(|&place| of(place)).collect();
    let Some(mut all) = all else { return };
    let Some(&last) = all.last() else { return };
    all.resize(LANES, last);
    let Ok(batch) = <[Run<'_>; LANES]>::try_from(all) else { return };
    let is_same = |run: &Run<'_>| {
        std::ptr::eq(run.record, last.record)
            && (&run.filter.columns, run.filter.input_delay) == (&last.filter.columns, last.filter.input_delay)
    };
    let distinct = if batch.iter().all(is_same) { 1 } else { LANES };
    let forces: Vec<Vec<f64>> = batch[..distinct].iter().map(|run| run.forces()).collect();
    let outcomes = level.run(&batch, &Observations::new(&batch, &forces), samples);
    for (&place, outcome) in places.iter().zip(outcomes) {
        results[place] = outcome;
    }
}
