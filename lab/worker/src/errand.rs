//! Long work on one thing in a worker, a portion after the other.

use js_sys::Array;

use crate::file::{file, loaded_message};
use crate::filter::Filter;
use crate::scope::{Watch, Words, send};
use crate::slices::Slices;
use crate::suggestion::{suggest, suggestion_message};
use crate::work::Work;

/// Long work on one thing.
pub struct Errand {
    number: f64,
    work: Box<dyn Work>,
}

impl Errand {
    /// The errand of a message, if it is one.
    ///
    /// # Errors
    /// The reason in words where it cannot be done.
    pub fn new(words: &Words) -> Option<Result<Self, String>> {
        let work: Result<Box<dyn Work>, String> = match words.text(0).as_str() {
            "filter" => Filter::new(words).map(|filter| Box::new(filter) as _),
            "file" => Ok(Box::new(Slices::new(file(words), loaded_message))),
            "suggest" => suggest(words).map(|suggest| Box::new(Slices::new(suggest, suggestion_message)) as _),
            _ => return None,
        };
        Some(work.map(|work| Self { number: words.job(), work }))
    }

    /// Its number on the page.
    pub fn number(&self) -> f64 {
        self.number
    }

    /// Does as many portions as a message asks for, and sends the part that they give.
    pub fn answer(&mut self, words: &Words) {
        let (handed_over, watch) = (Array::new(), Watch::start());
        let part = self.work.go_on(words.get(2).as_f64().unwrap_or(0.0) as usize, &handed_over);
        send(&Array::of4(&"part".into(), &self.number.into(), &part, &watch.time().into()), &handed_over);
    }
}
