//! The spectrogram of the first sensor, over the samples that are done.

use kalmanscope_core::{Spectrogram, Task as _, Work};

use super::Session;
use crate::team::{Priority, RunningTask};

const EVERY: usize = 200;

type SpectrogramKey = (u64, usize);

#[derive(Default)]
pub(super) struct Spectrograms {
    is_wanted: bool,
    /// `None` in it if there were too few samples.
    made: Option<(SpectrogramKey, Option<Spectrogram>)>,
    next: Option<(SpectrogramKey, RunningTask<Work<Spectrogram>>)>,
}

impl Session {
    pub fn want_spectrogram(&mut self, is_wanted: bool) {
        self.spectrograms.is_wanted = is_wanted;
    }

    pub fn spectrogram(&self) -> Option<(SpectrogramKey, &Spectrogram)> {
        let (of, spectrogram) = self.spectrograms.made.as_ref()?;
        Some((*of, spectrogram.as_ref()?))
    }

    pub fn is_spectrogram_behind(&self) -> bool {
        self.spectrograms.next.is_some()
    }

    pub(crate) fn is_spectrogram_behind_here(&self) -> bool {
        self.spectrograms.next.as_ref().is_some_and(|(_, next)| !next.is_beside())
    }

    pub(super) fn follow_spectrogram(&mut self) {
        if !self.spectrograms.is_wanted {
            self.spectrograms.next = None;
            return;
        }
        let run = self.study.run();
        // While a record grows, each frame has more samples; a new spectrogram for each would never be complete.
        let of = (self.generation, run.len() / EVERY);
        let Spectrograms { made, next, .. } = &mut self.spectrograms;
        // One of fewer samples is shown before the next begins.
        if next.as_ref().is_some_and(|(next, _)| next.0 != of.0) {
            *next = None;
        }
        if next.is_none() && made.as_ref().is_none_or(|(made, _)| *made != of) {
            let has_sensor = !run.record().sensors().is_empty();
            match has_sensor.then(|| Spectrogram::windows(run.record(), 0, run.len())).flatten() {
                Some(windows) => {
                    *next = Some((of, RunningTask::begin(&*self.team, Priority::Hand, windows, Work::progress)));
                }
                None => *made = Some((of, None)),
            }
        }
        if let Some((of, running)) = next
            && let Some(ended) = running.advance(&mut self.budget.slice()).transpose()
        {
            *made = Some((*of, ended.ok()));
            *next = None;
            self.drawn += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use kalmanscope_core::Scenario;

    use super::*;
    use crate::session::{Budget, Mode};

    #[test]
    fn a_spectrogram_is_made_in_slices_and_the_last_one_stays() {
        let mut session = Session::new(Scenario { duration: 40.0, ..Scenario::default() }).unwrap();
        session.set_mode(Mode::Whole);
        session.set_budget(Budget::Pieces(2));
        session.advance(0.0);
        assert!(session.spectrogram().is_none(), "nobody wants one");
        session.want_spectrogram(true);
        let mut slices = 0;
        while session.spectrogram().is_none() {
            session.advance(0.0);
            slices += 1;
        }
        assert!(slices > 20 && !session.is_spectrogram_behind_here(), "{slices}");
        let (of, made) = session.spectrogram().unwrap();
        assert_eq!(
            Some(made),
            Spectrogram::windows(session.run().record(), 0, session.run().len())
                .map(kalmanscope_core::Task::run)
                .as_ref()
        );
        session.set_scenario(Scenario { seed: 7, ..session.scenario().clone() });
        while session.behind() {
            session.advance(0.0);
        }
        assert_eq!(session.spectrogram().unwrap().0, of);
        while session.spectrogram().unwrap().0 == of {
            session.advance(0.0);
        }
    }
}
