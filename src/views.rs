//! What is drawn: one view a file, each a function of an immutable context.

pub mod axis;
pub mod legend;
pub mod oscillator;
pub mod time_plot;

use egui::Ui;
use kalmanscope_core::Channel;

use crate::command::Command;
use crate::session::Session;
use crate::theme::Palette;

pub use axis::TimeAxis;
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
}

/// The channels whose plots stand in the centre, the parameters first: their convergence is the story.
const PLOTS: [Channel; 4] =
    [Channel::NaturalFrequency, Channel::DampingRatio, Channel::Displacement, Channel::Velocity];

/// Share of the height that the row of the parameters' plots has beside the row of the motion's.
const PARAMETERS_SHARE: f32 = 0.54;

/// Fills the rest of `ui` with the plots: two by two, or one below the other where it is narrow.
pub fn plots_ui(ui: &mut Ui, context: &ViewContext<'_>, commands: &mut Vec<Command>) {
    let area = ui.available_rect_before_wrap();
    if area.width() < 1.0 || area.height() < 1.0 {
        return;
    }
    let gap = 6.0;
    let gutter = 16.0;
    let narrow = area.width() < 640.0;
    let mut pointed = None;
    for (i, channel) in PLOTS.into_iter().enumerate() {
        let cell = if narrow {
            let height = ((area.height() - 3.0 * gap) / 4.0).max(1.0);
            egui::Rect::from_min_size(
                area.min + egui::vec2(0.0, i as f32 * (height + gap)),
                egui::vec2(area.width(), height),
            )
        } else {
            let width = ((area.width() - gutter) / 2.0).max(1.0);
            let first_row = (area.height() - gap) * PARAMETERS_SHARE;
            let (top, height) =
                if i < 2 { (0.0, first_row) } else { (first_row + gap, area.height() - gap - first_row) };
            egui::Rect::from_min_size(
                area.min + egui::vec2((i % 2) as f32 * (width + gutter), top),
                egui::vec2(width, height.max(1.0)),
            )
        };
        let mut child = ui.new_child(egui::UiBuilder::new().id_salt(channel.key()).max_rect(cell));
        pointed = time_plot::time_plot_ui(&mut child, channel, context, commands).or(pointed);
    }
    if pointed != context.axis.pointed {
        commands.push(Command::PointAt(pointed));
    }
    ui.allocate_rect(area, egui::Sense::hover());
}
