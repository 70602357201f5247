//! A record that is measured while it is on screen.

use std::sync::Arc;

use kalmanscope_core::import::{Mapping, hash, read};
use kalmanscope_core::{Record, Scenario};

use super::{Mode, RecordFile, Session};

impl Session {
    pub fn follow_live(&mut self, scenario: Scenario, record: Arc<Record>) {
        if let Some(mapping) = &scenario.record {
            self.library.set_live(mapping.clone(), record);
        }
        self.wanted_mode = Mode::Live;
        self.set_scenario(scenario);
        self.playing = true;
    }

    /// Takes in the longer record and shows its end, unless time stands still or another scenario is on screen.
    pub fn lengthen(&mut self, record: Arc<Record>) {
        self.library.lengthen(record);
        self.compute();
    }

    /// Ends the live record on screen, if any: from now on it is a measured one with this name. Returns its bytes.
    pub fn end_live(&mut self, name: &str) -> Option<Vec<u8>> {
        let record = self.library.end_live().filter(|_| self.is_live())?;
        let mut bytes = Vec::new();
        record.write_csv(&mut bytes).ok()?;
        let table = read(bytes.clone(), None).ok()?;
        let (mut mapping, _) = Mapping::guess(&table);
        // Q is that of a step: the steps stay as they are.
        mapping.time.dt = record.clocks().map(|_| record.dt());
        let file = RecordFile { name: name.to_owned(), hash: hash(&bytes), table };
        let record = Some(Mapping { file: name.to_owned(), hash: file.hash.clone(), ..mapping });
        self.library.insert(Arc::new(file));
        self.pause();
        self.set_scenario(Scenario { record, ..(*self.scenario).clone() });
        Some(bytes)
    }

    pub fn is_live(&self) -> bool {
        self.run().is_live()
    }

    pub(super) fn catch_up(&mut self) {
        let Some(record) = self.library.live().filter(|_| self.run().is_live()) else { return };
        if record.len() != self.run().record().len() && !self.study.lengthen(Arc::clone(record)) {
            self.begin_job();
            return;
        }
        if self.playing {
            self.clock = self.end();
        }
    }
}

#[cfg(test)]
mod tests {
    use kalmanscope_core::record::LiveRecord;
    use kalmanscope_core::{Hold, InputKind, Quantity};

    use super::*;

    fn begun(hold: Hold) -> (Session, Scenario, LiveRecord) {
        let mut scenario = Scenario { dt: 0.01, hold, ..Scenario::default() };
        scenario.set_sensors(&[Quantity::DISPLACEMENT]);
        scenario.record = Some(Mapping { file: "now".to_owned(), ..Mapping::default() });
        let live = LiveRecord::new(0.01, InputKind::Force, hold, vec![Quantity::DISPLACEMENT]);
        (Session::new(Scenario::default()).expect("it can be run"), scenario, live)
    }

    #[test]
    fn a_record_that_ends_keeps_its_times_and_its_steps() {
        for hold in [Hold::Zero, Hold::First] {
            let (mut session, scenario, mut live) = begun(hold);
            for k in 0..300 {
                let time = 0.1 * f64::from(k) + 0.03 * f64::from(k).sin();
                live.take(time, time.sin(), &[0.01 * (6.0 * time).cos()]).expect("it is taken in");
            }
            session.follow_live(scenario, live.so_far());
            session.advance(0.0);
            assert!(session.is_live());
            session.end_live("measured.csv").expect("it becomes a file");
            session.advance(0.0);
            let (before, after) = (live.record(), session.run().record());
            assert!(!session.is_live() && (after.dt() - 0.01).abs() < 1e-12, "{hold:?}: {}", after.dt());
            let [before, after] =
                [before, after].map(|record| record.clocks().expect("it has times").readings[0].clone());
            assert!(after.times.len() > 290 && after.times.len() <= before.times.len());
            let first = before.values.iter().position(|value| *value == after.values[0]).expect("it is among them");
            for k in 1..after.times.len() {
                assert_eq!(after.values[k], before.values[first + k]);
                let apart = [&after.times[k..], &before.times[first + k..]].map(|times| times[0]);
                let since = [after.times[0], before.times[first]];
                assert!(((apart[0] - since[0]) - (apart[1] - since[1])).abs() < 1e-6, "{hold:?} {k}");
            }
        }
    }

    /// A long record must not be copied for each frame: nobody keeps the one of the frame before.
    #[test]
    fn a_record_that_grows_on_screen_is_not_copied() {
        let (mut session, scenario, mut live) = begun(Hold::Zero);
        let mut record = live.so_far();
        session.follow_live(scenario, Arc::clone(&record));
        for k in 0..2000 {
            let time = 0.01 * f64::from(k);
            live.take(time, time.sin(), &[0.01 * (6.0 * time).cos()]).expect("it is taken in");
            let before = Arc::downgrade(&record);
            if live.update(&mut record) {
                session.lengthen(Arc::clone(&record));
                session.advance(0.01);
                assert_eq!(session.run().record().len(), record.len());
                assert!(k < 10 || before.strong_count() == 1, "{k}: the live record alone keeps the one before");
            }
        }
        assert!(session.run().record().len() > 1990);
    }
}
