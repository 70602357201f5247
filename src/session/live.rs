//! A record that is measured while it is on screen.

use std::sync::Arc;

use kalmanscope_core::import::{Mapping, hash, read};
use kalmanscope_core::{Record, Scenario};

use super::{Mode, RecordFile, Session};

impl Session {
    /// Shows a record that is still being measured, under the scenario that names it, and follows its end.
    pub fn follow_live(&mut self, scenario: Scenario, record: Arc<Record>) {
        if let Some(mapping) = &scenario.record {
            self.library.set_live(mapping.clone(), record);
        }
        self.wanted_mode = Mode::Live;
        self.set_scenario(scenario);
        self.playing = true;
    }

    /// Takes in the live record, which has become longer, and shows its end unless time stands still. While another scenario
    /// is on screen, it grows unseen.
    pub fn lengthen(&mut self, record: Arc<Record>) {
        self.library.lengthen(record);
        self.compute();
    }

    /// Says that nothing is added to the live record any more. It is a measured record from now on, of a file with this name,
    /// whose bytes are returned. `None` if no live record is on screen.
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
        self.set_scenario(Scenario { record, ..self.scenario.clone() });
        Some(bytes)
    }

    /// Whether the record on screen is still being measured.
    pub fn is_live(&self) -> bool {
        self.run().is_live()
    }

    /// Takes in what has been measured since. Where the record is another one, the run begins again.
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
