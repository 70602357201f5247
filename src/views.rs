//! What is drawn: one view a file, each a function of an immutable context.

pub mod axis;
pub mod legend;
pub mod oscillator;
pub mod time_plot;

use egui::{Rect, Ui, vec2};
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

/// The least height of a plot \[points\]: where there are so many that they would be lower, they scroll.
const LEAST_HEIGHT: f32 = 96.0;

/// Fills the rest of `ui` with a plot for each channel, the parameters first, as their convergence is the story: in two
/// columns, or one below the other where it is narrow.
pub fn plots_ui(ui: &mut Ui, context: &ViewContext<'_>, commands: &mut Vec<Command>) {
    let area = ui.available_rect_before_wrap();
    if area.width() < 1.0 || area.height() < 1.0 {
        return;
    }
    let channels = context.session.run().channels();
    let (parameters, motion): (Vec<Channel>, Vec<Channel>) = channels.into_iter().partition(|c| c.is_parameter());
    let columns = if area.width() < 640.0 { 1 } else { 2 };
    let rows: Vec<&[Channel]> = parameters.chunks(columns).chain(motion.chunks(columns)).collect();
    let gaps = GAP * rows.len().saturating_sub(1) as f32;
    let least = if rows.len() <= 4 { 1.0 } else { LEAST_HEIGHT };
    let height = ((area.height() - gaps) / rows.len().max(1) as f32).max(least);
    let mut pointed = None;
    egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let top = ui.max_rect().min;
        let width = ((ui.available_width() - GUTTER * (columns - 1) as f32) / columns as f32).max(1.0);
        for (row, channels) in rows.iter().enumerate() {
            for (column, &channel) in channels.iter().enumerate() {
                let offset = vec2(column as f32 * (width + GUTTER), row as f32 * (height + GAP));
                let cell = Rect::from_min_size(top + offset, vec2(width, height));
                let mut child = ui.new_child(egui::UiBuilder::new().id_salt(channel.key()).max_rect(cell));
                pointed = time_plot::time_plot_ui(&mut child, channel, context, commands).or(pointed);
            }
        }
        let all = vec2(ui.available_width(), rows.len() as f32 * height + gaps);
        ui.allocate_rect(Rect::from_min_size(top, all), egui::Sense::hover());
    });
    if pointed != context.axis.pointed {
        commands.push(Command::PointAt(pointed));
    }
}

/// Space between rows of plots \[points\].
const GAP: f32 = 6.0;
/// Space between columns of plots \[points\].
const GUTTER: f32 = 16.0;
