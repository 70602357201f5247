//! Files to open that do not come by drop, and the ends of writing others.

use std::path::Path;

use egui::Context;

use super::App;
use crate::drop;
use crate::inbox::{Arrival, Choose, Inbox};
use crate::notice::Notice;
use crate::request::Request;

impl App {
    #[must_use]
    pub fn choosing(self, choose: Option<Choose>) -> Self {
        Self { choose, ..self }
    }

    pub fn inbox(&self) -> &Inbox {
        &self.inbox
    }

    pub fn open_file(&mut self, name: &str, contents: Result<Vec<u8>, String>) {
        self.requests.push(drop::opened(name, contents));
    }

    pub fn read_file(&self, path: &Path, ctx: &Context) {
        drop::read(path, ctx, &self.inbox);
    }

    pub(super) fn choose_file(&mut self, ctx: &Context) {
        match &mut self.choose {
            Some(choose) => choose(ctx, &self.inbox),
            None => self.notice = Some("A file cannot be chosen here: drop it on the window.".to_owned().into()),
        }
    }

    pub(super) fn take_files(&mut self, ctx: &Context) {
        let mut opens = false;
        for arrival in self.inbox.take() {
            match arrival {
                Arrival::File(name, contents) => {
                    self.open_file(&name, contents);
                    opens = true;
                }
                // The file that names it is opened after this frame.
                Arrival::Kept(..) if opens => self.inbox.put(arrival, ctx),
                // It is opened without questions, or not at all.
                Arrival::Kept(name, bytes) if self.waits_for(&name, &bytes) => self.open_file(&name, Ok(bytes)),
                Arrival::Kept(..) => {}
                Arrival::Done(sentence) if self.notice.as_ref().is_some_and(Notice::is_failure) => {
                    self.report(&sentence);
                }
                Arrival::Done(sentence) => self.notice = Some(Notice::done(&sentence)),
                Arrival::Failure(sentence) => self.requests.push(Request::Report(sentence)),
            }
        }
    }
}
