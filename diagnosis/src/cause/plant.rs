//! What a plant lacks: other springs and dampings, a mode, forces that nobody records.

use std::f64::consts::TAU;

use kalmanscope_core::filter::FilterKind;
use kalmanscope_core::setting::Edit;
use kalmanscope_core::{Channel, PlantKind};
use toml::{Table, Value};

use super::{BadFilter, Cause, LikelyCause};
use crate::words::short;

pub(super) static SPRING: Cause = Cause {
    key: "spring",
    name: "a spring that hardens, softens or yields",
    hint: "A linear plant is right for small motion only. Choose a plant with a cubic spring, or one that yields.",
    likely_causes: spring,
};

fn spring(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let believed = bad.filter.plant.as_ref().unwrap_or(&bad.scenario.plant.kind);
    let size = bad.size();
    let Some(frequency) = bad.frequency().filter(|_| size != 0.0 && size.is_finite()) else { return };
    let weight = 0.4 * bad.effect_of_pattern();
    let square = 1.0 / (size * size);
    if *believed != PlantKind::DUFFING {
        let mut edits = vec![bad.edit("plant", PlantKind::DUFFING.key())];
        // At the usual displacement, σ of the cubic force is three tenths of the linear one.
        edits.extend(bad.begins(Channel::CUBIC_STIFFNESS.key(), 0.0, 0.3 * frequency * frequency * square));
        let said = ["the spring hardens: it has a cubic part", "the spring softens: it has a negative cubic part"];
        let likely = LikelyCause::new(cause, weight, 1.0, edits, "the spring has a cubic part".to_owned());
        found.push(LikelyCause { sign: Some((Channel::CUBIC_STIFFNESS, said)), ..likely });
    }
    // With the other exponent β and γ have the size of the old ones times or over the displacement.
    let exponents =
        [(PlantKind::BOUC_WEN, PlantKind::BOUC_WEN_1, size), (PlantKind::BOUC_WEN_1, PlantKind::BOUC_WEN, 1.0 / size)];
    let yields = [Channel::HYSTERESIS_BETA, Channel::HYSTERESIS_GAMMA];
    if let Some((_, kind, by)) = exponents.into_iter().find(|(own, ..)| own == believed) {
        let mut edits = vec![bad.edit("plant", kind.key())];
        for channel in yields {
            let [mean, std] = [&bad.filter.initial_mean, &bad.filter.initial_std].map(|of| by * of[channel]);
            edits.extend(bad.begins(channel.key(), mean, std));
        }
        found.push(LikelyCause::new(cause, weight, 0.0, edits, "the spring yields with the other exponent".to_owned()));
    } else {
        let mut edits = vec![bad.edit("plant", PlantKind::BOUC_WEN.key())];
        edits.extend(yields.iter().flat_map(|channel| bad.begins(channel.key(), 0.5 * square, 0.4 * square)));
        edits.push(bad.entry("initial_std", Channel::HYSTERETIC_DISPLACEMENT, 0.5 * size));
        edits.push(bad.entry("process_std", Channel::HYSTERETIC_DISPLACEMENT, 1e-3 * size));
        let likely = LikelyCause::new(cause, weight, 2.0, edits, "the spring yields".to_owned());
        found.push(LikelyCause { softens: true, ..likely });
    }
}

/// The stiffness of both storeys over the square of the lower frequency of two equal storeys: `(1 + √5)² / 4`.
const STIFFNESS: f64 = 2.618;

pub(super) static MISSING_MODE: Cause = Cause {
    key: "missing_mode",
    name: "a mode that the model lacks",
    hint: "A peak in the spectrum of the innovations is a mode that the model lacks. Add one more mass.",
    likely_causes: |bad, cause, found| {
        let believed = bad.filter.plant.as_ref().unwrap_or(&bad.scenario.plant.kind);
        let Some(frequency) = bad.frequency().filter(|_| believed.masses() == 1) else { return };
        let weight = 0.6 * bad.effect_of_lines();
        let when = bad.line().map_or(String::new(), |(_, frequency)| format!(", near {} rad/s", short(frequency)));
        for frequency in std::iter::once(frequency).chain(bad.measured_peak()) {
            let stiffness = STIFFNESS * frequency * frequency;
            let mut edits = vec![bad.edit("plant", PlantKind::SHEAR_2.key())];
            for mass in 0..2 {
                edits.extend(bad.begins(Channel::stiffness(mass).key(), stiffness, 0.3 * stiffness));
            }
            edits.extend(bad.begins(Channel::STOREY_DAMPING.key(), 0.1 * frequency, 0.1 * frequency));
            let second = [Channel::displacement(1), Channel::velocity(1)];
            for (first, second) in [Channel::DISPLACEMENT, Channel::VELOCITY].into_iter().zip(second) {
                edits.push(bad.entry("initial_std", second, bad.filter.initial_std[first]));
                edits.push(bad.entry("process_std", second, bad.filter.process_std[first]));
            }
            let likely = LikelyCause::new(cause, weight, 1.0, edits, format!("the model lacks a mode{when}"));
            found.push(LikelyCause { renews_guess: true, ..likely });
        }
    },
};

const FREE: f64 = 0.3;

/// The tried changes of the force over one period of the oscillator, relative to the force that moves the spring.
const CHANGES: [f64; 3] = [0.03, 0.3, 2.0];

pub(super) static UNKNOWN_FORCE: Cause = Cause {
    key: "unknown_force",
    name: "a force that is not recorded",
    hint: "Wind, a rotor or a moving load: a slow force pushes innovations to one side for a while. Let the filter \
           estimate it as a random walk. It also absorbs a part of spring and damping, and σ of ζ grows.",
    likely_causes: |bad, cause, found| {
        let case = bad.case;
        let Some(frequency) = bad.frequency() else { return };
        let force = frequency * frequency * bad.size();
        if bad.filter.augment.contains(&Channel::UNKNOWN_FORCE) || !(force > 0.0 && force.is_finite()) {
            return;
        }
        let first = case.sensors.iter().map(|one| one.first_correlation(&case.kept).1).fold(0.0, f64::max);
        let weight = first / (1.0 + first);
        let period = TAU / frequency / case.record.dt();
        let periods = case.len() as f64 / period;
        for change in CHANGES {
            let edits = vec![
                bad.augmented(Channel::UNKNOWN_FORCE),
                bad.entry("initial_std", Channel::UNKNOWN_FORCE, force),
                bad.entry("process_std", Channel::UNKNOWN_FORCE, change * force / period.sqrt()),
            ];
            let sentence = "the record lacks a force that changes slowly".to_owned();
            // A force that changes freely fits any record: its freedom has a price on top of that of its two values.
            let fitted = 2.0 + periods * change / FREE;
            found.push(LikelyCause::new(cause, weight, fitted, edits, sentence));
        }
    },
};

struct Component {
    key: &'static str,
    parameter: Option<[&'static str; 3]>,
    mean: f64,
    std: f64,
}

/// The natural frequency \[rad/s\] and the root mean square of the displacement \[m\], where the plant is one linear oscillator.
fn oscillator(bad: &BadFilter<'_>) -> Option<(f64, f64)> {
    let believed = bad.filter.plant.as_ref().unwrap_or(&bad.scenario.plant.kind);
    let (frequency, size) = (bad.frequency()?, bad.size());
    let is_linear = *believed == PlantKind::SDOF && bad.filter.kind != FilterKind::KF;
    (is_linear && size > 0.0 && size.is_finite() && frequency > 0.0).then_some((frequency, size))
}

fn edits_of(bad: &BadFilter<'_>, equation: &str, components: &[Component]) -> Vec<Edit> {
    let text = |text: &str| Value::String(text.to_owned());
    let of_parameter = |one: &Component| {
        let [name, unit, sign] = one.parameter?;
        let entries =
            [("name", name), ("unit", unit), ("sign", sign)].map(|(key, entry)| (key.to_owned(), text(entry)));
        Some((one.key.to_owned(), Value::Table(Table::from_iter(entries))))
    };
    let parameters: Table = components.iter().filter_map(of_parameter).collect();
    let plant = [("equation", text(equation)), ("parameters", Value::Table(parameters))];
    let plant = plant.map(|(key, value)| (key.to_owned(), value));
    let mut edits = vec![bad.edit("plant", Table::from_iter(plant))];
    edits.extend(components.iter().flat_map(|one| bad.begins(one.key, one.mean, one.std)));
    edits
}

struct Term {
    cause: &'static Cause,
    term: &'static str,
    key: &'static str,
    parameter: [&'static str; 3],
    mean: f64,
    std: fn(f64, f64) -> f64,
    sentence: &'static str,
}

static TERMS: [Term; 5] = [
    Term {
        cause: &DRY_FRICTION,
        term: "d tanh(x'/@)",
        key: "d",
        parameter: ["friction", "m/s²", "not_negative"],
        mean: 1.0,
        std: |frequency, size| 0.05 * frequency * frequency * size,
        sentence: "there is dry friction, which has the same size at any speed",
    },
    Term {
        cause: &DRAG,
        term: "c abs(x') x'",
        key: "c",
        parameter: ["drag", "1/m", "not_negative"],
        mean: 1.0,
        std: |_, size| 0.1 / size,
        sentence: "there is drag, which grows with the square of the speed",
    },
    Term {
        cause: &UNEVEN_SPRING,
        term: "q x²",
        key: "q",
        parameter: ["uneven stiffness", "1/(m s²)", "any"],
        mean: 0.0,
        std: |frequency, size| 0.3 * frequency * frequency / size,
        sentence: "the spring is stiffer on one side, and more so at larger displacements",
    },
    Term {
        cause: &UNEVEN_SPRING,
        term: "s (x + abs(x))",
        key: "s",
        parameter: ["stiffness of one side", "1/s²", "any"],
        mean: 0.0,
        std: |frequency, _| 0.2 * frequency * frequency,
        sentence: "the spring is stiffer on one side, as with a crack that opens or a stop",
    },
    Term {
        cause: &DAMPING_OF_SWING,
        term: "b x² x'",
        key: "b",
        parameter: ["damping of large swings", "1/(m² s)", "any"],
        mean: 0.0,
        std: |frequency, size| 0.1 * frequency / (size * size),
        sentence: "the damping grows with the amplitude",
    },
];

pub(super) static DRY_FRICTION: Cause = Cause {
    key: "dry_friction",
    name: "dry friction",
    hint: "Dry friction has the same size at any speed: the amplitude decays along a straight line, and the motion \
           stops. Choose an equation with such a term.",
    likely_causes: terms,
};

pub(super) static DRAG: Cause = Cause {
    key: "drag",
    name: "drag, as of air or water",
    hint: "Large motion decays fast, small motion hardly. Choose an equation with such a term.",
    likely_causes: terms,
};

pub(super) static UNEVEN_SPRING: Cause = Cause {
    key: "uneven_spring",
    name: "a spring that is stiffer on one side",
    hint: "A crack, a stop or a bent spring: the motion is larger on one side. Choose an equation with such a term.",
    likely_causes: terms,
};

pub(super) static DAMPING_OF_SWING: Cause = Cause {
    key: "damping_of_swing",
    name: "damping that grows with the amplitude",
    hint: "As in van der Pol's oscillator, damping depends on the displacement. Choose an equation with such a term.",
    likely_causes: terms,
};

/// The speed below which friction is less than whole, over the root mean square of all speeds: a jump has no derivative.
const SLOW: f64 = 0.05;

fn terms(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let Some((frequency, size)) = oscillator(bad) else { return };
    let slow = SLOW * frequency * size;
    let scaled = format!("{slow:.1e}");
    let rounded = scaled.parse().unwrap_or(slow);
    let slow = if (1e-4..1e6).contains(&rounded) { rounded.to_string() } else { scaled };
    for Term { term, key, parameter, mean, std, sentence, .. } in TERMS.iter().filter(|one| one.cause.key == cause.key)
    {
        let equation = format!("x'' + 2 ζ ωₙ x' + ωₙ² x + {} = f", term.replace('@', &slow));
        let std = std(frequency, size);
        let component = Component { key, parameter: Some(*parameter), mean: mean * std, std };
        let edits = edits_of(bad, &equation, &[component]);
        found.push(LikelyCause::new(cause, 0.4 * bad.effect_of_pattern(), 1.0, edits, (*sentence).to_owned()));
    }
}

pub(super) static PERIODIC_FORCE: Cause = Cause {
    key: "periodic_force",
    name: "a periodic force that is not recorded",
    hint: "A motor or the mains adds a peak to the spectrum that no mode explains. Choose an equation in which a \
           second, undamped oscillator is that force. The filter estimates its frequency too.",
    likely_causes: |bad, cause, found| {
        let Some((frequency, size)) = oscillator(bad) else { return };
        let Some((_, line)) = bad.line().filter(|(height, line)| *height >= LINE && *line > 0.0) else { return };
        let weight = 0.6 * bad.effect_of_lines();
        let force = size * (frequency * frequency - line * line).abs().max(0.1 * frequency * frequency);
        let components = swing(bad, force, [line, 0.01], "frequency of the force");
        let edits = edits_of(bad, "x'' + 2 ζ ωₙ x' + ωₙ² x = f + u; u' = s; s' = -w² u", &components);
        let sentence = format!("the record lacks a periodic force of {} rad/s", short(line));
        found.push(LikelyCause::new(cause, weight, 3.0, edits, sentence));
    },
};

pub(super) static SWINGING_STIFFNESS: Cause = Cause {
    key: "swinging_stiffness",
    name: "a stiffness that varies with time",
    hint: "A rope with varying tension, a moving pivot or a gear: the stiffness varies with time. Choose an equation \
           in which a second, undamped oscillator is that variation. The filter estimates its frequency too.",
    likely_causes: |bad, cause, found| {
        // A swing of the stiffness at w makes lines at w - ωₙ and w + ωₙ.
        let Some((frequency, _)) = oscillator(bad) else { return };
        let Some((_, line)) = bad.line().filter(|(height, _)| *height >= LINE) else { return };
        let estimates = bad.case.estimates;
        let place = estimates.place(Channel::NATURAL_FREQUENCY);
        let own = place.map_or(frequency, |place| estimates.canonical_mean(estimates.len() - 1, place));
        for frequency in [line + own, (line - own).abs()].into_iter().filter(|frequency| *frequency > 0.1 * own) {
            let components = swing(bad, 0.3, [frequency, 0.04], "frequency of the swing");
            let equation = "x'' + 2 ζ ωₙ x' + ωₙ² (1 + u) x = f; u' = s; s' = -w² u";
            let edits = edits_of(bad, equation, &components);
            let sentence = format!("the stiffness varies with time, at about {} rad/s", short(frequency));
            found.push(LikelyCause::new(cause, 0.4 * bad.effect_of_pattern(), 3.0, edits, sentence));
        }
    },
};

/// A line this far above the mean power is worth a trial.
const LINE: f64 = 8.0;

/// The components of a swing in time by `u' = s; s' = -w² u`: its size at first, its frequency \[rad/s\] and a share of it.
fn swing(bad: &BadFilter<'_>, size: f64, [frequency, share]: [f64; 2], name: &'static str) -> [Component; 3] {
    let seconds = bad.case.len() as f64 * bad.case.record.dt();
    let width = (TAU / seconds).max(share * frequency);
    [
        Component { key: "u", parameter: None, mean: 0.0, std: size },
        Component { key: "s", parameter: None, mean: 0.0, std: size * frequency },
        Component { key: "w", parameter: Some([name, "rad/s", "positive"]), mean: frequency, std: width },
    ]
}

pub(super) static CREEP: Cause = Cause {
    key: "creep",
    name: "a damper or a spring that creeps",
    hint: "Rubber, oil in a gap, a coil that feeds back: a part of the force lags the motion. Choose an equation in \
           which that force has a time constant.",
    likely_causes: creep,
};

fn creep(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let Some((frequency, size)) = oscillator(bad) else { return };
    let components = [
        Component { key: "z", parameter: None, mean: 0.0, std: frequency * size },
        Component { key: "b", parameter: Some(["late damping", "1/s", "any"]), mean: 0.0, std: 0.3 * frequency },
        Component { key: "a", parameter: Some(["corner", "rad/s", "positive"]), mean: frequency, std: 0.5 * frequency },
    ];
    let edits = edits_of(bad, "x'' + 2 ζ ωₙ x' + ωₙ² x + b z = f; z' = a (x' - z)", &components);
    let sentence = "a part of the damping lags the motion".to_owned();
    let likely = LikelyCause::new(cause, 0.4 * bad.effect_of_pattern(), 2.0, edits, sentence);
    found.push(LikelyCause { softens: true, ..likely });
}
