//! Everything that plots over time read.

use crate::plot::time_axis::TimeAxis;
use crate::session::Session;
use crate::theme::Palette;

/// The context of a chart, besides its own layers.
#[derive(Clone, Copy)]
pub(crate) struct PlotInput<'a> {
    /// The record, and where playback stands in it.
    pub(crate) session: &'a Session,
    /// The colours of the theme.
    pub(crate) palette: &'a Palette,
    /// The common time axis.
    pub(crate) axis: &'a TimeAxis,
    /// A number that changes with everything that is drawn over time: drawings of another version are stale.
    pub(crate) version: u64,
}
