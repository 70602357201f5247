//! Probes for tests that drive the app from outside: the state of the screen as data, and the positions of controls.

use std::collections::BTreeMap;

use egui::{Context, Id, Rect};
use kalmanscope_core::{Channel, Estimates};
use serde::Serialize;

use crate::laboratory::Survey;
use crate::session::{Mode, Session};

/// Each control's position \[points\] and the frame in which it was drawn.
type Places = BTreeMap<String, (u64, Rect)>;

fn id() -> Id {
    Id::unique("places of the controls")
}

pub(crate) fn remember(ctx: &Context, name: &str, rect: Rect) {
    let frame = ctx.cumulative_frame_nr();
    ctx.data_mut(|data| {
        let places: &mut Places = data.get_temp_mut_or_default(id());
        match places.get_mut(name) {
            Some(place) => *place = (frame, rect),
            None => _ = places.insert(name.to_owned(), (frame, rect)),
        }
    });
}

/// The position of a control that the last frame drew \[points\].
pub fn place(ctx: &Context, name: &str) -> Option<Rect> {
    all(ctx).into_iter().find_map(|(other, rect)| (other == name).then_some(rect))
}

pub(crate) fn all(ctx: &Context) -> Vec<(String, Rect)> {
    // Between frames, the number is that of the next frame.
    let last = ctx.cumulative_frame_nr().saturating_sub(1);
    let drawn = |(name, (frame, rect)): (&String, &(u64, Rect))| (*frame >= last).then(|| (name.clone(), *rect));
    ctx.data_mut(|data| data.get_temp_mut_or_default::<Places>(id()).iter().filter_map(drawn).collect())
}

#[derive(Clone, Debug, Serialize)]
pub struct ScreenState {
    pub mode: &'static str,
    pub playing: bool,
    pub lesson: Option<(String, usize)>,
    pub samples: usize,
    pub filters: Vec<Latest>,
    pub checksum: String,
    pub map: Option<MapState>,
    pub frames: u64,
    pub controls: Vec<Control>,
}

#[derive(Clone, Debug, Serialize)]
pub struct MapState {
    pub cells: usize,
    pub done: usize,
    pub checksum: String,
    pub computers: Vec<String>,
    /// The ensemble, as [`Ensemble::to_json`](kalmanscope_lab::Ensemble::to_json) writes it.
    pub ensemble: String,
}

impl MapState {
    pub fn of(survey: &Survey) -> Self {
        let sheet = &survey.sheet;
        let checksum = format!("{:016x}", sheet.checksum());
        let computers = survey.computers.iter().map(ToString::to_string).collect();
        Self { cells: sheet.len(), done: sheet.done(), checksum, computers, ensemble: survey.ensemble.to_json() }
    }
}

#[derive(Clone, Debug, Serialize)]
pub struct Latest {
    pub name: String,
    pub estimates: Vec<Estimate>,
}

#[derive(Clone, Copy, Debug, Serialize)]
pub struct Estimate {
    pub channel: Channel,
    pub mean: f64,
    pub std: f64,
}

/// A control's name and place on screen \[points\].
#[derive(Clone, Debug, Serialize)]
pub struct Control {
    pub name: String,
    pub x: f32,
    pub y: f32,
    pub width: f32,
    pub height: f32,
}

impl ScreenState {
    pub fn new(session: &Session, lesson: Option<(String, usize)>, map: Option<&Survey>, ctx: &Context) -> Self {
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
            frames: ctx.cumulative_frame_nr(),
            controls: all(ctx).into_iter().map(control).collect(),
        }
    }
}

impl Latest {
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
