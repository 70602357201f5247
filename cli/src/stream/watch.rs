//! Whether the innovations of the last readings are as large as a filter expects.

use std::collections::VecDeque;

use kalmanscope_core::Sample;
use kalmanscope_core::diagnostics::chi_squared;

/// The updates that are looked at, and how many there must be.
const WINDOW: usize = 200;
const LEAST: usize = 20;

/// NIS and readings of the last updates.
#[derive(Clone, Debug, Default)]
pub(super) struct Watch {
    last: VecDeque<(f64, u32)>,
    nis: f64,
}

impl Watch {
    /// Looks at a sample.
    pub(super) fn look(&mut self, sample: &Sample<'_>) {
        self.nis = sample.nis;
        let readings = sample.readings();
        if readings == 0 || !sample.nis.is_finite() {
            return;
        }
        self.last.push_back((sample.nis, readings));
        if self.last.len() > WINDOW {
            self.last.pop_front();
        }
    }

    /// NIS of the last sample; NaN if it has no readings.
    pub(super) fn nis(&self) -> f64 {
        self.nis
    }

    /// The verdict on the last updates in words: their mean NIS against its 95 % interval.
    pub(super) fn verdict(&self) -> &'static str {
        if self.last.len() < LEAST {
            return "too few readings";
        }
        let sum: f64 = self.last.iter().map(|(nis, _)| nis).sum();
        let degrees = self.last.iter().map(|(_, readings)| readings).sum();
        match chi_squared::interval(degrees, 1) {
            Some(usual) if sum > *usual.end() => "innovations larger than expected",
            Some(usual) if sum < *usual.start() => "innovations smaller than expected",
            Some(_) => "innovations as expected",
            None => "too few readings",
        }
    }
}
