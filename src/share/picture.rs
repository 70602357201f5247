//! A picture as data and as text: links, session files and the storage have the same text.

use std::collections::BTreeSet;

use kalmanscope_core::Scenario;
use kalmanscope_core::document::{self, Document, DocumentError};
use kalmanscope_lessons::BuiltIn;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::kinds::{Answer, LegendEntry, ViewKind};
use crate::laboratory::Choices;
use crate::layout::{Outline, ViewLayout};
use crate::ruler::Ruler;
use crate::session::{Mode, Session};

const KEY: &str = "kalmanscope_session";

const FORMAT: u64 = 1;

/// These keys are always written: their usual values may be others in a later program.
const ALWAYS: [&str; 3] = ["scenario", "views", "mode"];

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct SavedPicture {
    #[serde(with = "toml")]
    pub scenario: Scenario,
    pub views: Option<Outline>,
    pub enlarged: Option<ViewKind>,
    pub laboratory: Choices,
    pub mode: Mode,
    /// The time of playback, from the first sample on \[s\].
    pub time: f64,
    pub speed: f64,
    #[serde(rename = "marks")]
    pub ruler: Ruler,
    pub hidden: Vec<LegendEntry>,
    pub habits: Option<Habits>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Habits {
    pub(crate) presenting: bool,
    pub(crate) dark: Option<bool>,
    pub(crate) all_settings: bool,
    pub(crate) lessons: Studies,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Studies {
    pub(crate) bookmark: Option<Bookmark>,
    pub(crate) finished: BTreeSet<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Bookmark {
    pub(crate) lesson: String,
    pub(crate) step: usize,
    pub(crate) changed: bool,
    #[serde(default)]
    pub(crate) answer: Option<Answer>,
}

#[derive(Debug, Error)]
pub enum PictureError {
    #[error("it has format {0}, and this program reads format 1")]
    Format(String),
    #[error(transparent)]
    Document(#[from] DocumentError),
    #[error("{0}")]
    Impossible(String),
}

impl Default for SavedPicture {
    fn default() -> Self {
        Self::new(BuiltIn::FIRST.scenario().unwrap_or_default(), &ViewLayout::default(), Mode::default(), 0.0)
    }
}

impl SavedPicture {
    pub(crate) fn new(scenario: Scenario, layout: &ViewLayout, mode: Mode, time: f64) -> Self {
        Self {
            scenario,
            views: Outline::of(layout.tree()),
            enlarged: layout.enlarged(),
            laboratory: Choices::default(),
            mode,
            time,
            speed: Session::DEFAULT_SPEED,
            ruler: Ruler::default(),
            hidden: Vec::new(),
            habits: None,
        }
    }

    pub(crate) fn layout(&self) -> ViewLayout {
        ViewLayout::of_outline(self.views.as_ref(), self.enlarged)
    }

    pub fn line(&self) -> Result<String, PictureError> {
        Ok(document::to_json(&self.document()?)?)
    }

    pub fn lines(&self) -> Result<String, PictureError> {
        Ok(document::to_json_lines(&self.document()?)?)
    }

    fn document(&self) -> Result<Document, DocumentError> {
        let usual = document::of(&Self::default())?;
        let mut document = document::of(self)?;
        if let Document::Object(entries) = &mut document {
            entries.retain(|key, value| ALWAYS.contains(&key.as_str()) || usual.get(key) != Some(value));
            entries.shift_insert(0, KEY.to_owned(), FORMAT.into());
        }
        Ok(document)
    }

    pub fn of_text(text: &str) -> Result<Self, PictureError> {
        let document = document::from_json(text)?;
        Self::of_document(document).unwrap_or_else(|| Err(PictureError::Impossible(format!("it has no key `{KEY}`"))))
    }

    pub(crate) fn of_file(bytes: &[u8]) -> Option<Result<Self, PictureError>> {
        // A record may have 500 MB: it is not read as JSON only to find that it is none.
        if bytes.iter().find(|byte| !byte.is_ascii_whitespace()) != Some(&b'{') {
            return None;
        }
        Self::of_document(document::from_json(std::str::from_utf8(bytes).ok()?).ok()?)
    }

    fn of_document(mut document: Document) -> Option<Result<Self, PictureError>> {
        let format = document.get(KEY)?;
        if *format != FORMAT {
            return Some(Err(PictureError::Format(format.to_string())));
        }
        // Unknown keys are refused, and this one is no field.
        document::put(&mut document, KEY, &Document::Null);
        // Other parts name channels of the scenario, whose equations stand in a text.
        let scenario = document.get("scenario").and_then(|text| Scenario::from_toml(text.as_str()?).ok());
        let read = scenario.unwrap_or_default().knowing(|| document::read(&document));
        Some(read.map_err(PictureError::from).and_then(Self::checked))
    }

    fn checked(self) -> Result<Self, PictureError> {
        let Self { scenario, views, enlarged, laboratory, time, speed, .. } = &self;
        let problem = if !time.is_finite() || *time < 0.0 {
            Err(format!("the time is {time}, but must be 0 or more"))
        } else if !speed.is_finite() || *speed <= 0.0 {
            Err(format!("the speed is {speed}, but must be above 0"))
        } else if enlarged.is_some_and(|view| !views.as_ref().is_some_and(|views| views.has(view))) {
            Err("the view that is enlarged is not shown".to_owned())
        } else {
            views.as_ref().map_or(Ok(()), Outline::validate).and_then(|()| laboratory.check(scenario))
        };
        problem.map(|()| self).map_err(PictureError::Impossible)
    }
}

mod toml {
    use kalmanscope_core::Scenario;
    use serde::{Deserialize as _, Deserializer, Serialize as _, Serializer, de, ser};

    pub(super) fn serialize<S: Serializer>(scenario: &Scenario, serializer: S) -> Result<S::Ok, S::Error> {
        scenario.to_toml().map_err(ser::Error::custom)?.serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Scenario, D::Error> {
        Scenario::from_toml(&String::deserialize(deserializer)?).map_err(de::Error::custom)
    }
}

#[cfg(test)]
mod tests;
