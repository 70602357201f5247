//! Keeps the file of the record on screen, so that it is there at the next start.

use std::rc::Rc;

use egui::Context;

use crate::inbox::{Done, Inbox};

/// Limits the size of a file that is kept \[bytes\].
pub const LARGEST: usize = 64_000_000;

pub trait RecordStore {
    fn keep(&self, name: &str, bytes: Rc<[u8]>, done: Done);

    fn fetch(&self, ctx: &Context, inbox: &Inbox);

    fn forget(&self, done: Done);
}

pub(crate) struct StoredFile {
    pub(crate) name: String,
    pub(crate) bytes: Rc<[u8]>,
}

impl StoredFile {
    pub(crate) fn of(name: &str, bytes: &[u8]) -> Option<Self> {
        (bytes.len() <= LARGEST).then(|| Self { name: name.to_owned(), bytes: bytes.into() })
    }
}
