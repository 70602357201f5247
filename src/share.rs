//! A picture as a link: what is on screen, compressed, in the fragment of an address.
//!
//! ```text
//! #link=1.DATA     DATA = base64url(deflate(line of JSON + scenario as TOML) + check)
//! ```
//! The number is the format's version. A program reads the versions up to its own.

pub mod address;
mod base64url;
pub mod message;
mod outline;
mod packed;

use kalmanscope_core::{Document, DocumentError, Scenario, ScenarioError};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::laboratory::{Choice, Choices, SeedChoice, TuneChoice};
use crate::layout::Layout;
use crate::request::{LegendEntry, ViewKind};
use crate::ruler::Ruler;
use crate::session::{Mode, Session};

pub use outline::Outline;

/// The beginning of a fragment with a link.
pub const MARK: &str = "#link=";

/// The newest format.
const VERSION: u32 = 1;

/// Limits the characters of a link after [`MARK`].
pub const LONGEST: usize = 16_384;

/// A picture: everything that another machine needs to show the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The settings. All samples and estimates follow from them.
    pub scenario: Scenario,
    /// The views and their places; `None` where no view is shown.
    pub views: Option<Outline>,
    /// The view that is enlarged.
    pub enlarged: Option<ViewKind>,
    /// The choices in the laboratory, as far as a view shows them.
    pub laboratory: Choices,
    /// Live, or the whole record.
    pub mode: Mode,
    /// The time at which playback stands, from the first sample on \[s\].
    pub time: f64,
    /// Simulated seconds per second.
    pub speed: f64,
    /// The marked times.
    pub ruler: Ruler,
    /// The entries of the legend that are hidden.
    pub hidden: Vec<LegendEntry>,
}

/// The reason why a link cannot be read or made.
#[derive(Debug, Error)]
pub enum LinkError {
    /// The text is longer than [`LONGEST`].
    #[error("it has {0} characters, and a link has at most {LONGEST}")]
    TooLong(usize),
    /// The version is not known.
    #[error("it is of version {0}, and this program reads links up to version {VERSION}")]
    Newer(u64),
    /// The text is not what a program has written.
    #[error("it is damaged: a part of it is missing or changed")]
    Damaged,
    /// The line about the screen is not valid.
    #[error("its views cannot be shown: {0}")]
    Screen(String),
    /// The scenario is not valid.
    #[error("its scenario cannot be used: {0}")]
    Scenario(#[from] ScenarioError),
}

/// The first line of a link's text, as JSON. The scenario follows it. What is as usual is left out: the link is shorter, and
/// a program that does not know the field reads it.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Screen {
    views: Option<Outline>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    enlarged: Option<ViewKind>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    map: Option<Choice>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    seeds: Option<SeedChoice>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    tuning: Option<TuneChoice>,
    mode: Mode,
    time: f64,
    #[serde(default = "usual_speed", skip_serializing_if = "is_usual_speed")]
    speed: f64,
    #[serde(default, skip_serializing_if = "is_unused")]
    marks: Ruler,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    hidden: Vec<LegendEntry>,
}

const fn usual_speed() -> f64 {
    Session::DEFAULT_SPEED
}

#[cfg_attr(target_pointer_width = "64", expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks by reference"))]
fn is_usual_speed(speed: &f64) -> bool {
    *speed == usual_speed()
}

fn is_unused(ruler: &Ruler) -> bool {
    !ruler.is_used()
}

impl Picture {
    /// The picture with these settings and views, at the usual speed, without marks, with all of the legend.
    pub(crate) fn new(scenario: Scenario, layout: &Layout, mode: Mode, time: f64) -> Self {
        let (views, enlarged) = (Outline::of(layout.tree()), layout.enlarged());
        let (speed, ruler, hidden) = (usual_speed(), Ruler::default(), Vec::new());
        let laboratory = Choices::default();
        Self { scenario, views, enlarged, laboratory, mode, time, speed, ruler, hidden }
    }

    /// The picture as a fragment, from `#` on.
    ///
    /// # Errors
    /// [`LinkError::Scenario`] where the scenario cannot be written, [`LinkError::TooLong`] where the link would be too
    /// long.
    pub fn fragment(&self) -> Result<String, LinkError> {
        let Self { scenario, views, enlarged, laboratory, mode, time, speed, ruler, hidden } = self.clone();
        let Choices { map, seeds, tuning } = laboratory;
        let screen = Screen { views, enlarged, map, seeds, tuning, mode, time, speed, marks: ruler, hidden };
        let screen = Document::json(&screen).map_err(|error: DocumentError| LinkError::Screen(error.to_string()))?;
        let text = format!("{screen}\n{}", scenario.to_toml()?);
        let link = format!("{VERSION}.{}", base64url::encode(&packed::pack(&text)));
        if link.len() > LONGEST { Err(LinkError::TooLong(link.len())) } else { Ok(format!("{MARK}{link}")) }
    }

    /// Reads the text after [`MARK`].
    ///
    /// # Errors
    /// [`LinkError`] with the reason. No text is decoded that is longer than [`LONGEST`], and none is decompressed beyond
    /// 64 kB.
    pub fn read(link: &str) -> Result<Self, LinkError> {
        if link.len() > LONGEST {
            return Err(LinkError::TooLong(link.chars().count()));
        }
        let (version, data) = link.split_once('.').ok_or(LinkError::Damaged)?;
        match version.parse() {
            Ok(newer) if newer > u64::from(VERSION) => return Err(LinkError::Newer(newer)),
            Ok(version) if version == u64::from(VERSION) => {}
            _ => return Err(LinkError::Damaged),
        }
        let bytes = base64url::decode(data).ok_or(LinkError::Damaged)?;
        let text = packed::unpack(&bytes).ok_or(LinkError::Damaged)?;
        Self::from_text(&text)
    }

    fn from_text(text: &str) -> Result<Self, LinkError> {
        let (screen, scenario) = text.split_once('\n').ok_or(LinkError::Damaged)?;
        let screen: Screen =
            Document::read_json(screen).map_err(|error: DocumentError| LinkError::Screen(error.to_string()))?;
        let Screen { views, enlarged, map, seeds, tuning, mode, time, speed, marks: ruler, hidden } = screen;
        if let Some(views) = &views {
            views.validate().map_err(LinkError::Screen)?;
        }
        let shown = |view: &ViewKind| views.as_ref().is_some_and(|views| views.has(*view));
        if !time.is_finite() || time < 0.0 {
            return Err(LinkError::Screen(format!("the time is {time}, but must be 0 or more")));
        }
        if !speed.is_finite() || speed <= 0.0 {
            return Err(LinkError::Screen(format!("the speed is {speed}, but must be above 0")));
        }
        if enlarged.as_ref().is_some_and(|view| !shown(view)) {
            return Err(LinkError::Screen("the view that is enlarged is not shown".to_owned()));
        }
        let scenario = Scenario::from_toml(scenario)?;
        let laboratory = Choices { map, seeds, tuning };
        laboratory.check(&scenario).map_err(LinkError::Screen)?;
        Ok(Self { scenario, views, enlarged, laboratory, mode, time, speed, ruler, hidden })
    }

    /// The views as tiles.
    pub(crate) fn layout(&self) -> Layout {
        let mut layout = Layout::of_tiles(|tiles| self.views.as_ref().map(|views| views.insert_into(tiles)));
        if let Some(view) = self.enlarged {
            layout.enlarge(view);
        }
        layout
    }
}

#[cfg(test)]
mod tests;
