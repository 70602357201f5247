//! Things that arrive between two frames: files that were chosen or read, and the ends of actions that take time.

use std::sync::{Arc, Mutex, PoisonError};

use egui::Context;

/// Asks the user for a file. It returns at once; the file arrives later, if the user chooses one.
pub type Choose = Box<dyn FnMut(&Context, &Inbox)>;

/// Takes the end of an action: the place of what was written, in words, or the reason why it was not.
pub type Done = Arc<dyn Fn(Result<String, String>) + Send + Sync>;

/// Something that arrives.
#[derive(Debug)]
pub enum Arrival {
    /// A file's name, and its contents or the reason why it cannot be read.
    File(String, Result<Vec<u8>, String>),
    /// A record's file that was kept at an earlier start: its name and its contents.
    Kept(String, Vec<u8>),
    /// A sentence about something that is done.
    Done(String),
    /// A sentence about a failure.
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

    /// Puts a sentence in as soon as an action ends: one about the place, or one about the reason.
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

    /// Takes out all arrivals since the last call.
    pub(crate) fn take(&self) -> Vec<Arrival> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
