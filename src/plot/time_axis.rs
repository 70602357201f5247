//! The common time axis of all plots, and their input.

use crate::ruler::Ruler;
use crate::session::{Mode, Session};
use crate::theme::Palette;
use crate::visibility::Visibility;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeAxis {
    pub follows: bool,
    /// The part of the record that is of interest, `(from, to)` after its start \[s\]; `None` for all of it.
    pub framed: Option<(f64, f64)>,
    pub pointed: Option<f64>,
}

impl Default for TimeAxis {
    fn default() -> Self {
        Self { follows: true, framed: None, pointed: None }
    }
}

/// The past on screen while the record grows; short at first, so that the closing of the bands is visible \[s\].
const LIVE_SPAN: (f64, f64) = (5.2, Session::LIVE_SPAN);

impl TimeAxis {
    pub fn followed(&self, session: &Session) -> (f64, f64) {
        let record = session.run().record();
        let start = record.time_of(0);
        let now = record.time(session.index()) - start;
        let framed = self.framed.filter(|(_, to)| session.mode() == Mode::Whole || now <= *to);
        match (session.mode(), framed) {
            (Mode::Whole, _) | (Mode::Live, Some(_)) => {
                let (from, to) = framed.unwrap_or((0.0, session.end()));
                // A margin, so that the last tick's text is not cut off.
                (start + from, start + to + 0.03 * (to - from))
            }
            (Mode::Live, None) => {
                // A margin, so that the newest estimate does not touch the frame.
                let ahead = now + 0.6;
                let span = ahead.clamp(LIVE_SPAN.0, LIVE_SPAN.1).min(session.end() + 0.6);
                let to = start + ahead.max(span);
                (to - span, to)
            }
        }
    }

    pub fn readout(&self, session: &Session) -> usize {
        self.pointed.map_or_else(|| session.index(), |time| session.sample_at(time))
    }

    pub fn shown_time(&self, session: &Session) -> f64 {
        session.run().record().time(self.readout(session))
    }
}

#[derive(Clone, Copy)]
pub(crate) struct PlotInput<'a> {
    pub(crate) session: &'a Session,
    pub(crate) palette: &'a Palette,
    pub(crate) visible: &'a Visibility,
    pub(crate) axis: &'a TimeAxis,
    pub(crate) ruler: &'a Ruler,
    pub(crate) version: u64,
}
