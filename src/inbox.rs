//! Files that arrive between two frames: chosen in a dialog, or read by the page.

use std::sync::{Arc, Mutex, PoisonError};

use egui::Context;

/// Asks the user for a file. It returns at once; the file arrives later, if the user chooses one.
pub type Choose = Box<dyn FnMut(&Context, &Inbox)>;

/// Something that arrives.
#[derive(Debug)]
pub enum Arrival {
    /// A file's name, and its contents or the reason why it cannot be read.
    File(String, Result<Vec<u8>, String>),
    /// A record's file that was kept at an earlier start: its name and its contents.
    Kept(String, Vec<u8>),
    /// A sentence that says why no file can be chosen.
    Failure(String),
}

/// The place where files arrive; copies share it, also between threads.
#[derive(Clone, Default)]
pub struct Inbox(Arc<Mutex<Vec<Arrival>>>);

impl Inbox {
    /// Adds an arrival, and asks for a frame that opens it.
    pub fn put(&self, arrival: Arrival, ctx: &Context) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(arrival);
        ctx.request_repaint();
    }

    /// Whether there is another copy, whose owner may still put something.
    pub fn is_shared(&self) -> bool {
        Arc::strong_count(&self.0) > 1
    }

    /// Takes out all arrivals since the last call.
    pub(crate) fn take(&self) -> Vec<Arrival> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
