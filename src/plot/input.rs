//! The input of plots over time.

use crate::plot::time_axis::TimeAxis;
use crate::ruler::Ruler;
use crate::session::Session;
use crate::theme::Palette;
use crate::visibility::Visibility;

#[derive(Clone, Copy)]
pub(crate) struct PlotInput<'a> {
    pub(crate) session: &'a Session,
    pub(crate) palette: &'a Palette,
    pub(crate) visible: &'a Visibility,
    pub(crate) axis: &'a TimeAxis,
    pub(crate) ruler: &'a Ruler,
    pub(crate) version: u64,
}
