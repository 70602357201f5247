//! The input of plots over time.

use crate::plot::time_axis::TimeAxis;
use crate::ruler::Ruler;
use crate::session::Session;
use crate::theme::Palette;
use crate::visibility::Visibility;

/// The context of a chart, without its own layers.
#[derive(Clone, Copy)]
pub(crate) struct PlotInput<'a> {
    /// The record and the position of playback.
    pub(crate) session: &'a Session,
    /// The colours of the theme.
    pub(crate) palette: &'a Palette,
    /// The entries of the legend that are shown.
    pub(crate) visible: &'a Visibility,
    /// The common time axis.
    pub(crate) axis: &'a TimeAxis,
    /// The marked times.
    pub(crate) ruler: &'a Ruler,
    /// A version number of everything that is drawn over time; drawings of another version are outdated.
    pub(crate) version: u64,
}
