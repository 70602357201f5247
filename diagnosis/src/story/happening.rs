//! What happens to the oscillator: the sentence of the truth.

use std::f64::consts::TAU;

use kalmanscope_core::scenario::{Fault, Sensor};
use kalmanscope_core::signal::{Ramp, Sine, Step};
use kalmanscope_core::{Channel, Force, InputKind, Run, Scenario, Signal};

use super::{Adjustable, Phrase, Writer};
use crate::words::plain;

/// After a sudden change it is too early for a judgement for this time, or for a period of the motion if that is longer \[s\].
const SETTLING: f64 = 1.0;

pub(super) struct TrueChange {
    pub(super) channel: Channel,
    pub(super) signal: Signal,
}

impl TrueChange {
    pub(super) fn start(&self) -> f64 {
        match self.signal {
            Signal::Constant(_) | Signal::Sine(_) => 0.0,
            Signal::Step(Step { at, .. }) => at,
            Signal::Ramp(Ramp { start, .. }) => start,
        }
    }

    pub(super) fn is_recent(&self, run: &Run, now: f64) -> bool {
        let Some(step) = self.step() else { return false };
        let scenario = run.scenario();
        let frequency = scenario.plant.parameter(Channel::NATURAL_FREQUENCY).map_or(f64::NAN, |signal| signal.at(now));
        let period = if frequency > 0.0 { TAU / frequency } else { 0.0 };
        (step.at..step.at + SETTLING.max(period)).contains(&now)
    }

    pub(super) fn step(&self) -> Option<Step> {
        if let Signal::Step(step) = self.signal { Some(step) } else { None }
    }

    fn text(&self, now: f64, duration: f64) -> Writer {
        let Self { channel, signal } = *self;
        let key = |end: &str| format!("plant.{}.{end}", channel.key());
        let time = |end: &str, value: f64| Adjustable::new(key(end), value, (0.0, duration), "s");
        let value = |end: &str, value: f64| {
            let (low, high) = channel.usual().slider;
            Adjustable::new(key(end), value, (low, high), channel.unit())
        };
        let text = Writer::default();
        match signal {
            Signal::Constant(_) => text,
            Signal::Step(Step { from, to, at }) => {
                let (will, s) = if now < at { ("will ", "") } else { ("", "s") };
                let text = text.say("At ").setting(time("step.at", at));
                if channel == Channel::NATURAL_FREQUENCY && from > 0.0 && to > 0.0 {
                    let verb = if to < from { "lose" } else { "gain" };
                    let share = Adjustable::stiffness(key("step.to"), from, to);
                    return text.say(format!(" the spring {will}{verb}{s} ")).setting(share).say(" of its stiffness");
                }
                let verb = if to < from { "fall" } else { "rise" };
                let words = format!(" {} {will}{verb}{s} from {} to ", named(channel), plain(from));
                text.say(words).setting(value("step.to", to))
            }
            Signal::Ramp(Ramp { from, to, start, end }) => {
                let verb = if to < from { "falls" } else { "rises" };
                let text = text.say(format!("{} {verb} slowly from {} to ", capital(&named(channel)), plain(from)));
                let text = text.setting(value("ramp.to", to)).say(", from ");
                text.setting(time("ramp.start", start)).say(" to ").setting(time("ramp.end", end))
            }
            Signal::Sine(Sine { mean, amplitude, period }) => {
                let text = text.say(format!("{} varies by ", capital(&named(channel))));
                let text =
                    text.setting(value("sine.amplitude", amplitude)).say(format!(" around {}, every ", plain(mean)));
                text.setting(Adjustable::new(key("sine.period"), period, (0.1, 2.0 * duration), "s"))
            }
        }
    }
}

fn moves(signal: &Signal, duration: f64) -> bool {
    match *signal {
        Signal::Constant(_) => false,
        Signal::Step(Step { from, to, at }) => from != to && at > 0.0 && at < duration,
        Signal::Ramp(Ramp { from, to, start, end }) => from != to && end > 0.0 && start < duration,
        Signal::Sine(Sine { amplitude, .. }) => amplitude != 0.0,
    }
}

pub(super) fn changes_of(scenario: &Scenario) -> Vec<TrueChange> {
    let change = |channel| {
        let signal = scenario.plant.parameter(channel)?;
        moves(&signal, scenario.duration).then_some(TrueChange { channel, signal })
    };
    scenario.plant.parameters().filter_map(change).filter(|_| scenario.record.is_none()).collect()
}

pub(super) fn sentence(changes: &[TrueChange], run: &Run) -> Vec<Phrase> {
    let scenario = run.scenario();
    let now = scenario.dt * run.done().saturating_sub(1) as f64;
    let text = match changes.first() {
        Some(change) => change.text(now, scenario.duration),
        None => still(scenario),
    };
    let text = if changes.len() > 1 { text.say(", and other parameters change too") } else { text };
    let hidden = if scenario.plant.disturbance_std > 0.0 { "; an unmeasured force shakes it too" } else { "" };
    text.say(hidden).say(".").0
}

pub(super) fn faults(scenario: &Scenario) -> Vec<Vec<Phrase>> {
    let all = scenario.sensors.iter().flat_map(|sensor| sensor.faults.families().map(move |fault| (sensor, fault)));
    all.take(2).map(|(sensor, fault)| fault_sentence(sensor, fault)).collect()
}

fn fault_sentence(sensor: &Sensor, fault: Fault) -> Vec<Phrase> {
    let (quantity, info) = (sensor.measures, fault.info());
    let words = info.sentence.replace('@', &quantity.name());
    let numbers = sensor.faults.numbers(fault).unwrap_or_default();
    let mut pieces = words.split("{}");
    let mut text = Writer::default().say(pieces.next().unwrap_or_default());
    for ((piece, number), &value) in pieces.zip(info.numbers).zip(numbers) {
        let key = fault.address(quantity, number);
        let size = number.scale.size(quantity);
        let (low, high) = number.slider;
        let range = (low * size, high * size);
        text = text.setting(Adjustable::new(key, value, range, number.scale.unit(quantity))).say(piece);
    }
    text.say(".").0
}

fn named(channel: Channel) -> String {
    let name = channel.name();
    if name.ends_with(|letter: char| letter.is_ascii_digit()) { name.to_owned() } else { format!("the {name}") }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn still(scenario: &Scenario) -> Writer {
    let plant = &scenario.plant;
    let named = [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];
    let known = named.into_iter().filter(|channel| plant.kind.parameters().any(|own| own == *channel));
    let name = plant.kind.name().replace(", ", " of ");
    let noun = if name.starts_with("equation") { "Your own equation".to_owned() } else { format!("A {name}") };
    let mut text = Writer::default().say(noun);
    for (place, channel) in known.enumerate() {
        let signal = plant.parameter(channel).unwrap_or(Signal::Constant(channel.usual_truth()));
        let before = if place == 0 { " with " } else { " and " };
        let number =
            Adjustable::new(format!("plant.{}", channel.key()), signal.at(0.0), channel.usual().slider, channel.unit());
        text = text.say(format!("{before}{} ", channel.symbol())).setting(number);
    }
    text.say(format!(" {}; its parameters stay constant", moved(scenario)))
}

/// The forces on single masses, in words.
fn on_masses(scenario: &Scenario) -> Option<String> {
    let numbers: Vec<String> = scenario.forces.keys().map(|mass| (mass.mass() + 1).to_string()).collect();
    let (last, rest) = numbers.split_last()?;
    Some(if rest.is_empty() {
        format!("a force on mass {last}")
    } else {
        format!("forces on masses {} and {last}", rest.join(", "))
    })
}

fn moved(scenario: &Scenario) -> String {
    let on_masses = on_masses(scenario);
    match (on_masses, scenario.force) {
        (Some(forces), Force::WhiteNoise { std: 0.0 } | Force::None) => format!("is moved by {forces}"),
        (Some(forces), _) => format!("{}, and by {forces}", moved_by_all(scenario)),
        (None, _) => moved_by_all(scenario),
    }
}

fn moved_by_all(scenario: &Scenario) -> String {
    let by_ground = matches!(scenario.input, InputKind::GroundAcceleration);
    match scenario.force {
        Force::WhiteNoise { std: 0.0 } | Force::None => {
            let motion = scenario.plant.initial;
            let is_at_rest = motion.displacement == 0.0 && motion.velocity == 0.0;
            if is_at_rest { "is at rest, and nothing moves it" } else { "is pulled aside and let go" }.to_owned()
        }
        Force::WhiteNoise { .. } if by_ground => "is shaken by its ground".to_owned(),
        Force::WhiteNoise { .. } => "is shaken by white noise".to_owned(),
        Force::Sine { frequency, .. } => format!("is driven at {} rad/s", plain(frequency)),
        Force::Chirp { from, to, .. } => format!("is driven from {} to {} rad/s", plain(from), plain(to)),
        Force::ImpulseTrain { period, .. } => format!("is struck every {} s", plain(period)),
        Force::Step { at, .. } => format!("is pushed from {} s on", plain(at)),
    }
}
