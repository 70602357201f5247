//! Runs in batches of those that are alike.

use kalmanscope_core::kernel::abreast::{Method, OscillatorFilter};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Record, Scenario};

use crate::adapter::Gpu;
use crate::error::GpuError;
use crate::layout::{Cell, Sample, Settings};
use crate::outcome::{Ran, outcome};
use crate::program::Job;
use crate::tape::{CHANNELS, LARGEST, Tape, knows_truth, place_of};

/// Limits the runs of a batch, and the samples of its records.
const MOST_RUNS: usize = 1 << 16;
const MOST_SAMPLES: usize = 2_000_000;

/// Limits the smallest variance other than zero.
const SMALLEST: f64 = 1e-30;

/// One filter of a scenario, to be run over a record.
#[derive(Clone, Copy, Debug)]
pub struct GpuRun<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The place of the filter in it.
    pub place: usize,
    /// The record.
    pub record: &'a Record,
}

/// Whether a run goes to the graphics processor: a KF, EKF or UKF of the linear oscillator with at most one sensor each of
/// displacement, velocity and acceleration, with or without fading and a delay of the input, under an input that is held,
/// with parameters that do not decay, sensors with noise, and numbers that single precision can hold.
pub fn serves(run: &GpuRun<'_>) -> bool {
    prepare(run).is_some()
}

/// The filter of a run, if it goes to the graphics processor.
fn prepare(run: &GpuRun<'_>) -> Option<OscillatorFilter> {
    let GpuRun { scenario, place, record } = *run;
    let filter = <OscillatorFilter>::new(scenario, place, record).ok()??;
    let outputs: Vec<_> = filter.outputs.iter().flatten().map(|&output| place_of(output)).collect();
    let each_once = outputs.iter().enumerate().all(|(at, output)| output.is_some() && !outputs[..at].contains(output));
    let is_truth_whole = knows_truth(record) || CHANNELS.iter().all(|&channel| record.truth(channel).is_none());
    let is_fine = |variance: f64| variance == 0.0 || (SMALLEST..=LARGEST * LARGEST).contains(&variance);
    let noise = &filter.noise;
    let numbers_are_fine = filter.initial.mean.iter().all(|mean| mean.abs() <= LARGEST)
        && (0..4).all(|i| is_fine(filter.initial.cov[(i, i)]) && is_fine(noise.process[(i, i)]))
        && noise.sensors.iter().take(filter.outputs.len()).all(|&variance| variance > 0.0 && is_fine(variance));
    let is_usual = each_once
        && filter.plant.eta == 0.0
        && is_truth_whole
        && numbers_are_fine
        && record.forgotten() == 0
        && (1..=MOST_SAMPLES).contains(&record.len());
    is_usual.then_some(filter)
}

/// The properties that all runs of a batch must share.
#[derive(PartialEq)]
struct Kind {
    method: Method,
    dt: f64,
    samples: usize,
    knows_truth: bool,
}

/// A run that goes to the graphics processor, by its place among all.
struct Member<'a> {
    place: usize,
    filter: OscillatorFilter,
    record: &'a Record,
    /// The place of its tape.
    tape: usize,
}

/// The runs of one kind, as many as go at once.
struct Batch<'a> {
    kind: Kind,
    members: Vec<Member<'a>>,
    tapes: Vec<Tape>,
}

impl Gpu {
    /// The outcomes of some runs, in their order; none of a run that is not served. `is_wanted` is asked now and then.
    ///
    /// # Errors
    /// [`GpuError::Failed`] where the graphics processor fails or is lost, [`GpuError::Unwanted`] where the results are not
    /// wanted any more.
    pub async fn outcomes(
        &self,
        runs: &[GpuRun<'_>],
        is_wanted: &dyn Fn() -> bool,
    ) -> Result<Vec<Option<Outcome>>, GpuError> {
        let mut outcomes = vec![None; runs.len()];
        for batch in batches(runs) {
            let Batch { kind: Kind { method, dt, samples, knows_truth }, members, tapes } = &batch;
            let settings = Settings {
                begin: 0,
                end: *samples as u32,
                runs: members.len() as u32,
                recent: (samples * 4 / 5) as u32,
                knows_truth: *knows_truth,
                dt: *dt,
            };
            let job = Job {
                method: *method,
                settings,
                samples: tapes.iter().flat_map(|tape| &tape.words).copied().collect(),
                cells: members.iter().flat_map(|member| cell(member, *samples).words()).collect(),
            };
            let states = self.programs.run(&job, &self.trouble, is_wanted).await?;
            for (member, state) in members.iter().zip(&states) {
                let ran = Ran { filter: &member.filter, record: member.record, tape: &tapes[member.tape] };
                outcomes[member.place] = Some(outcome(&ran, state));
            }
        }
        Ok(outcomes)
    }
}

/// The batches of the runs that are served.
fn batches<'a>(runs: &[GpuRun<'a>]) -> Vec<Batch<'a>> {
    let mut batches: Vec<Batch<'a>> = Vec::new();
    for (place, run) in runs.iter().enumerate() {
        let Some(filter) = prepare(run) else { continue };
        let kind = Kind {
            method: filter.method,
            dt: filter.dt,
            samples: run.record.len(),
            knows_truth: knows_truth(run.record),
        };
        let has_room = |batch: &&mut Batch<'_>| {
            batch.kind == kind
                && batch.members.len() < MOST_RUNS
                && (batch.tapes.len() + 1) * batch.kind.samples <= MOST_SAMPLES
        };
        let batch = match batches.iter_mut().rev().find(has_room) {
            Some(batch) => batch,
            None => {
                batches.push(Batch { kind, members: Vec::new(), tapes: Vec::new() });
                let Some(batch) = batches.last_mut() else { continue };
                batch
            }
        };
        let same = |member: &&Member<'_>| {
            let (other, own) = (&member.filter, &filter);
            std::ptr::eq(member.record, run.record)
                && (&other.columns, &other.outputs, other.input_delay) == (&own.columns, &own.outputs, own.input_delay)
        };
        let tape = match batch.members.iter().rev().find(same) {
            Some(member) => member.tape,
            None => {
                let Some(tape) = Tape::new(&filter, run.record) else { continue };
                batch.tapes.push(tape);
                batch.tapes.len() - 1
            }
        };
        batch.members.push(Member { place, filter, record: run.record, tape });
    }
    batches.retain(|batch| !batch.members.is_empty());
    batches
}

fn cell(member: &Member<'_>, samples: usize) -> Cell {
    let OscillatorFilter { initial, noise, outputs, .. } = &member.filter;
    let mut sensors = [0.0; 3];
    for (place, output) in outputs.iter().enumerate() {
        if let Some(at) = output.and_then(place_of) {
            sensors[at] = noise.sensors[place];
        }
    }
    Cell {
        mean: [0, 1, 2, 3].map(|i| initial.mean[i]),
        initial_std: [0, 1, 2, 3].map(|i| initial.cov[(i, i)].sqrt()),
        process: [0, 1, 2, 3].map(|i| noise.process[(i, i)].sqrt()),
        noise: sensors,
        fading: noise.fading.sqrt(),
        first: (member.tape * samples) as u32,
    }
}

/// The number of words of all tapes fits a buffer.
const _: () = assert!(MOST_SAMPLES * Sample::WORDS * 4 <= 128 << 20);
