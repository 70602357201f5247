//! What is drawn: one view a file, each a function of an immutable context.

mod autocorrelation;
pub mod axis;
mod channels;
mod chart;
mod charts;
mod consistency;
mod errors;
mod frequency_response;
mod gain;
mod heading;
mod innovations;
mod kept;
mod layer;
pub mod layout;
pub mod legend;
mod matrices;
pub mod oscillator;
mod parameter_plane;
mod pen;
mod phase;
mod picture;
mod plane;
mod sampled;
mod scores;
mod ticks;
mod vertical;

use std::hash::{DefaultHasher, Hash as _, Hasher as _};

use egui::{Rect, Ui, vec2};
use kalmanscope_core::Channel;
use kalmanscope_core::diagnostics::Depth;
use serde::{Deserialize, Serialize};

use crate::command::Command;
use crate::session::Session;
use crate::theme::Palette;

pub use axis::TimeAxis;
pub use layout::{Arrangement, Layout};
pub use legend::Shown;

/// Everything that a view may read.
#[derive(Clone, Copy)]
pub struct ViewContext<'a> {
    /// The scenario and its run.
    pub session: &'a Session,
    /// The colours of the theme.
    pub palette: &'a Palette,
    /// What the legend has switched on.
    pub shown: &'a Shown,
    /// The common time axis.
    pub axis: &'a TimeAxis,
    /// A number that changes with everything that is drawn over time.
    version: u64,
}

impl<'a> ViewContext<'a> {
    /// What there is to read in this frame.
    pub fn new(session: &'a Session, palette: &'a Palette, shown: &'a Shown, axis: &'a TimeAxis) -> Self {
        let mut hasher = DefaultHasher::new();
        (session.generation(), session.run().len(), session.bounds().len(), shown, palette).hash(&mut hasher);
        Self { session, palette, shown, axis, version: hasher.finish() }
    }

    /// Whether any filter has a doubt about a channel, at first or in the end: of others there is nothing to be seen.
    fn in_doubt(&self, channel: Channel) -> bool {
        self.session.run().estimates().iter().any(|estimates| {
            let std = |k: usize| estimates.place(channel).map_or(0.0, |at| estimates.std(k, at));
            !estimates.is_empty() && (std(0) != 0.0 || std(estimates.len() - 1) != 0.0)
        })
    }
}

/// A way to look at a run.
pub trait View: Sync {
    /// Its name in the menu and above it.
    fn name(&self) -> &'static str;

    /// In three lines what is drawn and how to read it.
    fn help(&self) -> [&'static str; 3];

    /// Draws it into all of `ui`. Returns the time that the user points at \[s\].
    fn ui(&self, ui: &mut Ui, context: &ViewContext<'_>, commands: &mut Vec<Command>) -> Option<f64>;
}

/// The views.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ViewKind {
    /// The moving mass.
    Oscillator,
    /// Parameters over time.
    Parameters,
    /// States over time.
    States,
    /// Errors within ±2σ and the Cramér-Rao bound.
    Errors,
    /// Innovations within ±2√S.
    Innovations,
    /// NIS and NEES.
    Consistency,
    /// Autocorrelation of the innovations.
    Autocorrelation,
    /// Kalman gain over time.
    Gain,
    /// Velocity over displacement.
    Phase,
    /// Two parameters with their covariance.
    ParameterPlane,
    /// Frequency response over the force's spectrum.
    FrequencyResponse,
    /// Predict and update in numbers.
    Matrices,
    /// Filters side by side.
    Scores,
}

impl ViewKind {
    /// Every view, in the menu's order.
    pub const ALL: [Self; 13] = [
        Self::Oscillator,
        Self::Parameters,
        Self::States,
        Self::Errors,
        Self::Innovations,
        Self::Consistency,
        Self::Autocorrelation,
        Self::Gain,
        Self::Phase,
        Self::ParameterPlane,
        Self::FrequencyResponse,
        Self::Matrices,
        Self::Scores,
    ];

    /// Whether it is one plot over something else than time, which is best about as high as wide.
    fn is_plane(self) -> bool {
        matches!(self, Self::Autocorrelation | Self::Phase | Self::ParameterPlane | Self::FrequencyResponse)
    }

    /// How deep the diagnostics must be that it shows, if it shows any.
    fn depth(self) -> Option<Depth> {
        match self {
            Self::Consistency => Some(Depth::Consistency),
            Self::Autocorrelation | Self::Scores => Some(Depth::All),
            _ => None,
        }
    }

    /// The view itself.
    pub fn view(self) -> &'static dyn View {
        match self {
            Self::Oscillator => &oscillator::Oscillator,
            Self::Parameters => &channels::Parameters,
            Self::States => &channels::States,
            Self::Errors => &errors::Errors,
            Self::Innovations => &innovations::Innovations,
            Self::Consistency => &consistency::Consistency,
            Self::Autocorrelation => &autocorrelation::Autocorrelation,
            Self::Gain => &gain::Gain,
            Self::Phase => &phase::Phase,
            Self::ParameterPlane => &parameter_plane::ParameterPlane,
            Self::FrequencyResponse => &frequency_response::FrequencyResponse,
            Self::Matrices => &matrices::Matrices,
            Self::Scores => &scores::Scores,
        }
    }
}

/// The least height of a plot where there are many: then they scroll \[points\].
const LEAST_HEIGHT: f32 = 72.0;
/// Height of the time axis, which the last row has \[points\].
const AXIS: f32 = 18.0;
/// Space between rows of plots \[points\].
const GAP: f32 = 6.0;
/// Space between columns of plots \[points\].
const GUTTER: f32 = 16.0;
/// The width from which on plots are in two columns, and the width from which on they are so that they do not become lower
/// than [`LOW`] \[points\].
const TWO_COLUMNS: [f32; 2] = [640.0, 480.0];
/// The height of a plot below which two columns tell more than one \[points\].
const LOW: f32 = 120.0;

/// Fills `ui` with `count` cells in two columns, or one where it is narrow. Tells each cell its number and whether it is in
/// the last row.
fn grid(ui: &mut Ui, count: usize, mut cell_ui: impl FnMut(&mut Ui, usize, bool)) {
    let area = ui.available_size();
    if area.x < 1.0 || area.y < 1.0 || count == 0 {
        return;
    }
    let low = area.y / (count as f32) < LOW;
    let columns = if area.x < TWO_COLUMNS[usize::from(low)] { 1 } else { 2.min(count) };
    let rows = count.div_ceil(columns);
    let gaps = GAP * (rows - 1) as f32;
    let least = if rows <= 2 { 1.0 } else { LEAST_HEIGHT };
    let height = ((area.y - gaps - AXIS) / rows as f32).max(least);
    egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let top = ui.max_rect().min;
        let bar = if height == least { ui.spacing().scroll.bar_width } else { 0.0 };
        let width = ((ui.available_width() - bar - GUTTER * (columns - 1) as f32) / columns as f32).max(1.0);
        for i in 0..count {
            let (row, column) = (i / columns, i % columns);
            let offset = vec2(column as f32 * (width + GUTTER), row as f32 * (height + GAP));
            let axis = if row + 1 == rows { AXIS } else { 0.0 };
            let cell = Rect::from_min_size(top + offset, vec2(width, height + axis));
            let mut child = ui.new_child(egui::UiBuilder::new().id_salt(i).max_rect(cell));
            cell_ui(&mut child, i, row + 1 == rows);
        }
        let all = vec2(ui.available_width(), rows as f32 * height + gaps + AXIS);
        ui.allocate_rect(Rect::from_min_size(top, all), egui::Sense::hover());
    });
}
