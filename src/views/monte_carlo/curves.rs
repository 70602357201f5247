//! The numbers that are drawn, computed again when more seeds have come.

use std::ops::RangeInclusive;
use std::sync::Arc;

use egui::{Context, Id};
use kalmanscope_core::internals::sort_numbers;
use kalmanscope_core::{Channel, FilterSettings};
use kalmanscope_diagnosis::CAUSES;
use kalmanscope_diagnosis::VerdictKind;
use kalmanscope_lab::{LastError, MonteCarlo};

use crate::laboratory::{SeedRuns, Seeds};
use crate::plot::cache::cached;
use crate::view::ViewContext;

const SHARES: [f64; 3] = [0.025, 0.5, 0.975];

#[derive(Default)]
pub(super) struct SeedCurves {
    pub(super) seeds: usize,
    pub(super) times: Vec<f64>,
    pub(super) samples: Vec<usize>,
    pub(super) duration: f64,
    pub(super) parameter: Option<Channel>,
    pub(super) parameters: Vec<Channel>,
    pub(super) truth: Option<f64>,
    pub(super) is_of_errors: bool,
    pub(super) impossible: usize,
    pub(super) filters: Vec<FilterCurves>,
    pub(super) histogram: Histogram,
}

pub(super) struct FilterCurves {
    pub(super) id: u32,
    pub(super) name: String,
    pub(super) nees: Vec<f64>,
    pub(super) nees_band: Vec<Option<RangeInclusive<f64>>>,
    pub(super) nis: Vec<f64>,
    pub(super) nis_band: Vec<Option<RangeInclusive<f64>>>,
    pub(super) quantiles: Vec<[f64; 3]>,
    pub(super) std: Vec<f64>,
    pub(super) diverged: [f64; 2],
    pub(super) shares: Option<[f64; 2]>,
    pub(super) verdicts: Vec<(VerdictKind, f64)>,
    pub(super) causes: Vec<(Option<&'static str>, f64)>,
}

pub(super) fn of(ctx: &Context, seeds: &Seeds, runs: &SeedRuns, context: &ViewContext<'_>) -> Arc<SeedCurves> {
    let wanted = seeds.choice.parameter;
    cached(ctx, Id::unique("Monte Carlo"), (seeds.state.version, wanted), || Some(made(runs, wanted, context)))
}

fn made(runs: &SeedRuns, wanted: Option<Channel>, context: &ViewContext<'_>) -> SeedCurves {
    let (scenario, statistics) = (runs.scenario(), &runs.statistics);
    let record = context.session.run().record();
    let is_shown = |channel: &Channel| channel.is_parameter() && record.truth(*channel).is_some();
    let mut parameters: Vec<Channel> = Vec::new();
    for nth in 0..runs.filters.len() {
        for &channel in statistics.channels(nth).iter().filter(|channel| is_shown(channel)) {
            let at = statistics.channels(nth).iter().position(|other| *other == channel);
            // A parameter that the filter assumes known has neither errors nor a spread.
            let is_estimated = at.is_some_and(|at| statistics.std(nth, at).any(|std| std > 0.0));
            if is_estimated && !parameters.contains(&channel) {
                parameters.push(channel);
            }
        }
    }
    let parameter = wanted.filter(|wanted| parameters.contains(wanted)).or_else(|| parameters.first().copied());
    let end = scenario.dt * scenario.samples().saturating_sub(1) as f64;
    let truth = parameter.and_then(|channel| {
        let of_plant = scenario.plant.parameter(channel).map(|signal| signal.at(end));
        of_plant.or_else(|| record.truth(channel)?.last().copied())
    });
    let place = |nth: usize| {
        let place = parameter.and_then(|channel| statistics.channels(nth).iter().position(|other| *other == channel));
        place.map(|at| (at, statistics.last_errors(nth, at)))
    };
    let all = 0..runs.filters.len();
    let filters = scenario.filters.iter().enumerate();
    let filters = filters.map(|(nth, filter)| of_filter(runs, (nth, filter), place(nth))).collect();
    let is_of_errors = all.clone().filter_map(place).any(|(_, errors)| differ(errors));
    let truth = truth.filter(|_| !is_of_errors);
    let last = |nth: usize| match place(nth) {
        Some((_, errors)) if is_of_errors => errors.iter().map(|last| last.error).collect(),
        Some((at, _)) => statistics.finals(nth, at).to_vec(),
        None => Vec::new(),
    };
    let histogram = Histogram::new(&all.map(last).collect::<Vec<_>>(), truth.or(is_of_errors.then_some(0.0)));
    let samples = statistics.samples().to_vec();
    SeedCurves {
        seeds: statistics.done(),
        times: samples.iter().map(|sample| *sample as f64 * scenario.dt).collect(),
        samples,
        duration: end,
        parameter,
        parameters,
        truth,
        is_of_errors,
        impossible: statistics.impossible(),
        histogram,
        filters,
    }
}

fn of_filter(
    runs: &SeedRuns,
    (nth, filter): (usize, &FilterSettings),
    parameter: Option<(usize, &[LastError])>,
) -> FilterCurves {
    let statistics = &runs.statistics;
    let stds: Vec<Vec<f64>> =
        (0..statistics.channels(nth).len()).map(|channel| statistics.std(nth, channel).collect()).collect();
    let times = statistics.samples().len();
    // Channels of variance zero do not count in NEES.
    let degrees: Vec<usize> = (0..times).map(|time| stds.iter().filter(|std| std[time] > 0.0).count()).collect();
    let band = |degrees: &usize| {
        let interval = MonteCarlo::interval(*degrees, statistics.runs())?;
        Some(interval.start() / *degrees as f64..=interval.end() / *degrees as f64)
    };
    let sensors = runs.scenario().sensors.len();
    FilterCurves {
        id: runs.filters[nth],
        name: filter.name.clone(),
        nees: statistics.nees(nth).zip(&degrees).map(|(nees, degrees)| nees / *degrees as f64).collect(),
        nees_band: degrees.iter().map(band).collect(),
        nis: statistics.nis(nth).map(|nis| nis / sensors as f64).collect(),
        nis_band: vec![band(&sensors); times],
        quantiles: parameter.map_or_else(Vec::new, |(at, _)| statistics.quantiles(nth, at, SHARES)),
        std: parameter.map_or_else(Vec::new, |(at, _)| stds[at].clone()),
        diverged: statistics.diverged(nth),
        shares: parameter.and_then(|(_, errors)| shares(errors)),
        verdicts: shares_of(VerdictKind::ALL.into_iter().zip(statistics.verdicts(nth).iter().copied())),
        causes: {
            let (counts, unexplained) = statistics.causes(nth);
            let named = CAUSES.iter().map(|cause| Some(cause.name)).zip(counts.iter().copied());
            shares_of(named.chain([(None, unexplained)]))
        },
    }
}

fn differ(errors: &[LastError]) -> bool {
    let Some(first) = errors.first() else { return false };
    errors.iter().any(|last| (last.truth - first.truth).abs() > 1e-6 * first.truth.abs())
}

fn shares(errors: &[LastError]) -> Option<[f64; 2]> {
    let share = |is: fn(&LastError) -> bool| errors.iter().filter(|last| is(last)).count() as f64 / errors.len() as f64;
    (!errors.is_empty()).then(|| [share(|last| last.is_within(0.01)), share(LastError::is_covered)])
}

fn shares_of<T>(counts: impl Iterator<Item = (T, usize)>) -> Vec<(T, f64)> {
    let mut counts: Vec<(T, usize)> = counts.filter(|(_, count)| *count > 0).collect();
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let all = counts.iter().map(|(_, count)| count).sum::<usize>() as f64;
    counts.into_iter().map(|(kind, count)| (kind, count as f64 / all)).collect()
}

const BARS: (usize, usize) = (10, 40);

/// The share of the estimates, at either end, that may be beyond the histogram.
const TAIL: f64 = 0.01;

#[derive(Default)]
pub(super) struct Histogram {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) counts: Vec<Vec<usize>>,
    pub(super) beyond: Vec<usize>,
}

impl Histogram {
    pub(super) fn new(estimates: &[Vec<f64>], truth: Option<f64>) -> Self {
        let mut ends: Option<(f64, f64)> = None;
        for estimates in estimates {
            let mut sorted: Vec<f64> = estimates.iter().copied().filter(|value| value.is_finite()).collect();
            sort_numbers(&mut sorted);
            let Some(last) = sorted.len().checked_sub(1) else { continue };
            let tail = (TAIL * last as f64).round() as usize;
            let (low, high) = (sorted[tail], sorted[last - tail]);
            ends = Some(ends.map_or((low, high), |(l, h)| (l.min(low), h.max(high))));
        }
        let Some((low, high)) = ends else { return Self::default() };
        let (low, high) = truth.map_or((low, high), |truth| (low.min(truth), high.max(truth)));
        let margin = 0.04 * (high - low).max(1e-9 * high.abs()).max(f64::MIN_POSITIVE);
        let (from, to) = (low - margin, high + margin);
        let most = estimates.iter().map(Vec::len).max().unwrap_or_default();
        let bars = ((2.0 * (most as f64).sqrt()) as usize).clamp(BARS.0, BARS.1);
        let (mut counts, mut beyond) = (vec![vec![0; bars]; estimates.len()], vec![0; estimates.len()]);
        for (filter, estimates) in estimates.iter().enumerate() {
            for value in estimates {
                let share = (value - from) / (to - from);
                if (0.0..1.0).contains(&share) {
                    counts[filter][((share * bars as f64) as usize).min(bars - 1)] += 1;
                } else {
                    beyond[filter] += 1;
                }
            }
        }
        Self { from, to, counts, beyond }
    }

    pub(super) fn bars(&self) -> usize {
        self.counts.first().map_or(0, Vec::len)
    }

    pub(super) fn ends(&self, bar: usize) -> [f64; 2] {
        [bar, bar + 1].map(|edge| self.from + edge as f64 / self.bars() as f64 * (self.to - self.from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_estimate_is_counted_once() {
        let normal: Vec<f64> = (0..1000).map(|k| 6.0 + 0.001 * f64::from(k % 100)).collect();
        let far: Vec<f64> = normal.iter().copied().chain([1e6, f64::NAN]).collect();
        let histogram = Histogram::new(&[normal, far], Some(7.0));
        let counted = |at: usize| histogram.counts[at].iter().sum::<usize>() + histogram.beyond[at];
        assert_eq!([counted(0), counted(1)], [1000, 1002]);
        assert_eq!(histogram.beyond, [0, 2]);
        assert!(histogram.from < 6.0 && histogram.to > 7.0);
        assert_eq!(histogram.counts[0], histogram.counts[1]);
    }

    #[test]
    fn a_single_estimate_and_none_are_possible() {
        let histogram = Histogram::new(&[vec![6.0]], None);
        assert_eq!(histogram.counts[0].iter().sum::<usize>(), 1);
        assert_eq!(Histogram::new(&[vec![f64::NAN]], None).bars(), 0);
    }
}
