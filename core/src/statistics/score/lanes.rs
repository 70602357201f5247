//! Runs of filters over whole records, side by side.

use std::borrow::Cow;

use kalmanscope_filters::engine::level::Level;
use kalmanscope_filters::engine::model::Input;
use kalmanscope_filters::engine::number::{Mask, Number};
use kalmanscope_filters::engine::update::UpdateResult;
use kalmanscope_filters::engine::wrapper::Span;
use kalmanscope_filters::{FilterError, Stop};
use kalmanscope_records::Record;
use kalmanscope_records::record::Parts;

use crate::run::estimator::setup::{PlantFilter, Setup, filter};
use crate::run::estimator::update::InUnits;
use crate::run::forces::{Forces, PartInputs};
use crate::statistics::score::lane_sums::{LogProducts, ScoreSums};
use crate::statistics::score::{Outcome, SampleScore};

/// A filter and the record that it runs over.
#[derive(Clone, Copy, Debug)]
pub struct SetupRun<'a> {
    /// The filter.
    pub setup: &'a Setup,
    /// The record.
    pub record: &'a Record,
}

impl SetupRun<'_> {
    /// Whether two runs can go side by side: design, length and known channels are the same, and times of their own those of one record.
    pub fn goes_with(&self, other: &Self) -> bool {
        let knows = |record: &Record, channel| record.truth(channel).is_some();
        self.record.len() == other.record.len()
            && self.setup.design == other.setup.design
            && self.setup.of_batch == other.setup.of_batch
            && self.setup.is_timed == other.setup.is_timed
            && (!(self.setup.is_timed || self.has_forces() || other.has_forces()) || self.has_columns_of(other))
            && self.setup.channels == other.setup.channels
            && (self.setup.channels.iter()).all(|&channel| knows(self.record, channel) == knows(other.record, channel))
    }

    fn has_forces(&self) -> bool {
        !self.record.forced().is_empty()
    }

    fn has_columns_of(&self, other: &Self) -> bool {
        std::ptr::eq(self.record, other.record)
            && (&self.setup.columns, &self.setup.delays) == (&other.setup.columns, &other.setup.delays)
    }
}

/// The outcomes of at most as many runs as there are lanes, which [go with](SetupRun::goes_with) the first, scored at some samples.
pub fn outcomes<T: Number, L: Level>(level: L, runs: &[SetupRun<'_>], samples: &[usize]) -> Vec<Outcome> {
    let [first, ..] = runs else { return Vec::new() };
    let channels = &first.setup.channels;
    let of = |lane: usize| runs[lane.min(runs.len() - 1)];
    let is_shared = runs.iter().all(|run| run.has_columns_of(first));
    let inputs = LaneInputs::new(runs, is_shared, T::LANES);
    let filter = filter(&|lane| of(lane).setup);
    let scores = ScoreSums::new(channels, |channel| first.record.truth(channel).is_some(), first.record.len(), 0);
    let mut in_units = InUnits::new(&first.setup.design.model.logarithms, filter.belief.mean.len(), 0);
    in_units.iter_mut().for_each(|in_units| in_units.convert(&filter.belief));
    let batch = LaneBatch {
        level,
        count: runs.len(),
        filter,
        in_units,
        scores,
        stopped: T::of(0.0),
        of_parts: LogProducts::new(),
        outcomes: vec![None; runs.len()],
        sample_scores: vec![Vec::new(); runs.len()],
    };
    level.apart(
        #[inline(always)]
        || batch.run(&inputs, first.record.len(), samples),
    )
}

struct LaneInputs<'a> {
    timed: Option<SetupRun<'a>>,
    first: SetupRun<'a>,
    force: LaneColumn<'a>,
    measured: Vec<LaneColumn<'a>>,
    truth: Vec<LaneColumn<'a>>,
}

struct LaneColumn<'a>(Vec<Cow<'a, [f64]>>);

impl LaneColumn<'_> {
    #[inline(always)]
    fn at<T: Number>(&self, k: usize) -> T {
        match &self.0[..] {
            [shared] => T::of(shared[k]),
            own => Self::each(own, k),
        }
    }

    // Apart: else the compiler takes lane by lane what they share, too.
    #[inline(never)]
    fn each<T: Number>(own: &[Cow<'_, [f64]>], k: usize) -> T {
        T::from_lanes(|lane| own[lane][k])
    }
}

impl<'a> LaneInputs<'a> {
    fn new(runs: &[SetupRun<'a>], is_shared: bool, lanes: usize) -> Self {
        let lanes = if is_shared { 1 } else { lanes };
        let column = |of: &dyn Fn(SetupRun<'a>) -> Cow<'a, [f64]>| {
            LaneColumn((0..lanes).map(|lane| of(runs[lane.min(runs.len() - 1)])).collect())
        };
        let force = |SetupRun { setup, record }: SetupRun<'a>| {
            (0..record.len()).map(|k| record.delayed_force(k, setup.delays.input)).collect()
        };
        let measured = |place: usize| {
            column(&|SetupRun { setup, record }| {
                let (from, late) = (setup.columns[place], setup.delays.of(place));
                let readings = || (0..record.len()).map(|k| record.late_reading(from, k, late)).collect();
                if late == 0.0 { Cow::Borrowed(record.measured(from)) } else { Cow::Owned(readings()) }
            })
        };
        let setup = runs[0].setup;
        let known = setup.channels.iter().filter(|&&channel| runs[0].record.truth(channel).is_some());
        let truth =
            |&channel| column(&|run: SetupRun<'a>| Cow::Borrowed(run.record.truth(channel).unwrap_or_default()));
        Self {
            timed: setup.is_timed.then_some(runs[0]),
            first: runs[0],
            force: column(&force),
            measured: (0..setup.columns.len()).map(measured).collect(),
            truth: known.map(truth).collect(),
        }
    }
}

struct LaneBatch<T: Number, L> {
    level: L,
    count: usize,
    filter: PlantFilter<T>,
    in_units: Option<Box<InUnits<T>>>,
    scores: ScoreSums<T>,
    stopped: T,
    of_parts: LogProducts<T>,
    outcomes: Vec<Option<Outcome>>,
    sample_scores: Vec<Vec<SampleScore>>,
}

impl<T: Number, L: Level> LaneBatch<T, L> {
    #[inline(always)]
    fn run(mut self, inputs: &LaneInputs<'_>, length: usize, samples: &[usize]) -> Vec<Outcome> {
        let mut samples = samples.iter().copied().peekable();
        let mut measured = vec![T::of(0.0); inputs.measured.len()];
        let mut truth = vec![T::of(0.0); inputs.truth.len()];
        let mut force: T = inputs.force.at(0);
        let (SetupRun { setup, record }, mut parts) = (inputs.first, Parts::default());
        let mut forces = Forces::of(&setup.channels, record.forced(), record.hold());
        for k in 0..length {
            for (truth, column) in truth.iter_mut().zip(&inputs.truth) {
                *truth = column.at(k);
            }
            if k > 0 {
                let before = force;
                force = inputs.force.at(k);
                forces.take(record, k, setup.delays.input);
                let goes_on = match inputs.timed {
                    Some(SetupRun { setup, record })
                        if record.parts_to(k, &setup.delays, &setup.columns, &mut parts) =>
                    {
                        self.step_through(&parts, &forces, &mut measured, k)
                    }
                    _ => {
                        for (measured, column) in measured.iter_mut().zip(&inputs.measured) {
                            *measured = column.at(k);
                        }
                        self.step(forces.over([before, force]), forces.now(force), &measured, k)
                    }
                };
                if !goes_on {
                    break;
                }
            }
            let Self { level, scores, filter, in_units, .. } = &mut self;
            let belief = in_units.as_ref().map_or(&filter.belief, |in_units| &in_units.belief);
            scores.take_belief(*level, [&belief.mean, &belief.cov], &truth);
            while samples.next_if_eq(&k).is_some() {
                self.score_sample();
            }
        }
        self.finish()
    }

    fn step(&mut self, inputs: [Input<'_, T>; 2], now: Input<'_, T>, measured: &[T], k: usize) -> bool {
        let Some(update) = self.advance(1.0, inputs, now, measured, k) else { return false };
        let Self { level, scores, filter, .. } = self;
        level.apart(
            #[inline(always)]
            || {
                scores.take_update([update.nis, update.determinant], update.measured, |lane| {
                    filter.update.ln_determinant(lane)
                });
            },
        );
        true
    }

    fn step_through(&mut self, parts: &Parts, forces: &Forces, measured: &mut [T], k: usize) -> bool {
        let ([mut all_nis, mut readings], mut product) = ([T::of(0.0); 2], T::of(1.0));
        self.of_parts.clear();
        for PartInputs { share, ends, now, readings: values } in forces.through(parts) {
            let [begin, end, now] = [ends[0], ends[1], now].map(|input| input.with(T::of(input.force)));
            measured.iter_mut().zip(values).for_each(|(measured, value)| *measured = T::of(*value));
            let update = self.advance(share, [begin, end], now, measured, k);
            let Some(UpdateResult { nis, determinant, measured, .. }) = update else { return false };
            let Self { filter, of_parts, .. } = self;
            of_parts.add(determinant, |lane| filter.update.ln_determinant(lane));
            (all_nis, readings, product) = (all_nis + nis, readings + measured, product * determinant);
        }
        let Self { scores, of_parts, .. } = self;
        scores.take_update([all_nis, product], readings, |lane| of_parts.value(lane));
        true
    }

    #[inline(never)]
    fn advance(
        &mut self,
        share: f64,
        inputs: [Input<'_, T>; 2],
        now: Input<'_, T>,
        measured: &[T],
        k: usize,
    ) -> Option<UpdateResult<T>> {
        let Self { level, filter, .. } = self;
        let mut update = level.apart(
            #[inline(always)]
            || {
                filter.predict(*level, Span { share, inputs, times: [0.0; 2] });
                filter.update(*level, now, measured)
            },
        );
        let has_stopped = T::of(0.5).le(self.stopped);
        let mut fits = T::Mask::of(true);
        if let Some(in_units) = &mut self.in_units {
            in_units.convert(&self.filter.belief);
            [fits, _] = in_units.belief.check(self.level);
        }
        if !((update.holds & fits) | has_stopped).all() {
            self.stop(update.holds, fits, k);
            if self.outcomes.iter().all(Option::is_some) {
                return None;
            }
        }
        let is_going = self.stopped.lt(T::of(0.5));
        if !is_going.all() {
            update.nis = T::select(is_going, update.nis, T::of(0.0));
            update.determinant = T::select(is_going, update.determinant, T::of(1.0));
            self.park();
        }
        Some(update)
    }

    #[cold]
    #[inline(never)]
    fn stop(&mut self, holds: T::Mask, fits: T::Mask, k: usize) {
        for lane in 0..T::LANES {
            if (holds & fits).lane(lane) || self.stopped.lane(lane) > 0.0 {
                continue;
            }
            self.stopped.set_lane(lane, 1.0);
            if lane < self.count {
                let reason = if holds.lane(lane) { FilterError::NotFinite } else { self.filter.reason(lane) };
                let stop = Stop { sample: k, reason };
                self.outcomes[lane] = Some(self.outcome(lane, Some(stop)));
            }
        }
    }

    #[cold]
    #[inline(never)]
    fn park(&mut self) {
        for lane in (0..T::LANES).filter(|&lane| self.stopped.lane(lane) > 0.0) {
            self.filter.belief.park(lane);
        }
    }

    #[cold]
    #[inline(never)]
    fn score_sample(&mut self) {
        for (lane, sample_scores) in self.sample_scores.iter_mut().enumerate() {
            if self.stopped.lane(lane) == 0.0 {
                sample_scores.push(self.scores.sample_score(lane));
            }
        }
    }

    fn outcome(&mut self, lane: usize, stop: Option<Stop>) -> Outcome {
        Outcome { sample_scores: std::mem::take(&mut self.sample_scores[lane]), ..self.scores.outcome(lane, stop) }
    }

    fn finish(mut self) -> Vec<Outcome> {
        (0..self.count).map(|lane| self.outcomes[lane].take().unwrap_or_else(|| self.outcome(lane, None))).collect()
    }
}
