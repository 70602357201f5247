//! Files that are dropped on the window, chosen in a dialog or read, and the ends of actions: things that arrive between two frames.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;

use egui::Context;
use kalmanscope_lessons::LibraryFile;

use crate::import;
use crate::request::{RawFile, Request};
use crate::session::name_of;
use crate::share::SavedPicture;

/// Asks the user for a file. It returns at once; the file arrives later, if the user chooses one.
pub type Choose = Box<dyn FnMut(&Context, &Inbox)>;

/// Takes the end of an action: the place of the written file, in words, or the reason of the failure.
pub type Done = Arc<dyn Fn(Result<String, String>) + Send + Sync>;

#[derive(Debug)]
pub enum Arrival {
    File(String, Result<Vec<u8>, String>),
    Kept(String, Vec<u8>),
    Done(String),
    Shelved(String),
    Failure(String),
}

#[derive(Clone, Default)]
pub struct Inbox(Arc<Mutex<Vec<Arrival>>>);

impl Inbox {
    pub fn put(&self, arrival: Arrival, ctx: &Context) {
        // A thread that panics holds the lock for one push or take only, so the list is whole.
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(arrival);
        ctx.request_repaint();
    }

    pub fn is_shared(&self) -> bool {
        Arc::strong_count(&self.0) > 1
    }

    pub(crate) fn done(
        &self,
        ctx: &Context,
        place: impl Fn(&str) -> String + Send + Sync + 'static,
        reason: impl Fn(&str) -> String + Send + Sync + 'static,
    ) -> Done {
        let (inbox, ctx) = (self.clone(), ctx.clone());
        Arc::new(move |end| match end {
            Ok(text) => inbox.put(Arrival::Done(place(&text)), &ctx),
            Err(text) => inbox.put(Arrival::Failure(reason(&text)), &ctx),
        })
    }

    pub(crate) fn take(&self) -> Vec<Arrival> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Limits the size of a file \[bytes\].
pub const LARGEST: usize = import::LARGEST;

/// Limits the size of a lesson or a scenario \[bytes\].
const LARGEST_TEXT: usize = 1_000_000;

pub(crate) fn dropped(ctx: &Context, inbox: &Inbox) {
    if let Some(file) = ctx.input(|input| input.raw.dropped_files.last().cloned()) {
        read(file.path(), ctx, inbox);
    }
}

pub(crate) fn read(path: &Path, ctx: &Context, inbox: &Inbox) {
    let (path, screen, there) = (path.to_owned(), ctx.clone(), inbox.clone());
    let read = move || {
        let bytes = read_path(&path);
        let record = bytes.as_ref().ok().and_then(|bytes| record_beside(&path, bytes));
        // The scenario first: it names the record, and nothing waits for a record that nothing names.
        there.put(Arrival::File(file_name(&path), bytes), &screen);
        if let Some((name, bytes)) = record {
            there.put(Arrival::Kept(name, bytes), &screen);
        }
    };
    if let Err(error) = thread::Builder::new().name("file".to_owned()).spawn(read) {
        inbox.put(Arrival::Failure(format!("The file cannot be read: {error}.")), ctx);
    }
}

fn record_beside(path: &Path, bytes: &[u8]) -> Option<(String, Vec<u8>)> {
    let scenario = match SavedPicture::of_file(bytes) {
        Some(session) => session.ok()?.scenario,
        None if is_toml(&file_name(path)) => match LibraryFile::from_toml(std::str::from_utf8(bytes).ok()?).ok()? {
            LibraryFile::Scenario(scenario) => *scenario,
            LibraryFile::Lesson(_) => return None,
        },
        None => return None,
    };
    let name = name_of(&scenario.record?).to_owned();
    let bytes = read_path(&path.with_file_name(&name)).ok()?;
    Some((name, bytes))
}

pub(crate) fn opened(name: &str, bytes: Result<Vec<u8>, String>) -> Request {
    if let Some(session) = bytes.as_ref().ok().and_then(|bytes| SavedPicture::of_file(bytes)) {
        return session.map_or_else(|error| refused(name, &error), |saved| Request::OpenSession(Box::new(saved)));
    }
    let bytes = match bytes {
        Ok(bytes) if bytes.len() > LARGEST => Err(TOO_LARGE.to_owned()),
        Ok(bytes) if !is_toml(name) => {
            return Request::ImportFile(Box::new(RawFile { name: name.to_owned(), bytes, is_measured: false }));
        }
        bytes => bytes,
    };
    let opened = bytes.and_then(text).and_then(|text| LibraryFile::from_toml(&text).map_err(|error| error.to_string()));
    match opened {
        Ok(LibraryFile::Lesson(lesson)) => Request::StudyLesson(lesson),
        Ok(LibraryFile::Scenario(scenario)) => Request::OpenScenario(scenario),
        Err(reason) => refused(name, &reason),
    }
}

fn refused(name: &str, reason: &impl ToString) -> Request {
    let reason = reason.to_string();
    Request::Report(format!("“{name}” cannot be opened: {}.", reason.trim_end_matches(['.', '\n', ' '])))
}

pub fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| "The file".to_owned(), |name| name.to_string_lossy().into_owned())
}

/// The file's contents, or a byte more than [`LARGEST`] where it is too large.
pub fn read_path(path: &Path) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(LARGEST as u64 + 1).read_to_end(&mut bytes));
    read.map(|_| bytes).map_err(|error| error.to_string())
}

fn text(bytes: Vec<u8>) -> Result<String, String> {
    if bytes.len() > LARGEST_TEXT {
        return Err("it is larger than 1 MB".to_owned());
    }
    String::from_utf8(bytes).map_err(|_| "it is not text".to_owned())
}

pub const TOO_LARGE: &str = "it is larger than 500 MB";

fn is_toml(name: &str) -> bool {
    name.rsplit('.').next().is_some_and(|end| end.eq_ignore_ascii_case("toml"))
}
