//! One ensemble of a map, with its rows so far.

use std::fmt::Write as _;
use std::rc::Rc;
use std::sync::Arc;

use egui::Context;
use kalmanscope_core::setting::{Address, Change, TableInfo};
use kalmanscope_core::{Axis, FilterSettings, Scenario, Source};
use kalmanscope_diagnosis::Measure;
use kalmanscope_lab::{Ensemble, EnsembleRows, Plan, Runner};

use super::choice::{MapChoice, is_same_but_for_names, part_of};
use super::settings;
use crate::session::is_same;
use crate::team::{CellBatch, Computer, Dispatch, Precision, Priority, Team};

pub struct Survey {
    pub ensemble: Ensemble,
    source: Source,
    pub filters: Vec<u32>,
    order: Vec<usize>,
    pub sheet: EnsembleRows,
    pub(super) work: Option<Dispatch>,
    precision: Precision,
    pub computers: Vec<Computer>,
}

impl Survey {
    /// Factors stay relative to the numbers that they had before, so that the map does not move.
    pub(super) fn new(
        scenario: &Scenario,
        source: Source,
        choice: &MapChoice,
        before: Option<&Self>,
    ) -> Result<Self, String> {
        let filters = choice.filters();
        let mut part = part_of(scenario, &filters);
        if let Some(before) = before.filter(|before| before.filters == filters && before.has_its_factors(&part)) {
            for (_, setting) in before.factors() {
                setting.set(&mut part, 1.0);
            }
        }
        let mut measures = settings::taken(&part);
        if !measures.contains(&choice.measure) {
            measures.push(choice.measure);
        }
        let plan = Plan { filters: (0..filters.len()).collect(), measures, axes: choice.axes.to_vec(), times: 0 };
        let ensemble = Ensemble::new(part, plan).map_err(|error| error.to_string())?;
        let (order, sheet) = (ensemble.coarse_to_fine(), EnsembleRows::new(&ensemble));
        let (work, computers, precision) = (None, Vec::new(), choice.precision);
        Ok(Self { ensemble, source, filters, order, sheet, work, precision, computers })
    }

    pub fn axes(&self) -> [&Axis; 2] {
        [0, 1].map(|at| &self.ensemble.plan().axes[at])
    }

    pub fn has(&self, measure: Measure) -> bool {
        self.ensemble.plan().measures.contains(&measure)
    }

    pub fn column(&self, filter: usize, measure: Measure) -> Option<usize> {
        let measures = &self.ensemble.plan().measures;
        let at = measures.iter().position(|other| *other == measure)?;
        (filter < self.filters.len()).then_some(filter * measures.len() + at)
    }

    pub fn value(&self, cell: usize, filter: usize, measure: Measure) -> Option<f64> {
        self.sheet.shown(cell)?.get(self.column(filter, measure)?).copied()
    }

    pub fn present(&self, scenario: &Scenario) -> [f64; 2] {
        let part = part_of(scenario, &self.filters);
        [0, 1].map(|at| self.ensemble.settings().get(at).map_or(f64::NAN, |setting| setting.get(&part)))
    }

    pub fn with(&self, scenario: &Scenario, values: [f64; 2]) -> Option<Change> {
        let mut part = part_of(scenario, &self.filters);
        if part.filters.len() != self.filters.len() {
            return None;
        }
        let mut change = Change::default();
        for (setting, value) in self.ensemble.settings().iter().zip(values) {
            setting.set(&mut part, value);
            if !setting.is_of_filters() {
                change.set_at(setting.clone(), value);
            }
        }
        part.validate().ok()?;
        // An address of all filters means those of the map.
        if self.ensemble.settings().iter().any(Address::is_of_filters) {
            for filter in part.filters {
                let color = scenario.filters.iter().find(|own| own.id == filter.id)?.color;
                change.put_filter(0, FilterSettings { color, ..filter });
            }
        }
        Some(change)
    }

    pub(super) fn is_of(&self, scenario: &Scenario, source: &Source, choice: &MapChoice) -> bool {
        let same_plan = self.filters == choice.filters()
            && self.ensemble.plan().axes == choice.axes
            && self.has(choice.measure)
            && self.precision == choice.precision
            && (is_same(&self.source, source) || self.varies(source));
        if !same_plan {
            return false;
        }
        let part = part_of(scenario, &self.filters);
        part.filters.len() == self.filters.len() && self.has_its_factors(&part) && {
            let base = self.ensemble.scenario();
            // The axes' settings are made alike before the comparison: a change of them only moves the dot.
            let moved = |scenario: &Scenario| {
                let mut moved = scenario.clone();
                self.ensemble.settings().iter().for_each(|setting| setting.set(&mut moved, setting.get(base)));
                moved
            };
            is_same_but_for_names(&moved(&part), &moved(base))
        }
    }

    /// A live record that has grown by a quarter since this survey gets a new source, once the survey is complete.
    pub(super) fn steady(&self, source: Source) -> Source {
        let Source::Live(record) = source else { return source };
        let shorter = self.source.record().filter(|known| {
            record.begins_with(known) && (!self.sheet.is_complete() || 4 * record.len() < 5 * known.len())
        });
        Source::Measured(Arc::clone(shorter.unwrap_or(&record)))
    }

    /// Whether a source differs only because an axis varies the given record. The scenario identifies that record.
    fn varies(&self, source: &Source) -> bool {
        let is_given = matches!((&self.source, source), (Source::Measured(_), Source::Measured(_)));
        is_given && self.ensemble.settings().iter().any(|setting| !setting.is_of_filters())
    }

    fn factors(&self) -> impl Iterator<Item = (&TableInfo, &Address)> {
        let factors = self.ensemble.settings().iter().filter(|setting| setting.is_factor());
        factors.filter_map(|setting| Some((setting.table?, setting)))
    }

    fn has_its_factors(&self, part: &Scenario) -> bool {
        self.factors().all(|(table, setting)| {
            let factor = setting.get(part);
            let mut expected = self.ensemble.scenario().clone();
            setting.set(&mut expected, factor);
            let pairs = part.filters.iter().zip(&expected.filters);
            factor.is_finite()
                && pairs.into_iter().all(|(now, then)| are_close(&table.numbers(now), &table.numbers(then)))
        })
    }

    pub(super) fn follow(&mut self, team: &Rc<dyn Team>, ctx: &Context) -> Result<bool, String> {
        if self.sheet.is_complete() {
            self.work = None;
            return Ok(false);
        }
        if self.work.is_none() {
            let runner = Runner::new(self.ensemble.clone(), self.source.clone()).map_err(|error| error.to_string())?;
            let (runner, order) = (Arc::new(runner), self.sheet.missing(&self.order).collect());
            let cells = CellBatch { runner, order, precision: self.precision, priority: Priority::Map };
            self.work = Some(Dispatch::new(team, cells, ctx));
        }
        let Some(work) = &mut self.work else { return Ok(false) };
        let rows = work.take();
        for rows in &rows {
            self.sheet.fill(&rows.cells, &rows.numbers);
            if !self.computers.contains(&rows.by) {
                self.computers.push(rows.by.clone());
            }
        }
        Ok(!rows.is_empty())
    }
}

fn are_close(a: &[f64], b: &[f64]) -> bool {
    // A factor is multiplied and divided again, so the numbers differ by rounding.
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-9 * a.abs())
}

impl Survey {
    pub fn to_csv(&self) -> String {
        let ensemble = &self.ensemble;
        let [only, ..] = &ensemble.scenario().filters[..] else { return String::new() };
        let key = |key: &str| match (self.filters.len(), key.strip_prefix("filters.*.")) {
            (1, Some(rest)) => format!("filters.{}.{rest}", only.name),
            _ => ensemble.scenario().address_by_name(key),
        };
        let keys = ensemble.plan().axes.iter().map(|axis| key(&axis.key));
        let names: Vec<String> = keys.chain(ensemble.columns()).map(|name| quoted(&name)).collect();
        let mut text = names.join(",");
        text.push('\n');
        for cell in 0..ensemble.cells() {
            let row = self.sheet.row(cell);
            let unknown = vec![f64::NAN; ensemble.width()];
            let numbers = ensemble.values(cell).into_iter().chain(row.unwrap_or(&unknown).iter().copied());
            for (at, number) in numbers.enumerate() {
                let comma = if at > 0 { "," } else { "" };
                // Writing to a string cannot fail.
                let _ = if number.is_nan() { write!(text, "{comma}") } else { write!(text, "{comma}{number}") };
            }
            text.push('\n');
        }
        text
    }
}

pub(super) fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}
