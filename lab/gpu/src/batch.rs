//! Runs in batches of those that are alike, and the rows of an ensemble's cells.

use kalmanscope_core::internals::engine::{Design, Setup};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::setting::Address;
use kalmanscope_core::{Channel, Record};
use kalmanscope_lab::{CellRun, Runner};
use kalmanscope_lanes::LaneRun;

use crate::adapter::{Gpu, GpuError, LARGEST_BUFFER};
use crate::layout::{LARGEST, RecordTape, known, outcome, put_cell};
use crate::program::GpuJob;
use crate::shader::ShaderProgram;

const MOST_RUNS: usize = 1 << 16;
const MOST_SAMPLES: usize = 2_000_000;

/// Single precision ends at 1e-38: smaller variances other than zero have no room for products.
const SMALLEST: f64 = 1e-30;

/// Whether a run goes to the graphics processor: a KF, EKF, UKF or CKF of up to 9 components, of any plant that is a list of operations,
/// with all settings of the engine ([`Setup::of_any`]), sensors with noise, and numbers that single precision can hold. A record has
/// one input, and the truth of the first components of the state, or of none.
pub fn serves(run: &LaneRun<'_>) -> bool {
    program(run).is_some()
}

/// The program of a run in WGSL. `None` if the graphics processor does not serve the run.
pub fn program(run: &LaneRun<'_>) -> Option<String> {
    let (setup, known) = prepare(run)?;
    ShaderProgram::new(&setup.design, &setup.channels, known).map(|program| program.text)
}

/// `None` if single precision cannot hold the numbers.
fn prepare(run: &LaneRun<'_>) -> Option<(Setup, usize)> {
    let LaneRun { scenario, place, record } = *run;
    let setup = Setup::of_any(scenario, place, record).ok()??;
    let known = known(&setup.channels, record)?;
    let is_fine = |variance: &f64| *variance == 0.0 || (SMALLEST..=LARGEST * LARGEST).contains(variance);
    let variances = || setup.variance.iter().chain(&setup.process).chain(&setup.sensors).chain([&setup.white]);
    let numbers_are_fine = record.forced().is_empty()
        && setup.mean.iter().all(|mean| mean.abs() <= LARGEST)
        && variances().all(is_fine)
        && setup.sensors.iter().all(|&variance| variance > 0.0);
    (numbers_are_fine && (1..=MOST_SAMPLES).contains(&record.len())).then_some((setup, known))
}

struct BatchMember<'a> {
    place: usize,
    setup: Setup,
    record: &'a Record,
    tape: usize,
}

struct Batch<'a> {
    design: Design,
    channels: Vec<Channel>,
    known: usize,
    samples: usize,
    program: Option<ShaderProgram>,
    members: Vec<BatchMember<'a>>,
    tapes: Vec<RecordTape>,
}

impl Gpu {
    /// Whether the graphics processor is of use: it serves all filters of the first cell, and scores need no more than sums.
    pub fn serves(runner: &Runner) -> bool {
        let ensemble = runner.ensemble();
        // Runs that differ by their filters share a record. Otherwise simulation takes most of the time.
        let has_axis_of_filters = ensemble.settings().iter().any(Address::is_of_filters);
        if runner.needs_history() || ensemble.plan().times > 0 || !has_axis_of_filters {
            return false;
        }
        let Some(CellRun { scenario, record }) = runner.runs(&[0]).into_iter().next().flatten() else { return false };
        let serves = |&place: &usize| serves(&LaneRun { scenario: &scenario, place, record: &record });
        ensemble.plan().filters.iter().all(serves)
    }

    /// Runs some cells. Returns the cells whose filters all run on the graphics processor, and their rows in the form of [`Runner::rows`].
    ///
    /// # Errors
    /// Those of [`Self::outcomes`].
    pub async fn rows(
        &self,
        runner: &Runner,
        cells: &[usize],
        is_wanted: &dyn Fn() -> bool,
    ) -> Result<(Vec<usize>, Vec<f64>), GpuError> {
        let runs = in_parts(cells, |cells| runner.runs(cells));
        let mut outcomes: Vec<Vec<Option<Outcome>>> = vec![Vec::new(); cells.len()];
        for &place in &runner.ensemble().plan().filters {
            let possible: Vec<LaneRun<'_>> =
                runs.iter().flatten().map(|CellRun { scenario, record }| LaneRun { scenario, place, record }).collect();
            let mut of_filter = self.outcomes(&possible, is_wanted).await?.into_iter();
            for (outcomes, _) in outcomes.iter_mut().zip(&runs).filter(|(_, run)| run.is_some()) {
                outcomes.push(of_filter.next().flatten());
            }
        }
        let row = |&((&cell, run), outcomes): &((&usize, &Option<CellRun>), &Vec<Option<Outcome>>)| {
            let all: Option<Vec<&Outcome>> = outcomes.iter().map(Option::as_ref).collect();
            all.map(|outcomes| (cell, runner.row_of_sums(run.as_ref(), &outcomes)))
        };
        let done: Vec<_> = cells.iter().zip(&runs).zip(&outcomes).collect();
        let rows_of_cells = in_parts(&done, |done| done.iter().filter_map(row).collect());
        let (served, rows): (Vec<usize>, Vec<Vec<f64>>) = rows_of_cells.into_iter().unzip();
        Ok((served, rows.concat()))
    }

    /// The outcomes of some runs, in their order; `None` for a run that is not served. It calls `is_wanted` at times.
    ///
    /// # Errors
    /// [`GpuError::Failed`] where the graphics processor fails or is lost, [`GpuError::Unwanted`] where no result is wanted.
    pub async fn outcomes(
        &self,
        runs: &[LaneRun<'_>],
        is_wanted: &dyn Fn() -> bool,
    ) -> Result<Vec<Option<Outcome>>, GpuError> {
        let mut outcomes = vec![None; runs.len()];
        for Batch { design, samples: length, program, members, tapes, .. } in &batches(runs) {
            let Some(program) = program else { continue };
            let mut cells = Vec::new();
            for member in members {
                put_cell(&mut cells, &member.setup, (member.tape * length) as u32);
            }
            let samples = tapes.iter().flat_map(|tape| &tape.words).copied().collect();
            let (runs, length, dt) = (members.len() as u32, *length as u32, design.dt);
            let job = GpuJob { program, runs, length, dt, samples, cells };
            let states = self.run(&job, is_wanted).await?;
            let of = |(member, state): &(&BatchMember<'_>, &[u32])| {
                outcome(&member.setup, member.record, &tapes[member.tape], program.shape, state)
            };
            let done: Vec<_> = members.iter().zip(states.chunks_exact(program.shape.state())).collect();
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
        self.program.as_ref().is_none_or(|ShaderProgram { shape, .. }| {
            let most_runs = MOST_RUNS.min(words / shape.state());
            let most_samples = MOST_SAMPLES.min(words / shape.sample());
            self.members.len() < most_runs
                && (self.tapes.is_empty() || (self.tapes.len() + 1) * self.samples <= most_samples)
        })
    }
}

fn batches<'a>(runs: &[LaneRun<'a>]) -> Vec<Batch<'a>> {
    let mut batches: Vec<Batch<'a>> = Vec::new();
    let prepared = in_parts(runs, |runs| runs.iter().map(prepare).collect());
    for ((place, run), prepared) in runs.iter().enumerate().zip(prepared) {
        let Some((setup, known)) = prepared else { continue };
        let samples = run.record.len();
        let is_its = |batch: &Batch<'_>| {
            let Batch { design, channels, known: others, samples: length, .. } = batch;
            (design, channels, *others, *length) == (&setup.design, &setup.channels, known, samples) && batch.has_room()
        };
        let at = batches.iter().rposition(is_its).unwrap_or(batches.len());
        if at == batches.len() {
            let program = ShaderProgram::new(&setup.design, &setup.channels, known);
            let (design, channels) = (setup.design.clone(), setup.channels.clone());
            batches.push(Batch { design, channels, known, samples, program, members: Vec::new(), tapes: Vec::new() });
        }
        let batch = &mut batches[at];
        if batch.program.is_none() {
            continue;
        }
        let same = |member: &&BatchMember<'_>| {
            let (other, own) = (&member.setup, &setup);
            std::ptr::eq(member.record, run.record) && (&other.columns, &other.delays) == (&own.columns, &own.delays)
        };
        let tape = match batch.members.iter().rev().find(same) {
            Some(member) => member.tape,
            None => {
                let Some(tape) = RecordTape::new(&setup, run.record, known) else { continue };
                batch.tapes.push(tape);
                batch.tapes.len() - 1
            }
        };
        batch.members.push(BatchMember { place, setup, record: run.record, tape });
    }
    batches.retain(|batch| !batch.members.is_empty());
    batches
}

fn in_parts<T: Sync, R: Send>(items: &[T], work: impl Fn(&[T]) -> Vec<R> + Sync) -> Vec<R> {
    const LEAST: usize = 256;
    kalmanscope_lab::in_parts(items, kalmanscope_lab::processors(), LEAST, work)
}
