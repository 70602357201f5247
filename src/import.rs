//! The import of a measured record: reading the file, asking what its columns mean, making start values.

mod columns;
mod dialog;
mod draft;
mod summary;

use std::borrow::Borrow;
use std::rc::Rc;
use std::sync::Arc;

use egui::Context;
use kalmanscope_core::import::{Loaded, Loading, Mapping, Table};
use kalmanscope_core::suggest::{Suggest, Suggestion};
use kalmanscope_core::{Hold, InputKind, Scenario, Task};

use crate::session::RecordFile;
use crate::team::{BETWEEN, Handle, Lost, Priority, Report, Running, Team};

pub use draft::Draft;

/// Limits the size of a record's file \[bytes\].
pub const LARGEST: usize = 500_000_000;

/// Limits the size of a file that is read in the frames, a few of them \[bytes\].
const LONG_FILE: usize = 4_000_000;

/// Limits the length of a record with start values that are made in the frames \[samples\].
const LONG_RECORD: usize = 50_000;

pub struct Import {
    name: String,
    stage: Stage,
    team: Rc<dyn Team>,
    at_once: bool,
    pub(crate) is_still: bool,
}

enum Stage {
    Reading(Box<Running<Reading>>),
    Asking(Box<Draft>),
    Suggesting(Box<Draft>, Box<Running<Suggest>>),
    Failed(String),
}

struct Reading(Loading);

impl Task for Reading {
    type Outcome = Result<Loaded, String>;

    fn progress(&self) -> f64 {
        self.0.progress()
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        self.0.advance(while_time)
    }

    fn finish(self) -> Self::Outcome {
        self.0.finish().map_err(|error| error.to_string())
    }
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
        let stage = Stage::Reading(Box::new(running(&*team, worker, Reading(Loading::new(bytes)), is_long)));
        Self { at_once, ..Self::at(name.to_owned(), stage, team) }
    }

    pub fn again(file: &Arc<RecordFile>, scenario: &Scenario, team: Rc<dyn Team>) -> Self {
        let draft = Draft::of_scenario(Arc::clone(file), scenario);
        Self::at(file.name.clone(), Stage::Asking(Box::new(draft)), team)
    }

    fn at(name: String, stage: Stage, team: Rc<dyn Team>) -> Self {
        Self { name, stage, team, at_once: false, is_still: false }
    }

    pub fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> Option<Opened> {
        let stage = std::mem::replace(&mut self.stage, Stage::Failed(String::new()));
        self.stage = match stage {
            Stage::Reading(mut reading) => match reading.advance(while_time) {
                Ok(None) => Stage::Reading(reading),
                Ok(Some(Ok(Loaded { hash, table }))) => {
                    let file = RecordFile { name: self.name.clone(), hash, table };
                    Stage::Asking(Box::new(Draft::new(Arc::new(file))))
                }
                Ok(Some(Err(reason))) => Stage::Failed(reason),
                Err(Lost) => Stage::Failed("the thread that read it has failed".to_owned()),
            },
            Stage::Suggesting(draft, mut suggest) => match suggest.advance(while_time) {
                Ok(None) => Stage::Suggesting(draft, suggest),
                Ok(Some(suggestion)) => match suggestion.scenario.validate() {
                    Ok(()) => {
                        let Suggestion { scenario, reasons, problem, .. } = suggestion;
                        let summary = self.at_once.then(|| draft.summary());
                        return Some(Opened { file: Arc::clone(&draft.file), scenario, reasons, problem, summary });
                    }
                    Err(error) => Stage::Failed(format!("no start values can be made of it: {error}")),
                },
                Err(Lost) => Stage::Failed("the thread that made start values of it has failed".to_owned()),
            },
            Stage::Asking(mut draft) => {
                draft.advance(while_time);
                self.at_once &= !draft.is_unfolded && (draft.is_behind() || draft.is_possible());
                Stage::Asking(draft)
            }
            Stage::Failed(reason) => Stage::Failed(reason),
        };
        if self.at_once { self.open() } else { None }
    }

    pub(crate) fn progress(&self) -> Option<f64> {
        match &self.stage {
            Stage::Reading(reading) => Some(reading.seen),
            Stage::Suggesting(_, suggest) => Some(suggest.seen),
            Stage::Asking(_) | Stage::Failed(_) => None,
        }
    }

    pub(crate) fn ask_for_frame(&self, ctx: &Context) {
        let (is_busy, is_beside) = match &self.stage {
            Stage::Reading(reading) => (true, reading.is_beside()),
            Stage::Suggesting(_, suggest) => (true, suggest.is_beside()),
            Stage::Asking(draft) => (draft.is_behind(), false),
            Stage::Failed(_) => (false, false),
        };
        if is_beside {
            ctx.request_repaint_after(BETWEEN);
        } else if is_busy {
            ctx.request_repaint();
        }
    }

    pub fn file(&self) -> Option<&Arc<RecordFile>> {
        match &self.stage {
            Stage::Asking(draft) | Stage::Suggesting(draft, _) => Some(&draft.file),
            _ => None,
        }
    }

    fn open(&mut self) -> Option<Opened> {
        let Stage::Asking(draft) = &self.stage else { return None };
        let (scenario, made) = (draft.scenario()?, draft.outcome()?.ok()?);
        if !draft.is_possible() {
            return None;
        }
        let record = made.record.clone();
        let Stage::Asking(draft) = std::mem::replace(&mut self.stage, Stage::Failed(String::new())) else {
            return None;
        };
        if draft.suggest {
            let is_long = record.len() > LONG_RECORD;
            let worker = if is_long { self.team.suggest(&scenario, &record) } else { None };
            let suggest = running(&*self.team, worker, Suggest::new(&scenario, record), is_long);
            self.stage = Stage::Suggesting(draft, Box::new(suggest));
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
) -> Running<T> {
    match worker {
        Some(worker) => Running::in_worker(worker, task, T::progress),
        None if is_long => Running::begin(team, Priority::Hand, task, T::progress),
        None => Running::here(task, T::progress),
    }
}

type Choices = (Mapping, InputKind, Hold);

#[derive(Clone, Debug)]
struct SharedFile(Arc<RecordFile>);

impl Borrow<Table> for SharedFile {
    fn borrow(&self) -> &Table {
        &self.0.table
    }
}
