//! Things that arrive between two frames: files that were chosen or read, and the ends of actions that take time.

use std::sync::{Arc, Mutex, PoisonError};

use egui::Context;

/// Asks the user for a file. It returns at once; the file arrives later, if the user chooses one.
pub type Choose = Box<dyn FnMut(&Context, &Inbox)>;

/// Takes the end of an action: the place of the written file, in words, or the reason of the failure.
pub type Done = Arc<dyn Fn(Result<String, String>) + Send + Sync>;

#[derive(Debug)]
pub enum Arrival {
    File(String, Result<Vec<u8>, String>),
    Kept(String, Vec<u8>),
    Done(String),
    Failure(String),
}

#[derive(Clone, Default)]
pub struct Inbox(Arc<Mutex<Vec<Arrival>>>);

impl Inbox {
    pub fn put(&self, arrival: Arrival, ctx: &Context) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(arrival);
        ctx.request_repaint();
    }

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
