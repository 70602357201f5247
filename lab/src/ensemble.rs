//! Many runs of one scenario, which differ in the values of some settings, and their rows as far as they are known.

use kalmanscope_core::document::{self, DocumentError};
use kalmanscope_core::score::SampleScore;
use kalmanscope_core::setting::{Address, SEED, UnknownSetting};
use kalmanscope_core::{Axis, AxisError, Channel, FilterSettings, RunError, Scenario};
use kalmanscope_diagnosis::Measure;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Limits the cells of an ensemble.
pub const MAX_CELLS: usize = 100_000_000;

/// A grid over some settings of a scenario, with scores of some of its filters in each cell.
///
/// With an axis of seeds, a scenario that draws numbers ([`Scenario::draw`]) is a population: each seed is a member of it.
///
/// Cells are numbered in the order of the axes, the last axis fastest. A cell's row has the measures of the first
/// filter, then those of the next. If the plan has times, the trace of each filter follows ([`Trace`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Ensemble {
    scenario: Scenario,
    plan: Plan,
    settings: Vec<Address>,
    drawn: Vec<Address>,
}

/// The reason why an ensemble is impossible.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EnsembleError {
    /// A key names no number.
    #[error(transparent)]
    Setting(#[from] UnknownSetting),
    /// An axis is impossible.
    #[error(transparent)]
    Axis(#[from] AxisError),
    /// The scenario or the record does not fit.
    #[error(transparent)]
    Run(#[from] RunError),
    /// An axis would change a record that is given.
    #[error("the record is given, so only settings of filters can be varied, and `{0}` is none")]
    Fixed(String),
    /// Its axes or measures do not go together, or its text cannot be read.
    #[error("{0}")]
    Plan(String),
}

impl Ensemble {
    /// An ensemble of a scenario.
    ///
    /// # Errors
    /// [`EnsembleError`] for an impossible scenario, filter, measure or axis, and for too many cells.
    pub fn new(mut scenario: Scenario, plan: Plan) -> Result<Self, EnsembleError> {
        scenario.number_filters();
        scenario.validate().map_err(RunError::from)?;
        let mut settings: Vec<Address> = Vec::new();
        for axis in &plan.axes {
            axis.check()?;
            let setting = Address::parse(&scenario, &axis.key)?;
            if settings.contains(&setting) {
                return Err(EnsembleError::Plan(format!("two axes vary `{}`", axis.key)));
            }
            settings.push(setting);
        }
        let is_served = |measure: &&Measure| measure.info().is_number() && !measure.info().needs_others;
        if let Some(measure) = plan.measures.iter().find(|measure| !is_served(measure)) {
            let problem = format!("a cell has one run of one filter, and `{measure}` is not a number of that");
            return Err(EnsembleError::Plan(problem));
        }
        let cells = plan.axes.iter().map(|axis| axis.count as f64).product::<f64>();
        if cells > MAX_CELLS as f64 {
            let problem = format!("the axes have {cells} cells, but there may be at most {MAX_CELLS}");
            return Err(EnsembleError::Plan(problem));
        }
        if let Some(&place) = plan.filters.iter().find(|place| **place >= scenario.filters.len()) {
            return Err(RunError::NoFilter(place).into());
        }
        let is_drawn = settings.iter().any(is_seed);
        let keys = scenario.draw.keys().filter(|_| is_drawn);
        let drawn = keys.map(|key| Address::parse(&scenario, key)).collect::<Result<Vec<Address>, _>>()?;
        if let Some((axis, _)) = plan.axes.iter().zip(&settings).find(|(_, s)| drawn.iter().any(|d| d.overlaps(s))) {
            let problem = format!("`{}` is drawn for each seed, and cannot be an axis beside the seed", axis.key);
            return Err(EnsembleError::Plan(problem));
        }
        Ok(Self { scenario, plan, settings, drawn })
    }

    /// The ensemble as JSON, for another thread of a page: `[scenario, plan]`.
    pub fn to_json(&self) -> String {
        document::to_json(&(&self.scenario, &self.plan)).unwrap_or_default()
    }

    /// The ensemble that [`Self::to_json`] has written. Unlike a TOML file, the JSON leaves no default out.
    ///
    /// # Errors
    /// As [`Self::new`], and [`EnsembleError::Plan`] where it cannot be read.
    pub fn from_json(text: &str) -> Result<Self, EnsembleError> {
        let unread = |error: DocumentError| EnsembleError::Plan(format!("the ensemble cannot be read: {error}"));
        let (scenario, plan) = document::read_json(text).map_err(unread)?;
        Self::new(scenario, plan)
    }

    /// Takes over the names of the filters with the same ids in another scenario: no number depends on a name.
    pub fn call_filters(&mut self, scenario: &Scenario) {
        for filter in &mut self.scenario.filters {
            if let Some(other) = scenario.filters.iter().find(|other| other.id == filter.id) {
                filter.name.clone_from(&other.name);
            }
        }
    }

    /// The scenario that the cells are made from.
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// The axes, filters and measures.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The settings of the axes.
    pub fn settings(&self) -> &[Address] {
        &self.settings
    }

    /// The numbers that are drawn for each seed, in the order of [`Self::member`].
    pub fn drawn(&self) -> &[Address] {
        &self.drawn
    }

    /// The number of values on each axis.
    pub fn counts(&self) -> Vec<usize> {
        self.plan.axes.iter().map(|axis| axis.count).collect()
    }

    /// The number of cells.
    pub fn cells(&self) -> usize {
        self.plan.axes.iter().map(|axis| axis.count).product()
    }

    /// The length of a cell's row.
    pub fn width(&self) -> usize {
        self.plan.filters.len() * self.plan.measures.len() + self.trace().width()
    }

    /// The places of the numbers at the plan's times, in a cell's row.
    pub fn trace(&self) -> Trace {
        Trace::new(&self.scenario, &self.plan)
    }

    /// The names of a row's measures: `EKF.nis`, `EKF.rmse.natural_frequency`, …
    pub fn columns(&self) -> Vec<String> {
        let of = |&place: &usize| {
            let name = &self.scenario.filters[place].name;
            self.plan.measures.iter().map(move |measure| format!("{name}.{measure}"))
        };
        self.plan.filters.iter().flat_map(of).collect()
    }

    /// The place of a cell on each axis.
    pub fn places(&self, cell: usize) -> Vec<usize> {
        let (mut rest, mut places) = (cell, self.counts());
        for place in places.iter_mut().rev() {
            (rest, *place) = (rest / *place, rest % *place);
        }
        places
    }

    /// The cell at these places.
    pub fn cell(&self, places: &[usize]) -> usize {
        self.plan.axes.iter().zip(places).fold(0, |cell, (axis, place)| cell * axis.count + place)
    }

    /// The values of a cell, one an axis. Values of an integer setting are rounded, as in the cell's scenario.
    pub fn values(&self, cell: usize) -> Vec<f64> {
        let axes = self.plan.axes.iter().zip(&self.settings).zip(self.places(cell));
        axes.map(|((axis, setting), place)| setting.rounded(axis.value(place))).collect()
    }

    /// The numbers that are drawn in a cell, one a number of [`Self::drawn`].
    pub fn member(&self, cell: usize) -> Vec<f64> {
        let drawn = |seed| self.scenario.drawn(seed).into_iter().map(|(_, value)| value).collect();
        self.seed(cell).map_or_else(Vec::new, drawn)
    }

    /// The scenario of a cell. It may be impossible.
    pub fn at(&self, cell: usize) -> Scenario {
        let seed = self.seed(cell);
        let mut scenario = seed.map_or_else(|| self.scenario.clone(), |seed| self.scenario.member(seed));
        for (setting, value) in self.settings.iter().zip(self.values(cell)) {
            setting.set(&mut scenario, value);
        }
        scenario
    }

    fn seed(&self, cell: usize) -> Option<u64> {
        let place = self.settings.iter().position(is_seed).filter(|_| !self.drawn.is_empty())?;
        Some(self.values(cell)[place] as u64)
    }

    /// A given record follows the axes of filters, of its input's gain, and of the seeds of a population of filters.
    pub(crate) fn first_that_changes_record(&self) -> Option<&str> {
        let is_of_filters = !self.drawn.is_empty() && self.drawn.iter().all(Address::is_of_filters);
        let suits = |setting: &Address| setting.suits_given_record() || (is_seed(setting) && is_of_filters);
        let mut settings = self.plan.axes.iter().zip(&self.settings);
        settings.find(|(_, setting)| !suits(setting)).map(|(axis, _)| axis.key.as_str())
    }

    /// The cells in the best order for a picture, which covers the grid evenly at every moment: first every cell at places that are
    /// multiples of the widest stride, then those of half the stride, down to 1.
    pub fn coarse_to_fine(&self) -> Vec<usize> {
        let (counts, mut order) = (self.counts(), Vec::from_iter(0..self.cells()));
        let halvings = |cell: &usize| (0..).find(|i| stand_in(&counts, *cell, widest(&counts) >> i) == *cell);
        order.sort_by_cached_key(halvings);
        order
    }

    pub(crate) fn record_of(&self, cell: usize) -> usize {
        let axes = self.plan.axes.iter().zip(&self.settings).zip(self.places(cell));
        axes.filter(|((_, setting), _)| !setting.is_of_filters())
            .fold(0, |number, ((axis, _), place)| number * axis.count + place)
    }
}

fn is_seed(setting: &Address) -> bool {
    setting.key == SEED.key
}

/// The channels that the filters at these places of a scenario have, each once.
pub fn channels(scenario: &Scenario, filters: &[usize]) -> Vec<Channel> {
    let mut channels = Vec::new();
    for filter in filters.iter().filter_map(|&place| scenario.filters.get(place)) {
        for &channel in filter.model(&scenario.plant.kind, scenario.input).channels() {
            if !channels.contains(&channel) {
                channels.push(channel);
            }
        }
    }
    channels
}

/// The axes, filters and measures of an ensemble, without its scenario: plain data for files and messages.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    /// The places of the filters to score, from 0 on.
    pub filters: Vec<usize>,
    /// The scores to take.
    pub measures: Vec<Measure>,
    /// The number of times, equally spaced over the record, at which each run is recorded, for Monte Carlo.
    #[serde(default)]
    pub times: usize,
    /// The settings to vary, in the order of the cells; without one there is a single cell.
    #[serde(default)]
    pub axes: Vec<Axis>,
}

/// The places of a run's numbers at the plan's times, within a cell's row: for each filter and each time NEES, NIS, and error and std of
/// each channel. NaN without a value, for example after a filter has stopped.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    begin: usize,
    samples: Vec<usize>,
    channels: Vec<Vec<Channel>>,
}

impl Trace {
    pub(crate) fn new(scenario: &Scenario, plan: &Plan) -> Self {
        let last = scenario.samples().saturating_sub(1);
        let sample = |nth: usize| (nth as f64 * last as f64 / plan.times as f64).round() as usize;
        let mut samples: Vec<usize> = (1..=plan.times).map(sample).filter(|sample| *sample > 0).collect();
        samples.dedup();
        let filters = plan.filters.iter().filter_map(|&place| scenario.filters.get(place));
        let channels = |filter: &FilterSettings| filter.model(&scenario.plant.kind, scenario.input).channels().to_vec();
        let channels = filters.map(channels).collect();
        Self { begin: plan.filters.len() * plan.measures.len(), samples, channels }
    }

    /// The samples of the trace.
    pub fn samples(&self) -> &[usize] {
        &self.samples
    }

    /// The channels of the `nth` filter of the plan.
    pub fn channels(&self, nth: usize) -> &[Channel] {
        self.channels.get(nth).map_or(&[], Vec::as_slice)
    }

    pub(crate) fn width(&self) -> usize {
        self.channels.iter().map(|channels| self.samples.len() * stride(channels)).sum()
    }

    /// NEES and NIS of the `nth` filter at a time.
    pub fn squares(&self, row: &[f64], nth: usize, time: usize) -> [f64; 2] {
        let at = self.at(nth, time);
        [row[at], row[at + 1]]
    }

    /// Error and standard deviation of a channel of the `nth` filter at a time.
    pub fn error(&self, row: &[f64], nth: usize, time: usize, channel: usize) -> [f64; 2] {
        let at = self.at(nth, time) + 2 + 2 * channel;
        [row[at], row[at + 1]]
    }

    fn at(&self, nth: usize, time: usize) -> usize {
        let before: usize = self.channels[..nth].iter().map(|channels| self.samples.len() * stride(channels)).sum();
        self.begin + before + time * stride(&self.channels[nth])
    }

    pub(crate) fn fill(&self, nth: usize, sample_scores: &[SampleScore], row: &mut [f64]) {
        let begin = self.at(nth, 0);
        for (numbers, look) in row[begin..].chunks_mut(stride(&self.channels[nth])).zip(sample_scores) {
            numbers[..2].copy_from_slice(&[look.nees, look.nis]);
            numbers[2..].copy_from_slice(look.channels.as_flattened());
        }
    }
}

fn stride(channels: &[Channel]) -> usize {
    2 + 2 * channels.len()
}

fn widest(counts: &[usize]) -> usize {
    let longest = counts.iter().copied().max().unwrap_or(1).max(1);
    let stride = longest.div_ceil(8).next_power_of_two();
    if stride > longest { 1 } else { stride }
}

/// The cell that stands in for another one as long as only cells on multiples of `stride` are done.
fn stand_in(counts: &[usize], cell: usize, stride: usize) -> usize {
    let (mut rest, mut scale, mut found) = (cell, 1, 0);
    for &count in counts.iter().rev() {
        let place = rest % count;
        found += scale * (place - place % stride);
        rest /= count;
        scale *= count;
    }
    found
}

/// The rows of some cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// The cells.
    pub cells: Vec<usize>,
    /// Their rows, one after the other.
    pub rows: Vec<f64>,
}

/// The rows of an ensemble's cells, filled in any order.
#[derive(Clone, Debug)]
pub struct EnsembleRows {
    counts: Vec<usize>,
    width: usize,
    rows: Vec<f64>,
    known: Vec<bool>,
    done: usize,
}

impl EnsembleRows {
    /// An empty sheet.
    pub fn new(ensemble: &Ensemble) -> Self {
        let (cells, width) = (ensemble.cells(), ensemble.width());
        let rows = vec![f64::NAN; cells * width];
        Self { counts: ensemble.counts(), width, rows, known: vec![false; cells], done: 0 }
    }

    /// Fills in the rows of some cells, one after the other.
    pub fn fill(&mut self, cells: &[usize], rows: &[f64]) {
        for (at, &cell) in cells.iter().enumerate() {
            let Some(row) = rows.get(at * self.width..(at + 1) * self.width) else { return };
            self.rows[cell * self.width..(cell + 1) * self.width].copy_from_slice(row);
            self.done += usize::from(!self.known[cell]);
            self.known[cell] = true;
        }
    }

    /// The row of a cell, if it is known.
    pub fn row(&self, cell: usize) -> Option<&[f64]> {
        self.known.get(cell)?.then(|| &self.rows[cell * self.width..(cell + 1) * self.width])
    }

    /// The row of a cell, or else that of the finest known cell that stands in for it in a picture.
    pub fn shown(&self, cell: usize) -> Option<&[f64]> {
        let strides = std::iter::successors(Some(1), |stride| Some(2 * stride));
        let strides = strides.take_while(|stride| *stride <= widest(&self.counts));
        strides.map(|stride| stand_in(&self.counts, cell, stride)).find_map(|cell| self.row(cell))
    }

    /// A hash of all rows, to compare platforms.
    pub fn checksum(&self) -> u64 {
        // NaN has many bit patterns.
        let bits = |number: &f64| if number.is_nan() { u64::MAX } else { number.to_bits() };
        self.rows.iter().fold(0, |sum: u64, number| sum.rotate_left(5) ^ bits(number))
    }

    /// The number of cells.
    pub fn len(&self) -> usize {
        self.known.len()
    }

    /// Whether there is no cell.
    pub fn is_empty(&self) -> bool {
        self.known.is_empty()
    }

    /// The number of cells that are known.
    pub fn done(&self) -> usize {
        self.done
    }

    /// Whether every cell is known.
    pub fn is_complete(&self) -> bool {
        self.done == self.known.len()
    }

    /// Whether every cell is known or has one that stands in for it.
    pub fn covers_all(&self) -> bool {
        let stride = widest(&self.counts);
        let coarse = |cell: &usize| stand_in(&self.counts, *cell, stride) == *cell;
        (0..self.len()).filter(coarse).all(|cell| self.known[cell])
    }

    /// The cells of an order that are not known yet.
    pub fn missing<'a>(&'a self, order: &'a [usize]) -> impl Iterator<Item = usize> + 'a {
        order.iter().copied().filter(|&cell| !self.known[cell])
    }
}
