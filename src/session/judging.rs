//! Whether the filters are to be believed, as far as the record has come.

use kalmanscope_core::{Diagnosis, LiveDiagnosis};

use super::Session;

/// Limits how often diagnoses of a growing record are made anew, in real time \[s\].
const EVERY: f64 = 0.3;

/// Limits the samples of a diagnosis of a growing record.
const MOST: usize = 20_000;

/// The diagnoses of a record that still grows.
#[derive(Default)]
pub(super) struct Judged {
    diagnoses: Vec<Option<Diagnosis>>,
    /// The sums of each filter, which the next diagnosis uses again if the picture has the same number.
    live: Vec<LiveDiagnosis>,
    /// The picture's number and the samples that were done.
    of: Option<(u64, usize)>,
    /// Real time since then \[s\].
    age: f64,
}

impl Session {
    /// Limits the time that live plots show \[s\].
    pub const LIVE_SPAN: f64 = 20.0;

    /// The diagnosis of the filter at a place: over the whole record, or over the time on screen and a moment old while the
    /// record grows. None where it is not known, or not wanted.
    pub fn diagnosis(&self, place: usize) -> Option<&Diagnosis> {
        if self.is_whole() {
            return self.study.analysis().diagnosis(place);
        }
        self.judged.diagnoses.get(place)?.as_ref()
    }

    /// Makes the diagnoses of a growing record anew, where it is time for that.
    pub(super) fn judge(&mut self, elapsed: f64) {
        self.judged.age += elapsed;
        let (run, diagnostics) = (self.study.run(), self.study.analysis().diagnostics());
        if self.is_whole() || self.job.is_some() || !self.complete {
            return;
        }
        let now = (self.generation, run.done());
        let is_due = match self.judged.of {
            Some(before) if before == now => false,
            Some((generation, _)) if self.playing && generation == now.0 => self.judged.age >= EVERY,
            _ => true,
        };
        if is_due {
            let on_screen = (Self::LIVE_SPAN / run.record().dt()).ceil() as usize;
            let from = run.len().saturating_sub(on_screen.min(MOST));
            let live = &mut self.judged.live;
            if self.judged.of.is_none_or(|(generation, _)| generation != now.0) {
                live.clear();
            }
            live.resize_with(run.estimates().len(), LiveDiagnosis::default);
            let of = |((estimates, diagnostics), live): ((_, _), &mut LiveDiagnosis)| {
                live.over(from..run.len(), diagnostics, estimates, run.record(), None)
            };
            self.judged.diagnoses = run.estimates().iter().zip(diagnostics).zip(live).map(of).collect();
            (self.judged.of, self.judged.age) = (Some(now), 0.0);
        }
    }

    /// Whether the record no longer grows: its analysis has the diagnoses.
    fn is_whole(&self) -> bool {
        self.run().done() == self.run().samples()
    }
}
