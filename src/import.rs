//! The import of a measured record: reading the file, asking what its columns mean, making start values.

mod columns;
mod dialog;
mod draft;
mod summary;

use std::borrow::Borrow;
use std::rc::Rc;
use std::sync::Arc;

use egui::Context;
use kalmanscope_core::import::{Loaded, Mapping, Table, load};
use kalmanscope_core::suggest::{self, Suggestion};
use kalmanscope_core::{Hold, InputKind, Scenario, Task, Work};

use crate::session::RecordFile;
use crate::team::{BETWEEN, Handle, Lost, Priority, Report, RunningTask, Team};

pub use draft::Draft;

/// Limits the size of a record's file \[bytes\].
pub const LARGEST: usize = 500_000_000;

/// Limits the size of a file that is read in the frames, a few of them \[bytes\].
const LONG_FILE: usize = 4_000_000;

/// Limits the length of a record with start values that are made in the frames \[samples\].
const LONG_RECORD: usize = 50_000;

pub struct Import {
    name: String,
    stage: ImportStage,
    team: Rc<dyn Team>,
    at_once: bool,
    pub(crate) is_still: bool,
}

enum ImportStage {
    Reading(Box<RunningTask<Work<Result<Loaded, String>>>>),
    Asking(Box<Draft>),
    Suggesting(Box<Draft>, Box<RunningTask<Work<Suggestion>>>),
    Failed(String),
}

pub struct Opened {
    pub file: Arc<RecordFile>,
    pub scenario: Scenario,
    pub reasons: Vec<String>,
    pub problem: Option<String>,
    pub summary: Option<String>,
}

impl Import {
    pub fn new(name: &str, bytes: Vec<u8>, at_once: bool, team: Rc<dyn Team>) -> Self {
        let is_long = bytes.len() > LONG_FILE;
        let worker = if is_long { team.load(&bytes) } else { None };
        let load = load(bytes).map(|loaded| loaded.map_err(|error| error.to_string()));
        let stage = ImportStage::Reading(Box::new(running(&*team, worker, load, is_long)));
        Self { at_once, ..Self::at(name.to_owned(), stage, team) }
    }

    pub fn again(file: &Arc<RecordFile>, scenario: &Scenario, team: Rc<dyn Team>) -> Self {
        let draft = Draft::of_scenario(Arc::clone(file), scenario);
        Self::at(file.name.clone(), ImportStage::Asking(Box::new(draft)), team)
    }

    fn at(name: String, stage: ImportStage, team: Rc<dyn Team>) -> Self {
        Self { name, stage, team, at_once: false, is_still: false }
    }

    pub fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> Option<Opened> {
        // A stage owns its work, which the next stage takes over: so it is moved out and put back.
        let stage = std::mem::replace(&mut self.stage, ImportStage::Failed(String::new()));
        self.stage = match stage {
            ImportStage::Reading(mut reading) => match reading.advance(while_time) {
                Ok(None) => ImportStage::Reading(reading),
                Ok(Some(Ok(Loaded { hash, table }))) => {
                    let file = RecordFile { name: self.name.clone(), hash, table };
                    ImportStage::Asking(Box::new(Draft::new(Arc::new(file))))
                }
                Ok(Some(Err(reason))) => ImportStage::Failed(reason),
                Err(Lost) => ImportStage::Failed("the thread that read it has failed".to_owned()),
            },
            ImportStage::Suggesting(draft, mut suggest) => match suggest.advance(while_time) {
                Ok(None) => ImportStage::Suggesting(draft, suggest),
                Ok(Some(suggestion)) => match suggestion.scenario.validate() {
                    Ok(()) => {
                        let Suggestion { scenario, reasons, problem, .. } = suggestion;
                        let summary = self.at_once.then(|| draft.summary());
                        return Some(Opened { file: Arc::clone(&draft.file), scenario, reasons, problem, summary });
                    }
                    Err(error) => ImportStage::Failed(format!("no start values can be made of it: {error}")),
                },
                Err(Lost) => ImportStage::Failed("the thread that made start values of it has failed".to_owned()),
            },
            ImportStage::Asking(mut draft) => {
                draft.advance(while_time);
                self.at_once &= !draft.is_unfolded && (draft.is_behind() || draft.is_possible());
                ImportStage::Asking(draft)
            }
            ImportStage::Failed(reason) => ImportStage::Failed(reason),
        };
        if self.at_once { self.open() } else { None }
    }

    pub(crate) fn progress(&self) -> Option<f64> {
        match &self.stage {
            ImportStage::Reading(reading) => Some(reading.seen),
            ImportStage::Suggesting(_, suggest) => Some(suggest.seen),
            ImportStage::Asking(_) | ImportStage::Failed(_) => None,
        }
    }

    pub(crate) fn ask_for_frame(&self, ctx: &Context) {
        let (is_busy, is_beside) = match &self.stage {
            ImportStage::Reading(reading) => (true, reading.is_beside()),
            ImportStage::Suggesting(_, suggest) => (true, suggest.is_beside()),
            ImportStage::Asking(draft) => (draft.is_behind(), false),
            ImportStage::Failed(_) => (false, false),
        };
        if is_beside {
            ctx.request_repaint_after(BETWEEN);
        } else if is_busy {
            ctx.request_repaint();
        }
    }

    pub fn file(&self) -> Option<&Arc<RecordFile>> {
        match &self.stage {
            ImportStage::Asking(draft) | ImportStage::Suggesting(draft, _) => Some(&draft.file),
            _ => None,
        }
    }

    fn open(&mut self) -> Option<Opened> {
        let ImportStage::Asking(draft) = &self.stage else { return None };
        let (scenario, made) = (draft.scenario()?, draft.outcome()?.ok()?);
        if !draft.is_possible() {
            return None;
        }
        let record = made.record.clone();
        let ImportStage::Asking(draft) = std::mem::replace(&mut self.stage, ImportStage::Failed(String::new())) else {
            return None;
        };
        if draft.suggest {
            let is_long = record.len() > LONG_RECORD;
            let worker = if is_long { self.team.suggest(&scenario, &record) } else { None };
            let suggest = running(&*self.team, worker, suggest::begin(&scenario, record), is_long);
            self.stage = ImportStage::Suggesting(draft, Box::new(suggest));
            return None;
        }
        Some(Opened { file: Arc::clone(&draft.file), scenario, reasons: Vec::new(), problem: None, summary: None })
    }
}

fn running<T: Task<Outcome: Send> + Send + 'static>(
    team: &dyn Team,
    worker: Option<Handle<Report<f64, T::Outcome>>>,
    task: T,
    is_long: bool,
) -> RunningTask<T> {
    match worker {
        Some(worker) => RunningTask::in_worker(worker, task, T::progress),
        None if is_long => RunningTask::begin(team, Priority::Hand, task, T::progress),
        None => RunningTask::here(task, T::progress),
    }
}

type ImportSettings = (Mapping, InputKind, Hold);

#[derive(Clone, Debug)]
struct SharedFile(Arc<RecordFile>);

impl Borrow<Table> for SharedFile {
    fn borrow(&self) -> &Table {
        &self.0.table
    }
}
