//! Runs in batches of those that are alike.

use kalmanscope_core::internals::engine::{Design, Setup};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Channel, Record, Scenario};

use crate::adapter::{Gpu, LARGEST_BUFFER};
use crate::layout::{Cell, LARGEST, Settings, State, Tape, known};
use crate::outcome::{Ran, outcome};
use crate::program::{GpuError, Job};
use crate::shader::Program;

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

/// Whether a run goes to the graphics processor: a KF, EKF, UKF or CKF of up to 9 components, of any plant that the
/// program has or that is an equation, with all settings that the engine serves ([`Setup::of_any`]), sensors with
/// noise, and numbers that single precision can hold. A record has the truth of the first components of the state, or
/// of none.
pub fn serves(run: &GpuRun<'_>) -> bool {
    program(run).is_some()
}

/// The program of a run in WGSL. `None` if the graphics processor does not serve the run.
pub fn program(run: &GpuRun<'_>) -> Option<String> {
    let (setup, known) = prepare(run)?;
    Program::new(&setup.design, &setup.channels, known).map(|program| program.text)
}

/// The filter of a run and the number of its channels with a known truth, if single precision can hold its numbers.
fn prepare(run: &GpuRun<'_>) -> Option<(Setup, usize)> {
    let GpuRun { scenario, place, record } = *run;
    let setup = Setup::of_any(scenario, place, record).ok()??;
    let known = known(&setup.channels, record)?;
    let is_fine = |variance: &f64| *variance == 0.0 || (SMALLEST..=LARGEST * LARGEST).contains(variance);
    let variances = || setup.variance.iter().chain(&setup.process).chain(&setup.sensors).chain([&setup.white]);
    let numbers_are_fine = setup.mean.iter().all(|mean| mean.abs() <= LARGEST)
        && variances().all(is_fine)
        && setup.sensors.iter().all(|&variance| variance > 0.0);
    (numbers_are_fine && (1..=MOST_SAMPLES).contains(&record.len())).then_some((setup, known))
}

#[derive(PartialEq)]
struct Kind {
    design: Design,
    channels: Vec<Channel>,
    known: usize,
    samples: usize,
}

struct Member<'a> {
    place: usize,
    setup: Setup,
    record: &'a Record,
    tape: usize,
}

/// The runs of one kind, as many as go at once; no run if they have no program.
struct Batch<'a> {
    kind: Kind,
    program: Option<Program>,
    members: Vec<Member<'a>>,
    tapes: Vec<Tape>,
}

impl Gpu {
    /// The outcomes of some runs, in their order; `None` for a run that is not served. It calls `is_wanted` now and
    /// then.
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
        for Batch { kind, program, members, tapes } in &batches(runs) {
            let Some(program) = program else { continue };
            let settings = Settings {
                begin: 0,
                end: kind.samples as u32,
                runs: members.len() as u32,
                recent: (kind.samples * 4 / 5) as u32,
                dt: kind.design.dt,
            };
            let mut cells = Vec::new();
            members.iter().for_each(|member| cell(member, kind.samples).put(&mut cells));
            let samples = tapes.iter().flat_map(|tape| &tape.words).copied().collect();
            let job = Job { program, settings, samples, cells };
            let states = self.programs.run(&job, &self.trouble, is_wanted).await?;
            let of = |(member, state): &(&Member<'_>, &State)| {
                let ran = Ran { setup: &member.setup, record: member.record, tape: &tapes[member.tape] };
                outcome(&ran, state)
            };
            let done: Vec<(&Member<'_>, &State)> = members.iter().zip(&states).collect();
            let of_batch = in_parts(&done, |done| done.iter().map(of).collect());
            for (member, outcome) in members.iter().zip(of_batch) {
                outcomes[member.place] = Some(outcome);
            }
        }
        Ok(outcomes)
    }
}

impl Batch<'_> {
    fn has_room(&self) -> bool {
        let words = (LARGEST_BUFFER / 4) as usize;
        self.program.as_ref().is_none_or(|Program { shape, .. }| {
            let most_runs = MOST_RUNS.min(words / shape.state());
            let most_samples = MOST_SAMPLES.min(words / shape.sample());
            self.members.len() < most_runs
                && (self.tapes.is_empty() || (self.tapes.len() + 1) * self.kind.samples <= most_samples)
        })
    }
}

fn batches<'a>(runs: &[GpuRun<'a>]) -> Vec<Batch<'a>> {
    let mut batches: Vec<Batch<'a>> = Vec::new();
    let prepared = in_parts(runs, |runs| runs.iter().map(prepare).collect());
    for ((place, run), prepared) in runs.iter().enumerate().zip(prepared) {
        let Some((setup, known)) = prepared else { continue };
        let samples = run.record.len();
        let is_its = |batch: &&mut Batch<'_>| {
            let Kind { design, channels, known: others, samples: length } = &batch.kind;
            (design, channels, *others, *length) == (&setup.design, &setup.channels, known, samples) && batch.has_room()
        };
        let batch = match batches.iter_mut().rev().find(is_its) {
            Some(batch) => batch,
            None => {
                let program = Program::new(&setup.design, &setup.channels, known);
                let (design, channels) = (setup.design.clone(), setup.channels.clone());
                let kind = Kind { design, channels, known, samples };
                batches.push(Batch { kind, program, members: Vec::new(), tapes: Vec::new() });
                let Some(batch) = batches.last_mut() else { continue };
                batch
            }
        };
        if batch.program.is_none() {
            continue;
        }
        let same = |member: &&Member<'_>| {
            let (other, own) = (&member.setup, &setup);
            std::ptr::eq(member.record, run.record) && (&other.columns, &other.delays) == (&own.columns, &own.delays)
        };
        let tape = match batch.members.iter().rev().find(same) {
            Some(member) => member.tape,
            None => {
                let Some(tape) = Tape::new(&setup, run.record, known) else { continue };
                batch.tapes.push(tape);
                batch.tapes.len() - 1
            }
        };
        batch.members.push(Member { place, setup, record: run.record, tape });
    }
    batches.retain(|batch| !batch.members.is_empty());
    batches
}

fn cell<'a>(member: &'a Member<'_>, samples: usize) -> Cell<'a> {
    let Setup { mean, variance, process, sensors, fading, white, .. } = &member.setup;
    let first = (member.tape * samples) as u32;
    Cell { mean, variance, process, sensors, fading: *fading, white: *white, first }
}

/// The least that is worth a thread.
#[cfg(not(target_arch = "wasm32"))]
const LEAST: usize = 256;

/// Does some work on all items and returns its results in their order. Each core takes a part of the items.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn in_parts<T: Sync, R: Send>(items: &[T], work: impl Fn(&[T]) -> Vec<R> + Sync) -> Vec<R> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let part = items.len().div_ceil(cores).max(LEAST);
    if items.len() <= part {
        return work(items);
    }
    let work = &work;
    std::thread::scope(|scope| {
        let threads: Vec<_> = items.chunks(part).map(|items| scope.spawn(move || work(items))).collect();
        let join = |thread: std::thread::ScopedJoinHandle<'_, Vec<R>>| {
            thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        };
        threads.into_iter().flat_map(join).collect()
    })
}

/// A worker of a page has one thread.
#[cfg(target_arch = "wasm32")]
pub(crate) fn in_parts<T, R>(items: &[T], work: impl Fn(&[T]) -> Vec<R>) -> Vec<R> {
    work(items)
}
