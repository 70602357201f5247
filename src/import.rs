//! The import of a measured record: reading the file, asking what its columns mean, making start values.

mod choices;
mod columns;
mod conditioning;
mod dialog;
mod draft;
mod source;
mod spark;
mod spectra;

use std::sync::Arc;

use kalmanscope_core::import::{Hash, Reader};
use kalmanscope_core::suggest::Suggest;
use kalmanscope_core::{Record, Scenario};

use crate::session::RecordFile;

pub use draft::Draft;

/// Limits the size of a record's file \[bytes\].
pub const LARGEST: usize = 500_000_000;

/// An import under way.
pub struct Import {
    name: String,
    stage: Stage,
}

enum Stage {
    /// The bytes are hashed, up to a place.
    Hashing(Vec<u8>, Hash, usize),
    /// The file is read; with it the hash of its bytes.
    Reading(Box<Reader>, String),
    /// Its columns are given a meaning.
    Asking(Box<Draft>),
    /// Start values are made.
    Suggesting(Box<Draft>, Box<Suggest>),
    /// It cannot be read.
    Failed(String),
}

/// The outcome of an import.
pub struct Opened {
    /// The file.
    pub file: Arc<RecordFile>,
    /// A scenario that names it.
    pub scenario: Scenario,
    /// The reasons of its settings.
    pub reasons: Vec<String>,
}

impl Import {
    /// The import of a file's bytes.
    pub fn new(name: &str, bytes: Vec<u8>) -> Self {
        Self { name: name.to_owned(), stage: Stage::Hashing(bytes, Hash::default(), 0) }
    }

    /// The import of a file that has been read, as a scenario uses it now.
    pub fn again(file: &Arc<RecordFile>, scenario: &Scenario) -> Self {
        let draft = Draft::of_scenario(Arc::clone(file), scenario);
        Self { name: file.name.clone(), stage: Stage::Asking(Box::new(draft)) }
    }

    /// Goes on until `while_time` returns false. Returns the outcome once there is one.
    pub fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> Option<Opened> {
        let stage = std::mem::replace(&mut self.stage, Stage::Failed(String::new()));
        self.stage = match stage {
            Stage::Hashing(bytes, hash, done) => hashed(bytes, hash, done, while_time),
            Stage::Reading(mut reader, hash) => match reader.advance(while_time) {
                Ok(false) => Stage::Reading(reader, hash),
                Ok(true) => match reader.finish() {
                    Ok(table) => {
                        let file = RecordFile { name: self.name.clone(), hash, table };
                        Stage::Asking(Box::new(Draft::new(Arc::new(file))))
                    }
                    Err(error) => Stage::Failed(error.to_string()),
                },
                Err(error) => Stage::Failed(error.to_string()),
            },
            Stage::Suggesting(draft, mut suggest) => {
                if suggest.advance(while_time) {
                    let suggestion = suggest.finish();
                    let file = Arc::clone(draft.file());
                    return Some(Opened { file, scenario: suggestion.scenario, reasons: suggestion.reasons });
                }
                Stage::Suggesting(draft, suggest)
            }
            Stage::Asking(mut draft) => {
                draft.advance(while_time);
                Stage::Asking(draft)
            }
            Stage::Failed(reason) => Stage::Failed(reason),
        };
        None
    }

    /// Whether something is computed.
    pub fn is_busy(&self) -> bool {
        match &self.stage {
            Stage::Hashing(..) | Stage::Reading(..) | Stage::Suggesting(..) => true,
            Stage::Asking(draft) => draft.is_busy(),
            Stage::Failed(_) => false,
        }
    }

    /// The file once it has been read.
    pub fn file(&self) -> Option<&Arc<RecordFile>> {
        match &self.stage {
            Stage::Asking(draft) | Stage::Suggesting(draft, _) => Some(draft.file()),
            _ => None,
        }
    }

    /// The meaning of the columns as it is being chosen, for tests to change.
    pub fn draft_mut(&mut self) -> Option<&mut Draft> {
        match &mut self.stage {
            Stage::Asking(draft) => Some(draft),
            _ => None,
        }
    }

    /// Takes the choices: makes start values, or opens the record at once.
    fn accept(&mut self, record: Record, scenario: Scenario) -> Option<Opened> {
        let Stage::Asking(draft) = std::mem::replace(&mut self.stage, Stage::Failed(String::new())) else {
            return None;
        };
        if draft.suggest {
            let suggest = Suggest::new(&scenario, record);
            self.stage = Stage::Suggesting(draft, Box::new(suggest));
            return None;
        }
        Some(Opened { file: Arc::clone(draft.file()), scenario, reasons: Vec::new() })
    }
}

/// The bytes that are hashed between two looks at the clock: about a millisecond.
const CHUNK: usize = 500_000;

/// Hashes the next bytes; the reader comes after the last ones.
fn hashed(bytes: Vec<u8>, mut hash: Hash, mut done: usize, while_time: &mut dyn FnMut() -> bool) -> Stage {
    while done < bytes.len() {
        let end = (done + CHUNK).min(bytes.len());
        hash.add(&bytes[done..end]);
        done = end;
        if !while_time() {
            return Stage::Hashing(bytes, hash, done);
        }
    }
    match Reader::new(bytes, None) {
        Ok(reader) => Stage::Reading(Box::new(reader), hash.text()),
        Err(error) => Stage::Failed(error.to_string()),
    }
}
