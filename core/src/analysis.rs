//! What is computed from a run beside its estimates.

use crate::bank::Bank;
use crate::diagnostics::Depth;
use crate::smoother::Smoother;
use crate::{CramerRao, Diagnosis, Diagnostics, Estimates, Record, Run, Scenario, Update, cost};

/// Samples that diagnostics take in before the time is looked at: about 0.5 ms.
const DIAGNOSTICS_CHUNK: usize = 10_000;

/// Samples that a bound takes in before the time is looked at: about 0.5 ms.
const BOUND_CHUNK: usize = 2_000;

/// Nanoseconds that diagnostics take for a sample, to within a factor of two.
const DIAGNOSTICS_COST: f64 = 60.0;

/// A Cramér-Rao bound and the filters that it is for.
pub struct Bound {
    /// The bound.
    pub bound: CramerRao,
    /// The filters' ids.
    pub filters: Vec<u32>,
}

/// The computations beside the estimates that are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// Diagnostics, and how deep.
    pub diagnostics: Option<Depth>,
    /// The estimates with hindsight of filters that have a smoother, once a run has come to its end.
    pub smoothed: bool,
    /// The Cramér-Rao bounds, which cost as much as a filter.
    pub bounds: bool,
}

impl Wanted {
    /// The estimates alone.
    pub const NOTHING: Self = Self { diagnostics: None, smoothed: false, bounds: false };

    /// The Cramér-Rao bounds.
    pub const BOUNDS: Self = Self { bounds: true, ..Self::NOTHING };

    /// Diagnostics of some depth.
    pub const fn diagnostics(depth: Depth) -> Self {
        Self { diagnostics: Some(depth), ..Self::NOTHING }
    }

    /// The computations that serve both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            diagnostics: self.diagnostics.max(other.diagnostics),
            smoothed: self.smoothed || other.smoothed,
            bounds: self.bounds || other.bounds,
        }
    }
}

impl Default for Wanted {
    /// All diagnostics and smoothed estimates, no bounds.
    fn default() -> Self {
        Self { diagnostics: Some(Depth::All), smoothed: true, bounds: false }
    }
}

/// Diagnostics, smoothed estimates and bounds of a run's filters, as far as they are wanted. Each of the three is there once
/// it is complete for all filters.
#[derive(Default)]
pub struct Analysis {
    wanted: Wanted,
    diagnostics: Vec<Diagnostics>,
    /// The ids of their filters.
    filters: Vec<u32>,
    /// Which of the diagnostics are those of the present estimates.
    begun: Vec<bool>,
    /// The diagnosis of each filter, and of how many samples from the beginning it is.
    diagnoses: Vec<(Option<Diagnosis>, usize)>,
    diagnosed: bool,
    smoothed: Vec<Estimates>,
    smoothing: Option<InProgress>,
    all_smoothed: bool,
    bounds: Vec<Bound>,
    /// Whether the bounds are those of the present scenario.
    chosen: bool,
    all_bounded: bool,
    /// Memory of diagnostics that are no longer needed.
    spare: Vec<Diagnostics>,
}

/// A smoother on its way.
struct InProgress {
    smoother: Smoother,
    estimates: Estimates,
}

/// What an analysis is about.
pub(crate) struct Subject<'a> {
    pub(crate) bank: &'a Bank,
    pub(crate) record: &'a Record,
    /// The number of samples done, from the beginning.
    pub(crate) done: usize,
    /// Whether these are all.
    pub(crate) whole: bool,
    /// The filters that have a place here have been analysed before.
    pub(crate) known: &'a [Option<usize>],
    /// The bounds that are there.
    pub(crate) bounds: &'a [Bound],
}

impl<'a> Subject<'a> {
    /// A run as far as it has come.
    pub(crate) fn of(run: &'a Run) -> Self {
        let (bank, record, done) = (run.bank(), run.record(), run.done());
        Self { bank, record, done, whole: done == run.samples(), known: &[], bounds: &[] }
    }
}

impl Analysis {
    /// The analysis of a run as far as it has come.
    pub fn new(run: &Run, wanted: Wanted) -> Self {
        let mut analysis = Self { wanted, ..Self::default() };
        analysis.follow(run);
        analysis
    }

    /// What is wanted.
    pub fn wanted(&self) -> Wanted {
        self.wanted
    }

    /// The diagnostics, one a filter; none before they are complete.
    pub fn diagnostics(&self) -> &[Diagnostics] {
        if self.diagnosed { &self.diagnostics } else { &[] }
    }

    /// The diagnosis of the filter at a place. Of a run that goes on, it is that of an earlier sample: it is made anew as soon
    /// as half as many samples have come as are kept, and at the end. None where there is none yet.
    pub fn diagnosis(&self, place: usize) -> Option<&Diagnosis> {
        self.diagnoses.get(place).filter(|_| self.diagnosed)?.0.as_ref()
    }

    /// The estimates with hindsight of the filters that have a smoother.
    pub fn smoothed(&self) -> &[Estimates] {
        if self.all_smoothed { &self.smoothed } else { &[] }
    }

    /// The bounds: filters that know as much at first share one.
    pub fn bounds(&self) -> &[Bound] {
        if self.all_bounded { &self.bounds } else { &[] }
    }

    /// The bound of the filter with an id.
    pub fn bound(&self, id: u32) -> Option<&CramerRao> {
        self.bounds().iter().find(|b| b.filters.contains(&id)).map(|b| &b.bound)
    }

    /// The same, complete or not.
    pub(crate) fn all_bounds(&self) -> &[Bound] {
        &self.bounds
    }

    /// Takes in all that is new of a run.
    pub fn follow(&mut self, run: &Run) {
        self.advance(&Subject::of(run), &mut || true);
    }

    /// Says what is to be computed from now on.
    pub(crate) fn want(&mut self, wanted: Wanted) {
        if self.wanted.diagnostics != wanted.diagnostics {
            (self.diagnostics, self.begun, self.spare) = Default::default();
            self.diagnoses.clear();
            self.diagnosed = false;
        }
        if self.wanted.smoothed != wanted.smoothed {
            (self.smoothed, self.smoothing) = Default::default();
            self.all_smoothed = false;
        }
        if self.wanted.bounds != wanted.bounds {
            self.bounds.clear();
            (self.chosen, self.all_bounded) = (false, false);
        }
        self.wanted = wanted;
    }

    /// An empty analysis that wants the same, in the memory that is spare here.
    pub(crate) fn successor(&mut self) -> Self {
        Self { wanted: self.wanted, spare: std::mem::take(&mut self.spare), ..Self::default() }
    }

    /// Takes over what has been computed anew for another run, or for some filters of the same.
    pub(crate) fn replace(&mut self, new: Self, update: &Update, run: &Run) {
        let mut old = std::mem::replace(self, new);
        self.spare.append(&mut old.spare);
        if self.wanted != old.wanted {
            self.want(old.wanted);
        }
        let Update::Filters(changed) = update else {
            self.spare.append(&mut old.diagnostics);
            return;
        };
        let ids: Vec<u32> = run.scenario().filters.iter().map(|filter| filter.id).collect();
        if let Some(depth) = self.wanted.diagnostics {
            self.diagnostics.resize_with(ids.len(), || Diagnostics::empty(depth));
            self.begun.resize(ids.len(), false);
            self.diagnoses.resize(ids.len(), (None, 0));
            self.filters.clone_from(&ids);
        }
        let of_filters = old.diagnostics.into_iter().zip(old.begun).zip(old.diagnoses);
        for (id, ((diagnostics, begun), diagnosis)) in old.filters.into_iter().zip(of_filters) {
            let place = ids.iter().position(|&new| new == id && !changed.contains(&id));
            if let Some(place) = place.filter(|&place| place < self.diagnostics.len()) {
                self.diagnostics[place] = diagnostics;
                self.begun[place] = begun;
                self.diagnoses[place] = diagnosis;
            } else {
                self.spare.push(diagnostics);
            }
        }
        let is_kept = |smoothed: &Estimates| ids.contains(&smoothed.id()) && !changed.contains(&smoothed.id());
        self.smoothed.extend(old.smoothed.into_iter().filter(is_kept));
        self.smoothed.sort_by_key(|smoothed| ids.iter().position(|&id| id == smoothed.id()));
        old.bounds.append(&mut self.bounds);
        self.bounds = bounds_of(run.scenario(), run.record().dt(), old.bounds, |_| true);
        self.chosen = true;
        (self.diagnosed, self.all_smoothed, self.all_bounded) = (false, false, false);
    }

    /// Takes in what is new. Asks after each little piece of work whether there is time for another. Returns whether all is
    /// done.
    pub(crate) fn advance(&mut self, subject: &Subject<'_>, while_time: &mut dyn FnMut() -> bool) -> bool {
        self.diagnosed = self.wanted.diagnostics.is_some_and(|depth| self.diagnose(depth, subject, while_time));
        if self.wanted.diagnostics.is_some() && !self.diagnosed {
            return false;
        }
        if self.wanted.smoothed && subject.whole && subject.record.forgotten() == 0 {
            self.all_smoothed = self.smooth(subject, while_time);
            if !self.all_smoothed {
                return false;
            }
        } else if !self.smoothed.is_empty() || self.smoothing.is_some() {
            (self.smoothed, self.smoothing, self.all_smoothed) = Default::default();
        }
        self.all_bounded = self.wanted.bounds && self.follow_bounds(subject, while_time);
        self.all_bounded || !self.wanted.bounds
    }

    fn diagnose(&mut self, depth: Depth, subject: &Subject<'_>, while_time: &mut dyn FnMut() -> bool) -> bool {
        let Self { diagnostics, diagnoses, filters: ids, begun, spare, .. } = self;
        let Subject { bank, record, known, .. } = subject;
        let filters = bank.estimates.len();
        ids.clear();
        ids.extend(bank.estimates.iter().map(Estimates::id));
        spare.extend(diagnostics.drain(filters.min(diagnostics.len())..));
        diagnostics.resize_with(filters, || spare.pop().unwrap_or_else(|| Diagnostics::empty(depth)));
        begun.resize(filters, false);
        diagnoses.resize(filters, (None, 0));
        for place in (0..filters).filter(|&place| !is_known(known, place)) {
            let (estimates, diagnostics) = (&bank.estimates[place], &mut diagnostics[place]);
            if !begun[place] {
                diagnostics.clear(estimates, record);
                begun[place] = true;
                diagnoses[place] = (None, 0);
            }
            loop {
                diagnostics.follow_to(diagnostics.len() + DIAGNOSTICS_CHUNK, estimates, record);
                if diagnostics.len() == estimates.len() {
                    break;
                }
                if !while_time() {
                    return false;
                }
            }
            let (diagnosis, of) = &mut diagnoses[place];
            let done = estimates.forgotten() + estimates.len();
            let is_old = done >= *of + estimates.len() / 2 || subject.whole;
            if *of != done && (diagnosis.is_none() || is_old) {
                *diagnosis = Diagnosis::new(diagnostics, estimates, record, None);
                *of = done;
            }
        }
        true
    }

    fn smooth(&mut self, subject: &Subject<'_>, while_time: &mut dyn FnMut() -> bool) -> bool {
        let Self { smoothed, smoothing, .. } = self;
        let Subject { bank, record, done, known, .. } = subject;
        let Scenario { filters, plant, .. } = bank.scenario();
        for place in (0..filters.len()).filter(|&place| filters[place].smoother && !is_known(known, place)) {
            if smoothed.iter().any(|of| of.id() == filters[place].id) {
                continue;
            }
            let Some(current) = smoothing.take().or_else(|| {
                let smoother = bank.smoother(place, record.dt())?;
                Some(InProgress { smoother, estimates: bank.smoothed(place) })
            }) else {
                smoothed.push(bank.smoothed(place));
                continue;
            };
            let InProgress { mut smoother, mut estimates } = current;
            let chunk = cost::chunk(2.0 * cost::of_step(&filters[place], plant.kind));
            loop {
                if smoother.advance(record, *done, chunk, &mut estimates) {
                    smoothed.push(estimates);
                    break;
                }
                if !while_time() {
                    *smoothing = Some(InProgress { smoother, estimates });
                    return false;
                }
            }
        }
        true
    }

    fn follow_bounds(&mut self, subject: &Subject<'_>, while_time: &mut dyn FnMut() -> bool) -> bool {
        let Subject { bank, record, bounds: there, .. } = subject;
        if !self.chosen {
            let is_missing = |place: usize| !there.iter().any(|b| b.bound.is_for(bank.scenario(), place));
            let old = std::mem::take(&mut self.bounds);
            self.bounds = bounds_of(bank.scenario(), record.dt(), old, is_missing);
            self.chosen = true;
        }
        let samples = subject.done - record.forgotten();
        for Bound { bound, .. } in &mut self.bounds {
            loop {
                let end = (bound.len() + BOUND_CHUNK).min(samples);
                if bound.follow_to(end, record) || end == samples {
                    break;
                }
                if !while_time() {
                    return false;
                }
            }
        }
        true
    }

    /// What is done and what there is to do, in nanoseconds.
    pub(crate) fn work(&self, subject: &Subject<'_>) -> (f64, f64) {
        let Subject { bank, done, known, .. } = subject;
        let scenario = bank.scenario();
        let samples = *done as f64;
        let (mut so_far, mut all) = (0.0, 0.0);
        for (place, filter) in scenario.filters.iter().enumerate().filter(|(place, _)| !is_known(known, *place)) {
            if self.wanted.diagnostics.is_some() {
                let followed = self.diagnostics.get(place).filter(|_| self.begun[place]).map_or(0, Diagnostics::len);
                so_far += DIAGNOSTICS_COST * (followed as f64).min(samples);
                all += DIAGNOSTICS_COST * samples;
            }
            if self.wanted.smoothed && subject.whole && filter.smoother && !filter.kind.is_sampled() {
                let cost = 2.0 * samples * cost::of_step(filter, scenario.plant.kind);
                let current = self.smoothing.as_ref().filter(|current| current.estimates.id() == filter.id);
                let share = if self.smoothed.iter().any(|of| of.id() == filter.id) {
                    1.0
                } else {
                    current.map_or(0.0, |current| current.smoother.progress(*done))
                };
                so_far += share * cost;
                all += cost;
            }
        }
        (so_far, all)
    }
}

fn is_known(known: &[Option<usize>], place: usize) -> bool {
    known.get(place).is_some_and(Option::is_some)
}

/// The bounds of a scenario's filters: those of `old` that are for them, and new ones for places that need one.
fn bounds_of(scenario: &Scenario, dt: f64, mut old: Vec<Bound>, is_needed: impl Fn(usize) -> bool) -> Vec<Bound> {
    let mut bounds: Vec<Bound> = Vec::new();
    for place in (0..scenario.filters.len()).filter(|&place| is_needed(place)) {
        let id = scenario.filters[place].id;
        let is_for = |b: &Bound| b.bound.is_for(scenario, place);
        if let Some(same) = bounds.iter_mut().find(|b| is_for(b)) {
            same.filters.push(id);
        } else if let Some(same) = old.iter().position(is_for) {
            bounds.push(Bound { filters: vec![id], ..old.swap_remove(same) });
        } else if let Some(bound) = CramerRao::new(scenario, place, dt) {
            bounds.push(Bound { bound, filters: vec![id] });
        }
    }
    bounds
}
