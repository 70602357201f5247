//! The state of the screen as data, for tests that drive it from outside.

use kalmanscope_core::{Channel, Estimates};
use kalmanscope_lab::posterior::Sampled;
use serde::Serialize;

use super::places;
use crate::laboratory::Survey;
use crate::session::{Mode, Session};

/// The state of the screen.
#[derive(Clone, Debug, Serialize)]
pub struct ScreenState {
    /// `live` or `whole`.
    pub mode: &'static str,
    /// Whether playback runs.
    pub playing: bool,
    /// The title of the lesson, and its step, from 1 on.
    pub lesson: Option<(String, usize)>,
    /// The number of samples shown.
    pub samples: usize,
    /// The latest estimates, one per filter.
    pub filters: Vec<Latest>,
    /// Checksum of all estimates shown, as 16 hexadecimal digits.
    pub checksum: String,
    /// The map, if one has been made.
    pub map: Option<MapState>,
    /// The points of the posterior on screen, if there are some.
    pub posterior: Option<PosteriorState>,
    /// Frames drawn since the start.
    pub frames: u64,
    /// Positions of the named controls.
    pub controls: Vec<Control>,
}

/// The state of the map.
#[derive(Clone, Debug, Serialize)]
pub struct MapState {
    /// The number of cells.
    pub cells: usize,
    /// Those that are known.
    pub done: usize,
    /// Checksum of all of them, as 16 hexadecimal digits.
    pub checksum: String,
    /// The computers of these rows, in words.
    pub computers: Vec<String>,
    /// The ensemble, as [`Ensemble::to_json`](kalmanscope_lab::Ensemble::to_json) writes it.
    pub ensemble: String,
}

impl MapState {
    /// The present state of a map.
    pub fn of(survey: &Survey) -> Self {
        let sheet = survey.sheet();
        let checksum = format!("{:016x}", sheet.checksum());
        let computers = survey.computers().iter().map(ToString::to_string).collect();
        Self { cells: sheet.len(), done: sheet.done(), checksum, computers, ensemble: survey.ensemble().to_json() }
    }
}

/// The points of a posterior.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PosteriorState {
    /// Their number.
    pub points: usize,
    /// ln p(z), the logarithm of the probability density of the record.
    pub log_evidence: f64,
}

/// A filter's latest estimate.
#[derive(Clone, Debug, Serialize)]
pub struct Latest {
    /// The filter's name.
    pub name: String,
    /// Mean and standard deviation of each channel.
    pub estimates: Vec<Estimate>,
}

/// One channel of it.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Estimate {
    /// The channel.
    pub channel: Channel,
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub std: f64,
}

/// A control's name and place on screen \[points\].
#[derive(Clone, Debug, Serialize)]
pub struct Control {
    /// The control's accessible name.
    pub name: String,
    /// Left edge.
    pub x: f32,
    /// Top edge.
    pub y: f32,
    /// Width.
    pub width: f32,
    /// Height.
    pub height: f32,
}

impl ScreenState {
    /// The present state.
    pub fn new(
        session: &Session,
        lesson: Option<(String, usize)>,
        map: Option<&Survey>,
        posterior: Option<&Sampled>,
        ctx: &egui::Context,
    ) -> Self {
        let estimates = session.run().estimates();
        Self {
            mode: match session.mode() {
                Mode::Live => "live",
                Mode::Whole => "whole",
            },
            playing: session.playing(),
            lesson,
            samples: session.run().len(),
            filters: estimates.iter().map(Latest::of).collect(),
            checksum: format!("{:016x}", session.run().checksum()),
            map: map.map(MapState::of),
            posterior: posterior.map(|of| PosteriorState { points: of.points.len(), log_evidence: of.log_evidence }),
            frames: ctx.cumulative_frame_nr(),
            controls: places::all(ctx).into_iter().map(control).collect(),
        }
    }
}

impl Latest {
    /// The latest estimate of a filter.
    pub(crate) fn of(estimates: &Estimates) -> Self {
        let one = |(at, &channel): (usize, &Channel)| {
            let last = estimates.len().checked_sub(1)?;
            Some(Estimate { channel, mean: estimates.mean(last)[at], std: estimates.std(last, at) })
        };
        Self {
            name: estimates.name().to_owned(),
            estimates: estimates.channels().iter().enumerate().filter_map(one).collect(),
        }
    }
}

fn control((name, rect): (String, egui::Rect)) -> Control {
    Control { name, x: rect.left(), y: rect.top(), width: rect.width(), height: rect.height() }
}
