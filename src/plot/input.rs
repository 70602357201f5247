//! The input of plots over time.

use crate::plot::time_axis::TimeAxis;
use crate::ruler::Ruler;
use crate::session::Session;
use crate::theme::Palette;
use crate::visibility::Visibility;

/// The context of a chart, without its own layers.
#[derive(Clone, Copy)]
pub(crate) struct PlotInput<'a> {
    pub(crate) session: &'a Session,
    pub(crate) palette: &'a Palette,
    pub(crate) visible: &'a Visibility,
    pub(crate) axis: &'a TimeAxis,
    pub(crate) ruler: &'a Ruler,
    /// A version number of everything that is drawn over time; drawings of another version are outdated.
    pub(crate) version: u64,
}
