//! What a filter makes of a run.

use std::f64::consts::TAU;

use kalmanscope_core::diagnostics::ErrorSums;
use kalmanscope_core::internals::mapped;
use kalmanscope_core::scenario::cost::turn_at;
use kalmanscope_core::{Channel, Diagnostics, Estimates, FilterSettings, Propagation, Record, Run, Scenario, Stop};

use super::happening::TrueChange;
use super::{Adjustable, Phrase, Writer};
use crate::words::{percent_to_a_tenth, plain, seconds, with_band};
use crate::{Diagnosis, Evidence, Subject, VerdictKind};

const FOUND: f64 = 0.05;

/// The motion turns by this angle in a long step \[°\].
const LONG_STEP: f64 = 30.0;

/// The same for a Runge-Kutta step on a plant that is not linear, which then turns by a share of 10⁻⁵ too little \[°\].
const LONG_STAGES: f64 = 11.0;

const LOOKS: usize = 100;

/// The least share of the power that a band leaves white noise: noise may have colours.
const LEAST_BEHIND: f64 = 0.5;

pub(super) struct FilterOutcome<'a> {
    pub(super) filter: &'a FilterSettings,
    pub(super) name: &'a str,
    pub(super) kind: Option<VerdictKind>,
    undetermined: Vec<Channel>,
    pub(super) main: Option<Main>,
    others: Vec<Main>,
    outside: Option<Channel>,
    stop: Option<(Stop, f64)>,
    /// The angle of the motion in a step \[°\]; `None` where the band of a parameter is right.
    long_steps: Option<u8>,
    is_behind_a_band: bool,
    is_settling: bool,
    now: f64,
    is_whole: bool,
}

pub(super) struct Main {
    channel: Channel,
    mean: f64,
    pub(super) std: f64,
    truth: Option<Truth>,
}

struct Truth {
    error: f64,
    lately: f64,
    /// The time from which on it has stayed within 5 % of the truth \[s\], as in all scores.
    settled: Option<f64>,
}

type Results<'a> = (&'a Estimates, &'a Diagnostics, Option<&'a Diagnosis>);

impl<'a> FilterOutcome<'a> {
    pub(super) fn new(run: &Run, filter: &'a FilterSettings, results: Results<'a>, changes: &[TrueChange]) -> Self {
        let (estimates, diagnostics, diagnosis) = results;
        let (record, change) = (run.record(), changes.first());
        let is_uncertain = |place: usize, channel: Channel| {
            let is_taken = filter.knows(channel) || filter.consider.contains(&channel);
            !is_taken && (estimates.initial_std(place) > 0.0 || filter.process_std[channel] > 0.0)
        };
        let channels = estimates.channels().iter().copied().enumerate();
        let estimated = channels.filter(|(place, channel)| channel.is_parameter() && is_uncertain(*place, *channel));
        let mut estimated: Vec<Channel> = estimated.map(|(_, channel)| channel).collect();
        let wanted = change.map_or(Channel::NATURAL_FREQUENCY, |change| change.channel);
        if let Some(place) = wanted.place_in(&estimated) {
            estimated[..=place].rotate_right(1);
        }
        let is_outside = |channel: &Channel| {
            let error = diagnostics.error(*channel).zip(estimates.place(*channel));
            error.is_some_and(|(error, place)| error.abs() > 2.0 * estimates.std(estimates.len() - 1, place))
        };
        let outside = estimated.iter().copied().find(is_outside);
        let mut all = estimated.into_iter().filter_map(|channel| Main::of(channel, run, (estimates, diagnostics)));
        let main = all.next();
        let last = estimates.len().saturating_sub(1);
        let now = record.time(last);
        let evidence = diagnosis.map_or(&[][..], |diagnosis| &diagnosis.evidence);
        let unlearnt = evidence.iter().filter(|one| one.counts && one.speaks_for == VerdictKind::NotIdentifiable);
        let channel = |one: &Evidence| if let Subject::Channel(channel) = one.subject { Some(channel) } else { None };
        Self {
            filter,
            name: estimates.name(),
            kind: diagnosis.and_then(|diagnosis| diagnosis.verdict.as_ref()).map(|verdict| verdict.kind),
            undetermined: unlearnt.filter_map(channel).collect(),
            main,
            others: all.collect(),
            outside,
            stop: diagnostics.stop.map(|stop| (stop, record.time_of(stop.sample))),
            long_steps: long_steps(run.scenario(), filter, estimates, record),
            is_behind_a_band: is_behind_a_band(run, diagnostics),
            is_settling: changes.iter().any(|change| change.is_recent(run, now)),
            now,
            is_whole: run.done() == run.samples(),
        }
    }

    fn is_open(&self) -> bool {
        let is_surely_wrong = self.kind >= Some(VerdictKind::PatternLeft);
        self.is_settling || self.outside.is_some() && !is_surely_wrong
    }

    pub(super) fn ends_outside(&self) -> bool {
        self.kind.is_some_and(VerdictKind::is_good) && self.outside.is_some() && self.long_steps.is_none()
    }

    pub(super) fn is_early(&self) -> bool {
        self.is_open() && (self.is_settling || !self.is_whole) && self.stop.is_none()
    }

    pub(super) fn is_honest(&self) -> bool {
        let is_right = self.kind.is_some_and(|kind| kind.is_good() || kind == VerdictKind::NotIdentifiable);
        let is_small_by_a_band = self.kind == Some(VerdictKind::Underconfident) && self.is_behind_a_band;
        (is_right || is_small_by_a_band) && self.long_steps.is_none() && !self.is_open()
    }

    /// Natural frequency \[rad/s\] and damping ratio, each with its standard deviation, where no truth is known.
    pub(super) fn swing(&self) -> Option<[(f64, f64); 2]> {
        let all = self.main.iter().chain(&self.others).filter(|one| one.truth.is_none());
        let of = |channel: Channel| all.clone().find(|one| one.channel == channel).map(|one| (one.mean, one.std));
        Some([of(Channel::NATURAL_FREQUENCY)?, of(Channel::DAMPING_RATIO)?])
    }

    pub(super) fn sentence(&self, change: Option<&TrueChange>) -> Vec<Phrase> {
        // A filter cannot follow a channel that it does not estimate.
        let is_told = |change: &&TrueChange| self.main.as_ref().is_none_or(|main| main.channel == change.channel);
        let change = change.filter(is_told);
        let text = Writer::default().filter(self.filter.id, self.name);
        let memory = if self.filter.fading > 1.0 { ", which forgets (λ = " } else { ", which forgets nothing (λ = " };
        let text = if change.is_some() { text.say(memory).setting(self.fading()).say("),") } else { text };
        if let Some((stop, at)) = &self.stop {
            return text.say(" stops at ").result(seconds(*at)).say(format!(": {}.", stop.reason)).0;
        }
        let text = match self.kind {
            Some(VerdictKind::Diverged) => text.say(" has lost the truth"),
            Some(VerdictKind::Lost) => text.say(" is lost: its estimates are impossible"),
            Some(VerdictKind::Collapsed) => text.say(" has one particle left, and its band means nothing"),
            Some(VerdictKind::WoundUp) => text.say(" forgets faster than it learns, and its band grows"),
            _ => {
                let (text, is_off) = self.found(text, change);
                self.verdict(text, is_off)
            }
        };
        text.say(".").0
    }

    fn fading(&self) -> Adjustable {
        let fading = Adjustable::new(self.filter.address("fading"), self.filter.fading, (1.0, 1.05), "");
        Adjustable { has_three_decimals: true, ..fading }
    }

    pub(super) fn aside(&self, is_told: bool) -> Vec<Adjustable> {
        let guess = self.main.as_ref().map(|main| {
            let channel = main.channel;
            let guess = self.filter.initial_mean[channel];
            let (low, high) = channel.usual().slider;
            let is_usual = [guess, main.mean].iter().all(|value| (low..=high).contains(value));
            // The last estimate hardly moves while the guess is dragged, and so the range stays.
            let size = 3.0 * main.mean.abs();
            let low = if channel.is_positive() { 0.0 } else { -size };
            let range = if is_usual { channel.usual().slider } else { (low, size) };
            Adjustable::new(
                self.filter.address(&format!("initial_mean.{}", channel.key())),
                guess,
                range,
                channel.unit(),
            )
        });
        let fading = (!is_told).then(|| self.fading());
        fading.into_iter().chain(guess).collect()
    }

    fn found(&self, text: Writer, change: Option<&TrueChange>) -> (Writer, bool) {
        let Some(main) = &self.main else {
            return (text.say(" assumes known parameters"), false);
        };
        let symbol = main.channel.symbol();
        let Some(truth) = &main.truth else {
            let text = text.say(format!(" finds {symbol} = ")).result(main.text());
            let text = text.say(main.hertz().map_or(String::new(), |hertz| format!(" ({hertz})")));
            let others = self.others.iter().take(2);
            let told =
                |text: Writer, other: &Main| text.say(format!(", {} = ", other.channel.symbol())).result(other.text());
            return (others.fold(text, told).say(self.spring().unwrap_or_default()), false);
        };
        match change.filter(|change| self.now >= change.start()) {
            Some(change) if change.step().is_some() => match truth.settled.filter(|_| !self.is_outside(main.channel)) {
                Some(since) if since > change.start() => {
                    (text.say(" settles after ").result(seconds(since - change.start())), false)
                }
                Some(_) => (near(text, truth.error, symbol), false),
                None => (text.say(" is still ").result(percent_to_a_tenth(truth.error)).say(" off"), true),
            },
            Some(_) if truth.lately < FOUND => {
                (text.say(" follows it with an error of ").result(percent_to_a_tenth(truth.lately)), false)
            }
            Some(_) => (text.say(" lags behind by ").result(percent_to_a_tenth(truth.lately)), true),
            None if truth.error.abs() < FOUND => (near(text, truth.error, symbol), false),
            None => {
                let verb = if self.kind.is_none() { "begins with" } else { "has" };
                (text.say(format!(" {verb} {symbol} ")).result(percent_to_a_tenth(truth.error)).say(" off"), true)
            }
        }
    }

    fn is_outside(&self, channel: Channel) -> bool {
        self.outside == Some(channel)
    }

    fn spring(&self) -> Option<&'static str> {
        let cubic = self.others.iter().find(|other| other.channel == Channel::CUBIC_STIFFNESS)?;
        let is_sure = cubic.mean.abs() > 3.0 * cubic.std;
        is_sure.then_some(if cubic.mean > 0.0 { "; the spring hardens" } else { "; the spring softens" })
    }

    fn verdict(&self, text: Writer, is_off: bool) -> Writer {
        let is_outside = self.main.as_ref().is_some_and(|main| self.is_outside(main.channel));
        let is_known = self.main.as_ref().is_some_and(|main| main.truth.is_some());
        if self.is_early() {
            return text.say(": it is too early to judge");
        }
        let words = match self.kind {
            None => return text,
            Some(kind) if is_outside && self.is_open() => &format!(", outside its ±2σ band{}", suffix(kind)),
            Some(kind) if let Some(channel) = self.outside.filter(|_| self.is_open()) => {
                &format!(", but the true {} is outside its ±2σ band{}", channel.symbol(), suffix(kind))
            }
            Some(VerdictKind::Overconfident) if is_outside && is_off => ", and does not know it (overconfident)",
            Some(VerdictKind::Overconfident) => ", but its band is too narrow (overconfident)",
            Some(VerdictKind::PatternLeft) => ", and leaves a pattern in its innovations (pattern left)",
            Some(kind) if let Some(angle) = self.long_steps.filter(|_| kind.is_good()) => {
                let turns = format!("the motion turns by more than {angle}° in a step (add “substeps per sample”)");
                &format!(", but its band may be too narrow: {turns}")
            }
            Some(VerdictKind::Underconfident) if self.is_behind_a_band => {
                ", and its innovations are small, because the import filters them (underconfident)"
            }
            Some(VerdictKind::Underconfident) => ", but its band is too wide (underconfident)",
            Some(VerdictKind::NotIdentifiable) if !self.undetermined.is_empty() => {
                let names: Vec<&str> = mapped(&self.undetermined, &|channel| channel.symbol());
                let so_far = if self.is_whole { "" } else { "so far " };
                &format!("; {so_far}the record does not determine {} (not identifiable)", names.join(" and "))
            }
            Some(kind) if kind.is_good() && is_off => &format!(", but inside its ±2σ band{}", suffix(kind)),
            Some(VerdictKind::Consistent) if is_known => ", and its band covers it (consistent)",
            Some(VerdictKind::Consistent) => ", and its band is right (consistent)",
            Some(VerdictKind::Recovered) => ", and its band is right again (recovered)",
            _ => "",
        };
        text.say(words)
    }
}

fn near(text: Writer, error: f64, symbol: &str) -> Writer {
    let share = percent_to_a_tenth(error);
    let (verb, of) = if share.starts_with("less") { (" is within ", "of") } else { (" is ", "off") };
    text.say(verb).result(share.trim_start_matches("less than ")).say(format!(" {of} the true {symbol}"))
}

fn suffix(kind: VerdictKind) -> String {
    format!(" ({})", kind.name())
}

/// Local linearisation takes the motion for constant in a step: the band of ωₙ is 1.2 times too narrow at half a radian, 3.6 times at one.
fn long_steps(scenario: &Scenario, filter: &FilterSettings, estimates: &Estimates, record: &Record) -> Option<u8> {
    let (info, plant, dt) = (filter.kind.info(), &scenario.plant.kind, record.dt());
    let last = estimates.len().checked_sub(1).filter(|_| !info.is_sampled)?;
    let model = filter.model(plant, scenario.input);
    let step = dt / filter.steps(plant, scenario.input, dt) as f64;
    if info.has_propagation && filter.propagation_for(plant) == Propagation::LocalLinearisation {
        let place = estimates.place(Channel::NATURAL_FREQUENCY);
        let is_long = |place: &usize| {
            estimates.initial_std(*place) > 0.0
                && estimates.canonical_mean(last, *place) * step > LONG_STEP.to_radians()
        };
        return place.filter(is_long).map(|_| LONG_STEP as u8);
    }
    let mut some = (0..=LOOKS).map(|look| last * look / LOOKS);
    let is_long =
        !model.is_linear() && some.any(|k| turn_at(&model, estimates.mean(k), step) > LONG_STAGES.to_radians());
    is_long.then_some(LONG_STAGES as u8)
}

fn is_behind_a_band(run: &Run, diagnostics: &Diagnostics) -> bool {
    let Some(mapping) = run.scenario().record.as_ref().filter(|_| run.source().is_measured()) else {
        return false;
    };
    let [low, high] = mapping.passed(run.record().dt());
    let level = diagnostics.mean_nis().map_or(f64::NAN, |nis| nis.mean / nis.expected);
    level < 1.0 && level > LEAST_BEHIND * (high - low)
}

impl Main {
    fn of(channel: Channel, run: &Run, (estimates, diagnostics): (&Estimates, &Diagnostics)) -> Option<Self> {
        let place = estimates.place(channel)?;
        let last = estimates.len().checked_sub(1)?;
        let (mean, std) = (estimates.canonical_mean(last, place), estimates.std(last, place));
        let truth = diagnostics.error(channel).and_then(|error| {
            let true_value = mean - error;
            let lately = diagnostics.tally(channel, diagnostics.last_third()).map_or(f64::NAN, ErrorSums::rmse);
            (true_value != 0.0).then(|| Truth {
                error: error / true_value,
                lately: lately / true_value.abs(),
                settled: diagnostics.settled(channel).map(|sample| run.record().time_of(sample)),
            })
        });
        Some(Self { channel, mean, std, truth })
    }

    fn text(&self) -> String {
        with_band(self.mean, 2.0 * self.std, self.channel.unit())
    }

    fn hertz(&self) -> Option<String> {
        (self.channel.unit() == "rad/s").then(|| format!("{} Hz", plain(self.mean / TAU)))
    }
}
