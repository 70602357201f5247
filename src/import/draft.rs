//! The meaning of a file's columns while the user chooses it.

use std::sync::Arc;

use kalmanscope_core::free_decay::Ring;
use kalmanscope_core::import::{ColumnGuess, ImportError, Imported, MappedColumn, Mapping, Time, building};
use kalmanscope_core::suggest::scenario_for;
use kalmanscope_core::{ForcedMass, Hold, InputKind, PlantKind, Quantity, Scenario, Task as _, Work};

use super::{ImportSettings, SharedFile};
use crate::session::{RecordFile, Session};
use crate::spark::Spark;

pub struct Draft {
    pub file: Arc<RecordFile>,
    pub mapping: Mapping,
    pub input: InputKind,
    pub hold: Hold,
    pub plant: PlantKind,
    pub suggest: bool,
    pub(super) remark: Option<String>,
    pub(super) base: Option<Scenario>,
    pub(super) sparks: Vec<Spark>,
    pub(super) guesses: Vec<ColumnGuess>,
    pub(super) is_unfolded: bool,
    outcome: Option<(ImportSettings, Result<Imported, String>)>,
    making: Option<(ImportSettings, Work<Result<Imported, ImportError>>)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnRole {
    Unused,
    Time,
    Input,
    ForceOn(ForcedMass),
    Sensor(Quantity),
}

impl Draft {
    pub fn new(file: Arc<RecordFile>) -> Self {
        let (mut mapping, input, guesses) = Mapping::guess_for(&file.table, &[]);
        let remark = Ring::choose(&file.table, &mut mapping);
        (mapping.file, mapping.hash) = (file.name.clone(), file.hash.clone());
        let sparks = file.table.columns.iter().map(|column| Spark::new(&column.values)).collect();
        let draft = Self {
            remark,
            file,
            mapping,
            input,
            hold: Hold::First,
            plant: PlantKind::SDOF,
            suggest: true,
            base: None,
            sparks,
            guesses,
            is_unfolded: false,
            outcome: None,
            making: None,
        };
        Self { is_unfolded: !draft.doubts().is_empty(), ..draft }
    }

    pub fn of_scenario(file: Arc<RecordFile>, scenario: &Scenario) -> Self {
        let draft = Self::new(file);
        let mapping = scenario.record.clone().unwrap_or_else(|| draft.mapping.clone());
        let (input, hold, plant) = (scenario.input, scenario.hold, scenario.plant.kind.clone());
        Self { mapping, input, hold, plant, suggest: false, base: Some(scenario.clone()), is_unfolded: true, ..draft }
    }

    pub fn role(&self, place: usize) -> ColumnRole {
        let name = &self.file.table.columns[place].name;
        if self.mapping.time.column.as_ref() == Some(name) {
            return ColumnRole::Time;
        }
        if self.mapping.input.as_ref().is_some_and(|input| input.column == *name) {
            return ColumnRole::Input;
        }
        let force = self.mapping.forces.iter().find(|(_, column)| column.column == *name);
        let force = force.map(|(mass, _)| ColumnRole::ForceOn(*mass));
        let sensor = self.mapping.sensors.iter().find(|(_, column)| column.column == *name);
        let sensor = sensor.map(|(quantity, _)| ColumnRole::Sensor(*quantity));
        force.or(sensor).unwrap_or(ColumnRole::Unused)
    }

    pub fn set_role(&mut self, place: usize, role: ColumnRole) {
        let column = &self.file.table.columns[place];
        let unit = column.unit.clone().unwrap_or_default();
        let mapping = &mut self.mapping;
        if mapping.time.column.as_ref() == Some(&column.name) {
            mapping.time = Time::default();
        }
        if mapping.input.as_ref().is_some_and(|input| input.column == column.name) {
            mapping.input = None;
        }
        mapping.forces.retain(|_, force| force.column != column.name);
        mapping.sensors.retain(|_, sensor| sensor.column != column.name);
        let mapped = MappedColumn::of(&self.file.table, column.name.clone());
        match role {
            ColumnRole::Unused => {}
            ColumnRole::Time => mapping.time = Time { column: Some(column.name.clone()), unit, ..Time::default() },
            ColumnRole::Input => (mapping.input, mapping.no_input) = (Some(mapped), false),
            ColumnRole::ForceOn(mass) => drop(mapping.forces.insert(mass, mapped)),
            ColumnRole::Sensor(quantity) => drop(mapping.sensors.insert(quantity, mapped)),
        }
    }

    pub fn set_input(&mut self, kind: Option<InputKind>) {
        self.mapping.no_input = kind.is_none();
        match kind {
            Some(kind) => self.input = kind,
            None => self.mapping.input = None,
        }
    }

    pub fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) {
        if !self.is_behind() {
            return;
        }
        let Self { file, mapping, input, hold, plant, outcome, making, is_unfolded, .. } = self;
        let choices = (mapping.clone(), *input, *hold);
        let under_way = making.take().filter(|(of, _)| *of == choices).map(|(_, work)| work);
        let truth = plant.channels().to_vec();
        let begin = || building(SharedFile(Arc::clone(file)), mapping.clone(), *input, *hold, truth);
        let mut work = under_way.unwrap_or_else(begin);
        if !work.advance(while_time) {
            *making = Some((choices, work));
            return;
        }
        let built = work.finish();
        *is_unfolded |= built.is_err();
        // At least 1, so that it changes only where the record is too long for the screen.
        mapping.every *= built.as_ref().map_or(1, |made| made.record.len().div_ceil(Session::LONGEST_WHOLE + 1));
        *outcome = Some((choices, built.map_err(|error| error.to_string())));
    }

    pub fn is_behind(&self) -> bool {
        let Self { mapping, input, hold, outcome, .. } = self;
        !outcome.as_ref().is_some_and(|((m, i, h), _)| m == mapping && i == input && h == hold)
    }

    pub fn outcome(&self) -> Option<Result<&Imported, &str>> {
        let (_, outcome) = self.outcome.as_ref()?;
        Some(outcome.as_ref().map_err(String::as_str))
    }

    pub(super) fn is_possible(&self) -> bool {
        // No start values follow from a sensor that never moves; without them the record can be opened.
        let is_fit = |imported: &Imported| !(self.suggest && imported.still.is_some());
        !self.is_behind() && self.outcome().is_some_and(|outcome| outcome.is_ok_and(is_fit))
    }

    pub fn scenario(&self) -> Option<Scenario> {
        let record = &self.outcome()?.ok()?.record;
        let fresh = scenario_for(record);
        let mut scenario = match self.base.clone() {
            Some(mut base) => {
                // Sensors that are new get filters that know their usual noise; others keep their settings.
                for quantity in base.sensors.iter().map(|s| s.measures).collect::<Vec<_>>() {
                    if !fresh.sensors.iter().any(|sensor| sensor.measures == quantity) {
                        base.remove_sensor(quantity);
                    }
                }
                fresh.sensors.iter().for_each(|sensor| base.add_sensor(*sensor));
                (base.dt, base.duration) = (fresh.dt, fresh.duration);
                base
            }
            None => fresh,
        };
        (scenario.input, scenario.hold) = (self.input, self.hold);
        scenario.record = Some(self.mapping.clone());
        if scenario.plant.kind != self.plant {
            scenario.set_plant(self.plant.clone());
        }
        Some(scenario)
    }
}

#[cfg(test)]
mod tests {
    use kalmanscope_core::import::read;

    use super::*;

    fn draft(text: &[u8]) -> Draft {
        let table = read(text, None).expect("a table");
        Draft::new(Arc::new(RecordFile { name: "record.csv".to_owned(), hash: String::new(), table }))
    }

    #[test]
    fn the_record_is_made_by_columns_and_the_last_complete_one_stays() {
        let mut draft = draft(&b"t,force,displacement,velocity\n0,1,2,3\n0.1,2,3,4\n0.2,1,2,2\n0.3,1,1,1\n"[..]);
        let make = |draft: &mut Draft| {
            let mut slices = 0;
            while draft.is_behind() {
                draft.advance(&mut || false);
                slices += 1;
            }
            slices
        };
        let samples = |draft: &Draft| draft.outcome().and_then(Result::ok).map(|made| made.record.len());
        assert!(draft.is_behind() && draft.outcome().is_none());
        assert!(make(&mut draft) >= 3, "the input and two sensors");
        assert_eq!(samples(&draft), Some(4));
        draft.mapping.from = Some(0.1);
        draft.advance(&mut || false);
        assert_eq!((draft.is_behind(), samples(&draft)), (true, Some(4)));
        draft.mapping.from = Some(0.2);
        make(&mut draft);
        assert_eq!(samples(&draft), Some(2));
        draft.mapping.from = Some(9.0);
        make(&mut draft);
        assert!(draft.outcome().is_some_and(|outcome| outcome.is_err()));
    }
}
