//! Diagnostics, smoothed estimates and Cramér-Rao bounds of a run.

mod smoothing;

use kalmanscope_core::internals::{Bank, Waste};
use kalmanscope_core::{CramerRao, Diagnostics, Estimates, Evidence, Record, Run, Scenario, Update};

use crate::Diagnosis;
use smoothing::Smoothing;

/// Limits the samples that diagnostics and evidence take in between two checks of the time: about 0.5 ms.
const CHUNK: usize = 10_000;

const BOUND_CHUNK: usize = 2_000;

/// Time that the diagnostics take for one sample, to within a factor of two \[ns\].
const DIAGNOSTICS_COST: f64 = 60.0;

/// The wanted results of a run's filters, each kind once it is complete for all of them.
#[derive(Default)]
pub struct Analysis {
    wanted: Wanted,
    diagnostics: Vec<Diagnostics>,
    judged: Vec<DiagnosedFilter>,
    pub(crate) waits: bool,
    diagnosed: bool,
    smoothing: Smoothing,
    evidences: Vec<Evidence>,
    all_evident: bool,
    pub(crate) bounds: Vec<Bound>,
    chosen: bool,
    all_bounded: bool,
    spare: Vec<Diagnostics>,
    pub(crate) waste: Waste,
}

/// A filter's diagnosis, and whether its diagnostics have begun.
#[derive(Default)]
struct DiagnosedFilter {
    id: u32,
    begun: bool,
    diagnosis: Option<Diagnosis>,
    samples: usize,
}

pub(crate) struct AnalysisSubject<'a> {
    pub(crate) bank: &'a Bank,
    pub(crate) record: &'a Record,
    pub(crate) done: usize,
    pub(crate) whole: bool,
    /// Filters that have a place here are already analysed.
    pub(crate) known: &'a [Option<usize>],
    pub(crate) bounds: &'a [Bound],
}

impl<'a> AnalysisSubject<'a> {
    pub(crate) fn of(run: &'a Run) -> Self {
        let (bank, record, done) = (&run.bank, run.record(), run.done());
        Self { bank, record, done, whole: done == run.samples() && !run.is_live(), known: &[], bounds: &[] }
    }
}

impl Analysis {
    /// The analysis of the part of a run that is done so far.
    pub fn new(run: &Run, wanted: Wanted) -> Self {
        let mut analysis = Self { wanted, ..Self::default() };
        analysis.advance(&AnalysisSubject::of(run), &mut || true);
        analysis
    }

    /// The diagnostics, one per filter; empty until they are complete.
    pub fn diagnostics(&self) -> &[Diagnostics] {
        if self.diagnosed { &self.diagnostics } else { &[] }
    }

    /// The diagnosis of the filter at a place, made again after half as many samples as are kept, and at the end; `None` before the first.
    pub fn diagnosis(&self, place: usize) -> Option<&Diagnosis> {
        self.judged.get(place).filter(|_| self.diagnosed)?.diagnosis.as_ref()
    }

    /// The smoothed estimates of the filters that have a smoother. Without a fixed look-ahead they are empty until the run is complete.
    pub fn smoothed(&self) -> &[Estimates] {
        self.smoothing.estimates()
    }

    /// The evidence of each filter; empty until it is complete.
    pub fn evidence(&self) -> &[Evidence] {
        if self.all_evident { &self.evidences } else { &[] }
    }

    /// The bounds. Filters with the same initial belief and process noise share one.
    pub fn bounds(&self) -> &[Bound] {
        if self.all_bounded { &self.bounds } else { &[] }
    }

    /// The bound of the filter with an id.
    pub fn bound(&self, id: u32) -> Option<&CramerRao> {
        self.bounds().iter().find(|b| b.filters.contains(&id)).map(|b| &b.bound)
    }

    pub(crate) fn want(&mut self, wanted: Wanted) {
        if self.wanted.diagnostics != wanted.diagnostics {
            let diagnostics = self.diagnostics.drain(..).chain(self.spare.drain(..));
            self.waste.extend(diagnostics);
            self.judged.clear();
            self.diagnosed = false;
        }
        if self.wanted.smoothed != wanted.smoothed {
            self.smoothing.discard(&mut self.waste);
        }
        if self.wanted.evidence != wanted.evidence {
            (self.evidences, self.all_evident) = (Vec::new(), false);
        }
        if self.wanted.bounds != wanted.bounds {
            self.waste.extend(self.bounds.drain(..).map(|of| of.bound));
            (self.chosen, self.all_bounded) = (false, false);
        }
        self.wanted = wanted;
    }

    pub(crate) fn successor(&mut self) -> Self {
        let spare = std::mem::take(&mut self.spare);
        Self { wanted: self.wanted, waits: self.waits, spare, ..Self::default() }
    }

    fn keep_until_due(&mut self, old: DiagnosedFilter, samples: usize) {
        let mut all = self.judged.iter_mut().zip(&self.diagnostics);
        let same = all.find(|(one, _)| one.id == old.id).filter(|(_, diagnostics)| diagnostics.len() == samples);
        if let Some((one, _)) = same.filter(|_| self.waits) {
            one.diagnosis = one.diagnosis.take().or(old.diagnosis);
        }
    }

    pub(crate) fn recycle(&mut self, mut old: Self) {
        old.smoothing.discard(&mut old.waste);
        self.spare.append(&mut old.spare);
        self.spare.append(&mut old.diagnostics);
        self.waste.append(&mut old.waste);
        self.waste.extend(old.bounds.drain(..).map(|of| of.bound));
    }

    pub(crate) fn forget_before(&mut self, sample: usize) {
        self.smoothing.forget_before(sample);
        self.evidences.iter_mut().for_each(|evidence| evidence.forget_before(sample));
    }

    pub(crate) fn replace(&mut self, new: Self, update: &Update, run: &Run) {
        let mut old = std::mem::replace(self, new);
        if self.wanted != old.wanted {
            self.want(old.wanted);
        }
        let Update::Filters(changed) = update else {
            for (one, diagnostics) in old.judged.drain(..).zip(&old.diagnostics) {
                self.keep_until_due(one, diagnostics.len());
            }
            self.recycle(old);
            return;
        };
        let filters = &run.scenario().filters;
        if self.wanted.diagnostics {
            self.diagnostics.resize_with(filters.len(), Diagnostics::default);
            self.judged.resize_with(filters.len(), DiagnosedFilter::default);
            self.judged.iter_mut().zip(filters).for_each(|(one, filter)| one.id = filter.id);
        }
        for (one, diagnostics) in old.judged.drain(..).zip(old.diagnostics.drain(..)) {
            let place = filters.iter().position(|filter| filter.id == one.id && !changed.contains(&one.id));
            if let Some(place) = place.filter(|&place| place < self.diagnostics.len()) {
                (self.judged[place], self.diagnostics[place]) = (one, diagnostics);
            } else {
                self.keep_until_due(one, diagnostics.len());
                self.spare.push(diagnostics);
            }
        }
        let smoothed = std::mem::take(&mut old.smoothing);
        self.smoothing.take_over(smoothed, filters, changed, &mut self.waste);
        (self.evidences, self.all_evident) = (Vec::new(), false);
        old.bounds.append(&mut self.bounds);
        self.bounds = bounds_of(run.scenario(), run.record().dt(), std::mem::take(&mut old.bounds), |_| true);
        self.chosen = true;
        (self.diagnosed, self.all_bounded) = (false, false);
        self.recycle(old);
    }

    pub(crate) fn advance(&mut self, subject: &AnalysisSubject<'_>, while_time: &mut dyn FnMut() -> bool) -> bool {
        self.diagnosed = self.wanted.diagnostics && self.diagnose(subject, while_time);
        if self.wanted.diagnostics && !self.diagnosed {
            return false;
        }
        if !self.smoothing.follow(subject, self.wanted.smoothed, &mut self.waste, while_time) {
            return false;
        }
        self.all_evident = self.wanted.evidence && self.follow_evidences(subject, while_time);
        if self.wanted.evidence && !self.all_evident {
            return false;
        }
        self.all_bounded = self.wanted.bounds && self.follow_bounds(subject, while_time);
        self.all_bounded || !self.wanted.bounds
    }

    fn diagnose(&mut self, subject: &AnalysisSubject<'_>, while_time: &mut dyn FnMut() -> bool) -> bool {
        let Self { diagnostics, judged, waits, spare, .. } = self;
        let AnalysisSubject { bank, record, known, .. } = subject;
        let filters = bank.estimates.len();
        spare.extend(diagnostics.drain(filters.min(diagnostics.len())..));
        diagnostics.resize_with(filters, || spare.pop().unwrap_or_default());
        judged.resize_with(filters, DiagnosedFilter::default);
        judged.iter_mut().zip(&bank.estimates).for_each(|(one, estimates)| one.id = estimates.id());
        for place in (0..filters).filter(|&place| !is_known(known, place)) {
            let (one, estimates, diagnostics) = (&mut judged[place], &bank.estimates[place], &mut diagnostics[place]);
            if !one.begun {
                diagnostics.clear(estimates, record);
                *one = DiagnosedFilter { id: one.id, begun: true, ..DiagnosedFilter::default() };
            }
            let mut follow = || {
                diagnostics.follow_to(diagnostics.len() + CHUNK, estimates, record);
                diagnostics.len() == estimates.len()
            };
            if !in_time(&mut follow, while_time) {
                return false;
            }
            let done = estimates.forgotten() + estimates.len();
            let is_old = done >= one.samples + estimates.len() / 2 || subject.whole;
            if !*waits && one.samples != done && (one.diagnosis.is_none() || is_old) {
                (one.diagnosis, one.samples) = (Diagnosis::new(diagnostics, estimates, record), done);
            }
        }
        true
    }

    fn follow_evidences(&mut self, subject: &AnalysisSubject<'_>, while_time: &mut dyn FnMut() -> bool) -> bool {
        let AnalysisSubject { bank, known, .. } = subject;
        self.evidences.resize_with(bank.estimates.len(), Evidence::default);
        for (place, estimates) in bank.estimates.iter().enumerate().filter(|(place, _)| !is_known(known, *place)) {
            let evidence = &mut self.evidences[place];
            let mut follow = || {
                evidence.follow_to(evidence.len() + CHUNK, estimates);
                evidence.len() >= estimates.len()
            };
            if !in_time(&mut follow, while_time) {
                return false;
            }
        }
        true
    }

    fn follow_bounds(&mut self, subject: &AnalysisSubject<'_>, while_time: &mut dyn FnMut() -> bool) -> bool {
        let AnalysisSubject { bank, record, bounds: there, .. } = subject;
        if !self.chosen {
            let is_missing = |place: usize| !there.iter().any(|b| b.bound.is_for(&bank.scenario, place));
            let old = std::mem::take(&mut self.bounds);
            self.bounds = bounds_of(&bank.scenario, record.dt(), old, is_missing);
            self.chosen = true;
        }
        let samples = subject.done - record.forgotten();
        for Bound { bound, .. } in &mut self.bounds {
            let mut follow = || {
                let end = (bound.len() + BOUND_CHUNK).min(samples);
                bound.follow_to(end, record) || end == samples
            };
            if !in_time(&mut follow, while_time) {
                return false;
            }
        }
        true
    }

    /// The work that is done and the whole work, in nanoseconds.
    pub(crate) fn work(&self, subject: &AnalysisSubject<'_>) -> (f64, f64) {
        let AnalysisSubject { bank, done, known, .. } = subject;
        let scenario = &bank.scenario;
        let samples = *done as f64;
        let (mut so_far, mut all) = (0.0, 0.0);
        for (place, filter) in scenario.filters.iter().enumerate().filter(|(place, _)| !is_known(known, *place)) {
            if self.wanted.diagnostics {
                let followed =
                    self.diagnostics.get(place).filter(|_| self.judged[place].begun).map_or(0, Diagnostics::len);
                so_far += DIAGNOSTICS_COST * (followed as f64).min(samples);
                all += DIAGNOSTICS_COST * samples;
            }
            let (done, whole) = self.smoothing.work(filter, subject, self.wanted.smoothed);
            so_far += done;
            all += whole;
        }
        (so_far, all)
    }
}

fn in_time(work: &mut dyn FnMut() -> bool, while_time: &mut dyn FnMut() -> bool) -> bool {
    while !work() {
        if !while_time() {
            return false;
        }
    }
    true
}

fn is_known(known: &[Option<usize>], place: usize) -> bool {
    known.get(place).is_some_and(Option::is_some)
}

/// The results to compute in addition to the estimates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// Diagnostics.
    pub diagnostics: bool,
    /// Smoothed estimates of the filters that have a smoother.
    pub smoothed: Hindsight,
    /// The evidence of each filter over time.
    pub evidence: bool,
    /// The Cramér-Rao bounds, each of which costs as much as a filter.
    pub bounds: bool,
}

/// The smoothed estimates to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Hindsight {
    /// None.
    None,
    /// Those with a fixed look-ahead, as the run continues.
    Lagged,
    /// Also those of the whole run, once it is complete.
    All,
}

impl Wanted {
    /// The estimates alone.
    pub const NOTHING: Self = Self { diagnostics: false, smoothed: Hindsight::None, evidence: false, bounds: false };

    /// The Cramér-Rao bounds.
    pub const BOUNDS: Self = Self { bounds: true, ..Self::NOTHING };

    /// The evidence of each filter.
    pub const EVIDENCE: Self = Self { evidence: true, ..Self::NOTHING };

    /// The diagnostics.
    pub const DIAGNOSTICS: Self = Self { diagnostics: true, ..Self::NOTHING };

    /// The union of both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            diagnostics: self.diagnostics || other.diagnostics,
            smoothed: self.smoothed.max(other.smoothed),
            evidence: self.evidence || other.evidence,
            bounds: self.bounds || other.bounds,
        }
    }
}

impl Default for Wanted {
    fn default() -> Self {
        Self { diagnostics: true, smoothed: Hindsight::All, ..Self::NOTHING }
    }
}

/// A Cramér-Rao bound and the filters that it applies to.
pub struct Bound {
    /// The bound.
    pub bound: CramerRao,
    /// The filters' ids.
    pub filters: Vec<u32>,
}

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
