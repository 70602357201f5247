//! Runs in batches of those that are alike.

use kalmanscope_core::internals::kernel::Output;
use kalmanscope_core::internals::kernel::{Method, OscillatorFilter};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Pass, RunError};

use crate::engine;
use crate::lane::LANES;
use crate::lane_run::LaneRun;
use crate::level::Level;
use crate::observation::{MOST, Observations, Run, knows_truth};
use crate::plant::{Plant, Visitor, visit};

/// Whether lanes serve a run: a KF, EKF or UKF of the linear oscillator, or of the Duffing oscillator by the single steps of the book, with at most three sensors, for
/// displacement, velocity or acceleration, with or without fading, decay of the parameters and a delay of the input, under
/// an input that is held; also any run that the [engine](kalmanscope_core::internals::engine::Setup::new) serves.
/// [`outcomes`] runs all others too, at the speed of a single filter.
///
/// # Errors
/// Those of [`Pass::new`].
pub fn serves(run: &LaneRun<'_>) -> Result<bool, RunError> {
    Pass::columns(run.scenario, run.place, run.record)?;
    let mut search = Search { run, is_found: false };
    visit(&mut search);
    Ok(search.is_found || engine::serves(run)?)
}

/// A search for the plant with lanes that serve a run.
struct Search<'a> {
    run: &'a LaneRun<'a>,
    is_found: bool,
}

impl Visitor for Search<'_> {
    fn visit<P: Plant<N>, const N: usize, const E: usize>(&mut self) {
        self.is_found |= prepare::<P, N>(self.run).is_some();
    }
}

/// The outcomes of some runs, in their order, with the best instructions that this processor has. Runs that differ in
/// numbers only, over one record or over records of the same length and dt, run side by side. Each has the bits of
/// [`Outcome::of`], or those of the engine, which differ by rounding; either way they do not depend on the other runs.
///
/// # Errors
/// Those of [`Pass::new`], for the first run that has one.
pub fn outcomes(runs: &[LaneRun<'_>]) -> Result<Vec<Outcome>, RunError> {
    outcomes_with(Level::best(), runs, &[])
}

/// [`outcomes`] with these instructions, or the best ones below them that the processor has, and with looks at the filters at
/// these samples, which are in order, as those of [`Outcome::at`].
///
/// # Errors
/// Those of [`outcomes`].
pub fn outcomes_with(level: Level, runs: &[LaneRun<'_>], samples: &[usize]) -> Result<Vec<Outcome>, RunError> {
    let mut all = All { level, runs, samples, results: vec![None; runs.len()] };
    visit(&mut all);
    engine::run(level, runs, samples, &mut all.results)?;
    let single = |(result, run): (Option<Outcome>, &LaneRun<'_>)| match result {
        Some(outcome) => Ok(outcome),
        None => Outcome::at(run.scenario, run.place, run.record, samples),
    };
    all.results.into_iter().zip(runs).map(single).collect()
}

/// All runs, and the outcomes of those that lanes have run.
struct All<'a> {
    level: Level,
    runs: &'a [LaneRun<'a>],
    samples: &'a [usize],
    results: Vec<Option<Outcome>>,
}

impl Visitor for All<'_> {
    fn visit<P: Plant<N>, const N: usize, const E: usize>(&mut self) {
        let filters: Vec<_> = self.runs.iter().map(prepare::<P, N>).collect();
        for group in groups(&filters, self.runs) {
            for places in group.chunks(LANES) {
                self.run_batch::<P, N, E>(places, &filters);
            }
        }
    }
}

/// The filter of a run, if lanes serve it with this plant. A filter that cannot begin is left to the single filter,
/// which reports the error.
fn prepare<P: Plant<N>, const N: usize>(run: &LaneRun<'_>) -> Option<OscillatorFilter<P, N>> {
    let LaneRun { scenario, place, record } = *run;
    OscillatorFilter::new(scenario, place, record).ok().flatten().filter(|filter| {
        let outputs = || filter.outputs.iter().flatten();
        let is_known = |output: &Output| matches!(output, Output::State(0 | 1) | Output::Rate(1));
        let is_truth_whole =
            knows_truth(record, &P::CHANNELS) || P::CHANNELS.iter().all(|&channel| record.truth(channel).is_none());
        outputs().all(is_known)
            && outputs().count() <= MOST
            && record.forgotten() == 0
            && !record.is_empty()
            && is_truth_whole
            && !has_certain_component(filter)
    })
}

/// Whether a component of a UKF has variance and process noise zero: lanes would have to repair every step.
fn has_certain_component<P, const N: usize>(filter: &OscillatorFilter<P, N>) -> bool {
    let OscillatorFilter { method, initial, noise, .. } = filter;
    let is_certain = |i: usize| initial.cov[(i, i)] == 0.0 && noise.process[(i, i)] == 0.0;
    *method == Method::SigmaPoints && (2..N).any(is_certain)
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

/// The places of runs that can go side by side; those over one record come together.
fn groups<P: Plant<N>, const N: usize>(
    filters: &[Option<OscillatorFilter<P, N>>],
    runs: &[LaneRun<'_>],
) -> Vec<Vec<usize>> {
    let mut groups: Vec<(Kind<'_>, Vec<usize>)> = Vec::new();
    for (place, (filter, run)) in filters.iter().zip(runs).enumerate() {
        let Some(OscillatorFilter { method, plant, dt, outputs, .. }) = filter else { continue };
        let kind = Kind {
            method: *method,
            decays: plant.eta() != 0.0,
            dt: *dt,
            samples: run.record.len(),
            outputs,
            knows_truth: knows_truth(run.record, &P::CHANNELS),
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

impl All<'_> {
    /// Runs as many filters as there are lanes, or fewer; lanes that are left over repeat the last one.
    fn run_batch<P: Plant<N>, const N: usize, const E: usize>(
        &mut self,
        places: &[usize],
        filters: &[Option<OscillatorFilter<P, N>>],
    ) {
        let Self { level, runs, samples, results } = self;
        // A batch costs more than one filter alone.
        let [_, _, ..] = places else { return };
        let of = |place: usize| Some(Run { filter: filters[place].as_ref()?, record: runs[place].record });
        let all: Option<Vec<Run<'_, P, N>>> = places.iter().map(|&place| of(place)).collect();
        let Some(mut all) = all else { return };
        let Some(&last) = all.last() else { return };
        all.resize(LANES, last);
        let Ok(batch) = <[Run<'_, P, N>; LANES]>::try_from(all) else { return };
        let is_same = |run: &Run<'_, P, N>| {
            std::ptr::eq(run.record, last.record)
                && (&run.filter.columns, run.filter.input_delay) == (&last.filter.columns, last.filter.input_delay)
        };
        let distinct = if batch.iter().all(is_same) { 1 } else { LANES };
        let forces: Vec<Vec<f64>> = batch[..distinct].iter().map(|run| run.forces()).collect();
        let outcomes = level.run::<P, N, E>(&batch, &Observations::new(&batch, &forces), samples);
        for (&place, outcome) in places.iter().zip(outcomes) {
            results[place] = outcome;
        }
    }
}
