//! The app in the frame of another page, and the data that this page may read.

use kalmanscope_core::Document;
use serde::Serialize;

use super::App;
use crate::probe::Latest;
use crate::saved::{Found, Saved};
use crate::session::{Budget, Mode};
use crate::share::message::{Message, Refusal, Topic, Wish, answer, answer_error};
use crate::theme;

/// Playback and the latest estimates, as the page that embeds this one reads them.
#[derive(Serialize)]
struct State {
    mode: &'static str,
    playing: bool,
    /// From the first sample on \[s\].
    time: f64,
    /// The last sample's time \[s\].
    end: f64,
    samples: usize,
    /// Whether another picture is being computed.
    computing: bool,
    checksum: String,
    filters: Vec<Latest>,
    /// The message on screen.
    notice: Option<String>,
}

impl App {
    /// The explorer for the frame of another page: plots and transport, and no saved session, neither read nor written.
    ///
    /// # Errors
    /// [`kalmanscope_core::RunError`] where even the default scenario cannot be run.
    pub fn embedded(creation: &eframe::CreationContext<'_>) -> Result<Self, kalmanscope_core::RunError> {
        theme::install(&creation.egui_ctx);
        let found = Found { saved: Saved::default(), new_here: false, problem: None };
        let app = Self::from_found(found, Budget::FRAME)?;
        Ok(Self { embedded: true, ..app })
    }

    /// Whether another page embeds this one.
    pub fn is_embedded(&self) -> bool {
        self.embedded
    }

    /// Takes a message's wish to change the screen; the next frame follows it.
    ///
    /// # Errors
    /// [`Refusal`] where the message cannot be followed; nothing changes then.
    pub fn take_message(&mut self, text: &str) -> Result<Message, Refusal> {
        let mut message = Message::read(text)?;
        if let Wish::Set(requests) = &mut message.wish {
            self.requests.append(requests);
        }
        Ok(message)
    }

    /// The answer to a message, after the frame that has followed it.
    pub fn answer_message(&self, Message { id, wish }: &Message) -> Document {
        match wish {
            Wish::Set(_) => answer(id, "set", Document::Flag(true)),
            Wish::Get(Topic::State) => answer(id, "state", Document::of(&self.state()).unwrap_or(Document::Null)),
            Wish::Get(Topic::Link) => match self.link() {
                Ok(link) => answer(id, "link", Document::Text(link)),
                Err(error) => answer_error(id, &format!("There is no link to this picture: {error}.")),
            },
            Wish::Get(Topic::Scenario) => match self.session.scenario().to_toml() {
                Ok(toml) => answer(id, "scenario", Document::Text(toml)),
                Err(error) => answer_error(id, &format!("The scenario cannot be written: {error}.")),
            },
        }
    }

    fn state(&self) -> State {
        let Self { session, .. } = self;
        State {
            mode: match session.mode() {
                Mode::Live => "live",
                Mode::Whole => "whole",
            },
            playing: session.playing(),
            time: session.time() - session.run().record().time_of(0),
            end: session.end(),
            samples: session.run().len(),
            computing: session.behind(),
            checksum: format!("{:016x}", session.run().checksum()),
            filters: session.run().estimates().iter().map(Latest::of).collect(),
            notice: self.notice().map(str::to_owned),
        }
    }
}
