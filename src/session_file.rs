//! A session as a file: scenario, views and playback.

use egui_tiles::Tree;
use kalmanscope_core::{Document, DocumentError, Scenario};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::laboratory::{Choice, Choices, SeedChoice, TuneChoice};
use crate::layout::Layout;
use crate::request::{SavedScreen, ViewKind};
use crate::session::{Mode, Session};

/// The key that tells such a file from others; its value is the format.
const KEY: &str = "kalmanscope_session";

/// The newest format.
const VERSION: u64 = 1;

/// The reason why a session cannot be read or written.
#[derive(Debug, Error)]
pub(crate) enum SessionFileError {
    #[error("it has format {0}, and this program reads formats up to {VERSION}")]
    Newer(u64),
    #[error("the session cannot be read: {0}")]
    Json(#[from] DocumentError),
    #[error("its scenario: {0}")]
    Scenario(#[from] kalmanscope_core::ScenarioError),
    #[error("`{key}` is {value}, but must be a finite number{more}")]
    Number { key: &'static str, value: f64, more: &'static str },
    #[error("its laboratory: {0}")]
    Laboratory(String),
    #[error("a view of its layout has two places")]
    Layout,
}

/// The format, with one key per part.
#[derive(Serialize, Deserialize)]
struct Written {
    kalmanscope_session: u64,
    /// The program's version.
    program: String,
    /// A scenario file.
    scenario: String,
    mode: Mode,
    speed: f64,
    time: f64,
    layout: Tree<ViewKind>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    map: Option<Choice>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    seeds: Option<SeedChoice>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tuning: Option<TuneChoice>,
}

/// The text of the file.
pub(crate) fn text(
    session: &Session,
    layout: &Layout,
    Choices { map, seeds, tuning }: Choices,
) -> Result<String, SessionFileError> {
    Ok(Document::json_lines(&Written {
        kalmanscope_session: VERSION,
        program: env!("CARGO_PKG_VERSION").to_owned(),
        scenario: session.scenario().to_toml()?,
        mode: session.mode(),
        speed: session.speed(),
        time: session.time() - session.run().record().time_of(0),
        layout: layout.tree().clone(),
        map,
        seeds,
        tuning,
    })?)
}

/// The session in a file; none where it is another kind of file.
pub(crate) fn read(bytes: &[u8]) -> Option<Result<SavedScreen, SessionFileError>> {
    if bytes.iter().find(|byte| !byte.is_ascii_whitespace()) != Some(&b'{') {
        return None;
    }
    let document = Document::from_json(std::str::from_utf8(bytes).ok()?).ok()?;
    let version = document.get(KEY)?.read().unwrap_or(u64::MAX);
    Some(if version > VERSION { Err(SessionFileError::Newer(version)) } else { saved(&document) })
}

fn saved(document: &Document) -> Result<SavedScreen, SessionFileError> {
    let Written { scenario, mode, speed, time, layout, map, seeds, tuning, .. } = document.read()?;
    if !(speed.is_finite() && speed > 0.0) {
        return Err(SessionFileError::Number { key: "speed", value: speed, more: " above 0" });
    }
    if !(time.is_finite() && time >= 0.0) {
        return Err(SessionFileError::Number { key: "time", value: time, more: ", at least 0" });
    }
    if Layout::of_tree(layout.clone()).is_none() {
        return Err(SessionFileError::Layout);
    }
    let scenario = Scenario::from_toml(&scenario)?;
    let laboratory = Choices { map, seeds, tuning };
    laboratory.check(&scenario).map_err(SessionFileError::Laboratory)?;
    Ok(SavedScreen { scenario, mode, speed, time, tree: layout, laboratory })
}
