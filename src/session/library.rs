//! The files that scenarios name, and the records that are made of them.

use std::sync::Arc;

use kalmanscope_core::import::{Imported, Mapping, Table, build, hash, read};
use kalmanscope_core::{Hold, InputKind, Record, Scenario, Source};
use kalmanscope_lessons::records;

use super::Session;

/// Limits the records that are kept in addition to the one on screen, so that switching back takes no time.
const KEPT: usize = 3;

#[derive(Clone, Debug, PartialEq)]
pub struct RecordFile {
    pub name: String,
    pub hash: String,
    pub table: Table,
}

#[derive(Default)]
pub struct Library {
    files: Vec<Arc<RecordFile>>,
    made: Vec<CachedRecord>,
    pub reasons: Vec<String>,
    pub problem: Option<String>,
    held_out: Option<(String, Arc<Record>)>,
    live: Option<LiveRecording>,
}

struct LiveRecording {
    mapping: Mapping,
    record: Arc<Record>,
    has_ended: bool,
}

struct CachedRecord {
    mapping: Mapping,
    input: InputKind,
    hold: Hold,
    record: Arc<Record>,
    remarks: Vec<String>,
}

impl Library {
    pub fn insert(&mut self, file: Arc<RecordFile>) {
        self.files.retain(|other| other.hash != file.hash);
        self.files.push(file);
    }

    pub fn file(&self, mapping: &Mapping) -> Option<&Arc<RecordFile>> {
        let by_hash = self.files.iter().find(|file| file.hash == mapping.hash);
        by_hash.or_else(|| self.files.iter().find(|file| mapping.hash.is_empty() && file.name == name_of(mapping)))
    }

    fn fetch_built_in(&mut self, mapping: &Mapping) {
        if self.file(mapping).is_some() {
            return;
        }
        let Some(bytes) = records::record(mapping) else { return };
        // A test reads each of them.
        let hash = hash(&bytes);
        if let Ok(table) = read(bytes, mapping.dialect) {
            self.insert(Arc::new(RecordFile { name: mapping.file.clone(), hash, table }));
        }
    }

    pub fn source(&mut self, scenario: &Scenario) -> Result<Source, String> {
        let Some(mapping) = &scenario.record else { return Ok(Source::Simulated) };
        if let Some(live) = self.live.as_ref().filter(|live| live.mapping == *mapping) {
            let record = Arc::clone(&live.record);
            return Ok(if live.has_ended { Source::Measured(record) } else { Source::Live(record) });
        }
        let is_same =
            |one: &CachedRecord| one.mapping == *mapping && one.input == scenario.input && one.hold == scenario.hold;
        if let Some(place) = self.made.iter().position(is_same) {
            let made = self.made.remove(place);
            let record = Arc::clone(&made.record);
            self.made.push(made);
            return Ok(Source::Measured(record));
        }
        self.fetch_built_in(mapping);
        let name = name_of(mapping);
        let file = self
            .file(mapping)
            .ok_or_else(|| format!("the record “{name}” is not here: drop the file on the window"))?;
        let built = built(file, mapping, scenario)?;
        let samples = built.record.len();
        if samples > Session::LONGEST_WHOLE + 1 {
            return Err(format!(
                "“{name}” has {samples} samples, and {} are shown at most: choose a part, or keep fewer of them",
                Session::LONGEST_WHOLE
            ));
        }
        let record = Arc::new(built.record);
        let (mapping, input, hold) = (mapping.clone(), scenario.input, scenario.hold);
        self.made.push(CachedRecord { mapping, input, hold, record: Arc::clone(&record), remarks: built.remarks });
        if self.made.len() > KEPT + 1 {
            self.made.remove(0);
        }
        Ok(Source::Measured(record))
    }

    pub(super) fn missing<'a>(&self, scenario: &'a Scenario) -> Option<&'a str> {
        let mapping = scenario.record.as_ref()?;
        let is_live = self.live.as_ref().is_some_and(|live| live.mapping == *mapping);
        (!is_live && self.file(mapping).is_none()).then(|| name_of(mapping))
    }

    pub(super) fn live(&self) -> Option<&Arc<Record>> {
        self.live.as_ref().filter(|live| !live.has_ended).map(|live| &live.record)
    }

    pub(super) fn set_live(&mut self, mapping: Mapping, record: Arc<Record>) {
        self.live = Some(LiveRecording { mapping, record, has_ended: false });
    }

    pub(super) fn lengthen(&mut self, record: Arc<Record>) {
        if let Some(live) = self.live.as_mut().filter(|live| !live.has_ended) {
            live.record = record;
        }
    }

    pub(super) fn end_live(&mut self) -> Option<Arc<Record>> {
        let live = self.live.as_mut().filter(|live| !live.has_ended)?;
        live.has_ended = true;
        Some(Arc::clone(&live.record))
    }

    pub fn held_out(&self) -> Option<(&str, &Arc<Record>)> {
        self.held_out.as_ref().map(|(name, record)| (name.as_str(), record))
    }

    pub(super) fn hold_out(&mut self, file: &RecordFile, scenario: &Scenario) -> Result<(), String> {
        let Some(mapping) = &scenario.record else { return Err("there is no measured record to test".to_owned()) };
        // The part was chosen by the times of the other file.
        let mapping = Mapping { from: None, to: None, ..mapping.clone() };
        self.held_out = Some((file.name.clone(), Arc::new(built(file, &mapping, scenario)?.record)));
        Ok(())
    }

    pub fn remarks(&self, record: &Record) -> &[String] {
        let made = self.made.iter().find(|made| std::ptr::eq(&raw const *made.record, record));
        made.map_or(&[], |made| &made.remarks)
    }
}

fn built(file: &RecordFile, mapping: &Mapping, scenario: &Scenario) -> Result<Imported, String> {
    let built = build(&file.table, mapping, scenario.input, scenario.hold, scenario.plant.kind.channels());
    built.map_err(|error| format!("“{}”: {error}", file.name))
}

pub fn name_of(mapping: &Mapping) -> &str {
    mapping.file.rsplit(['/', '\\']).next().unwrap_or_default()
}

pub(crate) fn is_same(a: &Source, b: &Source) -> bool {
    match (a, b) {
        (Source::Simulated, Source::Simulated) => true,
        (Source::Measured(a), Source::Measured(b)) | (Source::Live(a), Source::Live(b)) => Arc::ptr_eq(a, b),
        _ => false,
    }
}
