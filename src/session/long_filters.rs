//! Long filters of the next picture, which a team computes beside the frames.

use std::rc::Rc;

use egui::Context;
use kalmanscope_core::Tape;
use kalmanscope_diagnosis::{Job, Study};

use super::Session;
use crate::team::{BETWEEN, Handle, Lost, Team};

/// Limits the time of a filter that is computed in the frames, over the whole record on an ordinary processor \[s\].
const LONG: f64 = 0.3;

#[derive(Default)]
pub(super) struct LongFilters {
    filters: Vec<(usize, Option<Handle<Tape>>)>,
    is_alone: bool,
}

impl LongFilters {
    pub(super) fn end(&mut self) {
        self.filters.clear();
        self.is_alone = false;
    }

    pub(super) fn begin(&mut self, job: &mut Job, team: &dyn Team) {
        self.end();
        if team.is_beside() {
            self.filters = job.leave_long(LONG).into_iter().map(|place| (place, None)).collect();
        }
    }

    pub(super) fn follow(
        &mut self,
        job: &mut Job,
        study: &Study,
        team: &dyn Team,
        while_time: &mut dyn FnMut() -> bool,
    ) {
        let Self { filters, .. } = self;
        if filters.iter().any(|(_, work)| work.is_none()) {
            let Some(record) = job.whole_record(study) else { return };
            for (place, work) in filters.iter_mut() {
                *work = team.filter(job.scenario(), *place, record);
            }
        }
        let is_lost = filters.iter_mut().any(|(place, work)| {
            while while_time() {
                match work.as_mut().map_or(Err(Lost), Handle::take) {
                    Ok(Some(tape)) if job.take(*place, &tape) => {}
                    Ok(None) => break,
                    _ => return true,
                }
            }
            false
        });
        if is_lost {
            self.end();
            job.take_back();
        }
    }

    pub(super) fn set_alone(&mut self, has_time: bool) {
        self.is_alone = has_time && self.filters.iter().any(|(_, work)| work.is_some());
    }
}

impl Session {
    pub fn work_with(&mut self, team: Rc<dyn Team>) {
        self.team = team;
        if self.job.is_some() {
            self.begin_job();
        }
    }

    pub(crate) fn team(&self) -> &Rc<dyn Team> {
        &self.team
    }

    fn only_waits(&self) -> bool {
        self.job.is_some() && self.long.is_alone && !self.waiting
    }

    pub(crate) fn ask_for_frame(&self, ctx: &Context) {
        // While only threads work, frames have nothing to do but to show the progress.
        if self.only_waits() {
            ctx.request_repaint_after(BETWEEN);
        } else if self.playing() && !self.is_live() || self.behind() {
            ctx.request_repaint();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use kalmanscope_core::{FilterKind, FilterSettings, Pass, Record, Scenario, Tape};

    use super::*;
    use crate::session::{Budget, Mode};

    #[derive(Clone)]
    struct Fake {
        started: Rc<Cell<usize>>,
        under_way: Rc<Cell<usize>>,
        portions: usize,
    }

    struct UnderWay(Rc<Cell<usize>>);

    impl Drop for UnderWay {
        fn drop(&mut self) {
            self.0.set(self.0.get() - 1);
        }
    }

    impl Team for Fake {
        fn is_beside(&self) -> bool {
            true
        }

        fn filter(&self, scenario: &Scenario, place: usize, record: &Record) -> Option<Handle<Tape>> {
            self.started.set(self.started.get() + 1);
            self.under_way.set(self.under_way.get() + 1);
            let under_way = UnderWay(Rc::clone(&self.under_way));
            let mut pass = Pass::new(scenario, place, record).ok()?;
            let (record, mut portions) = (record.clone(), self.portions);
            Some(Handle::new(move || {
                let _ = &under_way;
                portions = portions.checked_sub(1).ok_or(Lost)?;
                if portions % 2 == 1 {
                    return Ok(None);
                }
                let mut tape = Tape::default();
                pass.follow(&record, pass.done() + 500, &mut tape);
                Ok(Some(tape))
            }))
        }
    }

    fn scenario() -> Scenario {
        let mut scenario = Scenario { duration: 40.0, ..Scenario::default() };
        scenario.filters.truncate(1);
        let particles = FilterSettings { kind: FilterKind::PF, ensemble_size: 1000, ..scenario.filters[0].clone() };
        scenario.filters.push(FilterSettings { id: 0, name: "PF".to_owned(), ..particles });
        scenario
    }

    fn session(portions: usize) -> (Session, Fake) {
        let fake = Fake { started: Rc::default(), under_way: Rc::default(), portions };
        let mut session = Session::new(scenario()).unwrap();
        session.pause();
        session.set_budget(Budget::Pieces(4));
        session.work_with(Rc::new(fake.clone()));
        session.set_mode(Mode::Whole);
        (session, fake)
    }

    fn wait(session: &mut Session) -> usize {
        let frame = |_| {
            session.advance(0.1);
            session.behind().then(|| usize::from(session.only_waits()))
        };
        (0..100_000).map_while(frame).sum()
    }

    fn assert_right(session: &Session) {
        let mut at_once = Session::new(session.scenario().clone()).unwrap();
        at_once.set_mode(Mode::Whole);
        assert!(!session.behind() && session.run().scenario() == session.scenario());
        assert_eq!(session.run().checksum(), at_once.run().checksum());
    }

    #[test]
    fn a_long_filter_is_computed_by_the_team_and_a_cheap_one_here() {
        let (mut session, fake) = session(1000);
        let mut shares = vec![session.progress().unwrap()];
        while let Some(share) = session.progress() {
            shares.push(share);
            session.advance(0.1);
        }
        assert!(shares.len() > 5 && shares.is_sorted(), "{shares:?}");
        assert_right(&session);
        assert_eq!((fake.started.get(), fake.under_way.get()), (1, 0));
        // A cheap edit does not compute it again.
        let mut edited = session.scenario().clone();
        edited.filters[0].fading = 1.01;
        session.set_scenario(edited);
        wait(&mut session);
        assert_right(&session);
        assert_eq!(fake.started.get(), 1);
    }

    #[test]
    fn frames_wait_while_nothing_else_is_left() {
        let (mut session, _) = session(1000);
        session.set_budget(Budget::FRAME);
        assert!(wait(&mut session) > 1);
        assert!(!session.only_waits());
    }

    #[test]
    fn an_edit_and_a_cancel_end_the_work() {
        let (mut session, fake) = session(1000);
        (0..8).for_each(|_| session.advance(0.1));
        assert_eq!((fake.started.get(), fake.under_way.get()), (1, 1));
        let edited = Scenario { seed: 7, ..session.scenario().clone() };
        session.set_scenario(edited);
        assert!(session.behind() && fake.under_way.get() == 0);
        wait(&mut session);
        assert_right(&session);
        assert_eq!((session.run().scenario().seed, fake.under_way.get()), (7, 0));
        session.set_scenario(Scenario { seed: 8, ..session.scenario().clone() });
        (0..8).for_each(|_| session.advance(0.1));
        assert!(fake.under_way.get() == 1 && session.cancel());
        assert_eq!((session.run().scenario().seed, fake.under_way.get()), (7, 0));
    }

    #[test]
    fn a_team_that_fails_leaves_the_work_to_the_frames() {
        for portions in [0, 1, 5] {
            let (mut session, fake) = session(portions);
            wait(&mut session);
            assert_right(&session);
            assert_eq!((fake.started.get(), fake.under_way.get()), (1, 0));
        }
    }
}
