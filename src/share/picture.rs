//! A picture as data: its scenario, and all else of the screen.

use kalmanscope_core::{Scenario, ScenarioError};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::outline::Outline;
use crate::laboratory::{Choice, Choices, SeedChoice, TuneChoice};
use crate::request::{LegendEntry, ViewKind};
use crate::ruler::Ruler;
use crate::session::{Mode, Session};

/// A picture: everything that another machine needs to show the same.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The settings. All samples and estimates follow from them.
    pub scenario: Scenario,
    /// The views and their places. `None` if no view is shown.
    pub views: Option<Outline>,
    /// The view that is enlarged.
    pub enlarged: Option<ViewKind>,
    /// The choices in the laboratory that a view shows.
    pub laboratory: Choices,
    /// Live, or the whole record.
    pub mode: Mode,
    /// The time of playback, from the first sample on \[s\].
    pub time: f64,
    /// Simulated seconds per second.
    pub speed: f64,
    /// The marked times.
    pub ruler: Ruler,
    /// The entries of the legend that are hidden.
    pub hidden: Vec<LegendEntry>,
}

/// The reason why a picture cannot be shown or written.
#[derive(Debug, Error)]
pub enum PictureError {
    /// The part about the screen is not valid.
    #[error("its views cannot be shown: {0}")]
    Screen(String),
    /// The scenario is not valid.
    #[error("its scenario cannot be used: {0}")]
    Scenario(#[from] ScenarioError),
}

/// A picture without its scenario, as links and session files have it. What is as usual is left out: the text is shorter, and
/// a program that does not know the field reads it.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Screen {
    pub(crate) views: Option<Outline>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) enlarged: Option<ViewKind>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) map: Option<Choice>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) seeds: Option<SeedChoice>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) tuning: Option<TuneChoice>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) posterior: Option<u32>,
    pub(crate) mode: Mode,
    pub(crate) time: f64,
    #[serde(default = "usual_speed", skip_serializing_if = "is_usual_speed")]
    pub(crate) speed: f64,
    #[serde(default, skip_serializing_if = "is_unused")]
    pub(crate) marks: Ruler,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) hidden: Vec<LegendEntry>,
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
    /// The picture without its scenario, and the scenario as TOML.
    pub(crate) fn parts(&self) -> Result<(Screen, String), PictureError> {
        let Self { scenario, views, enlarged, laboratory, mode, time, speed, ruler, hidden } = self.clone();
        let Choices { map, seeds, tuning, posterior } = laboratory;
        let screen = Screen { views, enlarged, map, seeds, tuning, posterior, mode, time, speed, marks: ruler, hidden };
        Ok((screen, scenario.to_toml()?))
    }

    /// The picture of its two parts, checked, since they may come from outside.
    pub(crate) fn of_parts(screen: Screen, scenario: &str) -> Result<Self, PictureError> {
        let Screen { views, enlarged, map, seeds, tuning, posterior, mode, time, speed, marks: ruler, hidden } = screen;
        if let Some(views) = &views {
            views.validate().map_err(PictureError::Screen)?;
        }
        let shown = |view: &ViewKind| views.as_ref().is_some_and(|views| views.has(*view));
        if !time.is_finite() || time < 0.0 {
            return Err(PictureError::Screen(format!("the time is {time}, but must be 0 or more")));
        }
        if !speed.is_finite() || speed <= 0.0 {
            return Err(PictureError::Screen(format!("the speed is {speed}, but must be above 0")));
        }
        if enlarged.as_ref().is_some_and(|view| !shown(view)) {
            return Err(PictureError::Screen("the view that is enlarged is not shown".to_owned()));
        }
        let scenario = Scenario::from_toml(scenario)?;
        let laboratory = Choices { map, seeds, tuning, posterior };
        laboratory.check(&scenario).map_err(PictureError::Screen)?;
        Ok(Self { scenario, views, enlarged, laboratory, mode, time, speed, ruler, hidden })
    }
}
