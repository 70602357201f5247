//! The programs in WGSL, put together from their parts and the lists of a plant and its sensors.

use kalmanscope_core::internals::Reading;
use kalmanscope_core::internals::engine::{Design, Method, Node, Notes};
use kalmanscope_core::{Channel, Propagation};

use crate::layout::StateShape;
use crate::text::{ShaderText, literal, unrolled};

/// As in `main.wgsl`.
pub(crate) const GROUP: u32 = 64;

/// Limits the components of a state: registers keep them by unrolled loops, and programs become too long with more.
pub(crate) const MOST: usize = 9;

const COMMON: [&str; 8] = [
    include_str!("shader/layout.wgsl"),
    include_str!("shader/numbers.wgsl"),
    include_str!("shader/functions.wgsl"),
    include_str!("shader/belief.wgsl"),
    include_str!("shader/predict.wgsl"),
    include_str!("shader/update.wgsl"),
    include_str!("shader/scores.wgsl"),
    include_str!("shader/main.wgsl"),
];

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ShaderProgram {
    pub(crate) text: String,
    pub(crate) shape: StateShape,
}

impl ShaderProgram {
    /// The first `known` channels have a known truth. `None` if the plant has no list, or a constant is beyond single precision.
    pub(crate) fn new(design: &Design, channels: &[Channel], known: usize) -> Option<Self> {
        let Design { model, method, readings, has_slope, .. } = design;
        if model.size > MOST {
            return None;
        }
        let notes = Notes::of(model, readings)?;
        let shape = StateShape { size: model.size, sensors: readings.len(), known };
        let is_linear = readings.iter().all(Reading::is_of_components);
        let numbers = whole(design, channels, shape);
        let mut text: String = numbers.iter().map(|(name, number)| format!("const {name} = {number}u;\n")).collect();
        text.push_str(&format!("const HAS_SLOPE = {has_slope};\nconst KNOWS_TRUTH = {};\n", known > 0));
        let mut parts = COMMON.to_vec();
        match method {
            Method::Linearised(propagation, _) => {
                parts.push(include_str!("shader/linearised.wgsl"));
                parts.push(match propagation {
                    Propagation::LocalLinearisation if model.is_oscillator() => include_str!("shader/oscillator.wgsl"),
                    Propagation::LocalLinearisation => include_str!("shader/exponential.wgsl"),
                    Propagation::Euler | Propagation::RungeKutta => include_str!("shader/stages.wgsl"),
                });
                text.push_str(&derived(notes.clone(), "rates", ["M", "BY"], &notes.rates)?);
            }
            Method::SquareRoot(_) => return None,
            Method::SigmaPoints(rule) => {
                let (distance, offset) = (literal(rule.spread.sqrt())?, literal(rule.offset)?);
                text.push_str(&format!("const DISTANCE = {distance};\nconst OFFSET = {offset};\n"));
                parts.push(include_str!("shader/sigma_points.wgsl"));
                text.push_str(&apart(&notes, "rates", "M", &notes.rates)?);
            }
        }
        if is_linear || matches!(method, Method::Linearised(..)) {
            parts.push(include_str!("shader/gradient.wgsl"));
            text.push_str(&derived(notes.clone(), "readings", ["S", "READ"], &notes.readings)?);
        } else {
            parts.push(include_str!("shader/points.wgsl"));
            text.push_str(&apart(&notes, "readings", "S", &notes.readings)?);
        }
        let pushes: Option<Vec<String>> = model.by_force.iter().map(|&by| literal(by)).collect();
        text.push_str(&format!(
            "fn rates_by_force() -> array<f32, M> {{\n  return array<f32, M>({});\n}}\n",
            pushes?.join(", ")
        ));
        let has_parts = numbers.iter().any(|&(name, count)| name == "PARTS" && count > 1);
        for part in parts {
            text.push('\n');
            let part = if has_parts { part.to_owned() } else { part.replace("part += 1u", "part++") };
            text.push_str(&unrolled(&part, &numbers));
        }
        Some(Self { text, shape })
    }
}

fn whole(design: &Design, channels: &[Channel], shape: StateShape) -> [(&'static str, usize); 17] {
    let Design { model, method, substeps, white, .. } = design;
    let (n, moving, sensors, known) = (shape.size, model.moving(), shape.sensors.max(1), shape.known.max(1));
    [
        ("N", n),
        ("M", moving),
        ("S", sensors),
        ("K", known),
        ("TRIANGLE", shape.triangle()),
        ("SQUARE", n * n),
        ("BLOCK", moving * moving),
        ("BY", moving * n),
        ("READ", sensors * n),
        ("WIDTH", n + 1 + moving),
        ("GAIN", model.gain.unwrap_or(n)),
        ("PARTS", white.map_or(*substeps, |(_, course)| course.steps(*substeps).0)),
        ("RENEWED", white.map_or(0, |(_, course)| course.steps(*substeps).1)),
        ("WHITE", white.map_or(0, |(place, _)| place)),
        ("FREQUENCY", channels.iter().position(|&channel| channel == Channel::NATURAL_FREQUENCY).unwrap_or(0)),
        ("MIRRORED", mirrored(channels, shape.known)),
        ("STAGES", if *method == Method::Linearised(Propagation::Euler, 1) { 1 } else { 4 }),
    ]
}

fn mirrored(channels: &[Channel], known: usize) -> usize {
    let has_frequency = channels.contains(&Channel::NATURAL_FREQUENCY);
    let bits = channels.iter().take(known).enumerate().filter(|(_, channel)| has_frequency && channel.is_mirrored());
    bits.map(|(place, _)| 1 << place).sum()
}

/// A row of the readings' derivatives has few entries, and is multiplied by the rest of the mean, and by L, entry by entry.
fn derived(mut notes: Notes, name: &str, [count, product]: [&str; 2], nodes: &[Node]) -> Option<String> {
    let size = notes.size;
    let outputs: Vec<(usize, Node)> = nodes.iter().copied().enumerate().collect();
    let mut entries = Vec::new();
    for &(row, node) in &outputs {
        for component in 0..size {
            let entry = notes.builder.derivative(node, component);
            if notes.builder.value(entry) != Some(0.0) {
                entries.push((row * size + component, entry));
            }
        }
    }
    if notes.builder.is_too_long() {
        return None;
    }
    let text = ShaderText { builder: &notes.builder, size };
    let values = text.function(name, &format!("array<f32, {count}>"), &outputs, false)?;
    let mut all = values + &text.function(&format!("{name}_by"), &format!("array<f32, {product}>"), &entries, false)?;
    if name == "readings" {
        let of_row = |row: usize, first: usize| {
            let entries = entries.iter().map(move |(place, _)| *place);
            entries.filter(move |place| place / size == row && place % size >= first)
        };
        let rests: Vec<(usize, Vec<String>)> = (0..nodes.len())
            .map(|row| (row, of_row(row, 0).map(|at| format!("by[{at}] * (*b).rest[{}]", at % size)).collect()))
            .collect();
        let root = |at: usize, j: usize| {
            let i = at % size;
            format!("by[{at}] * (*b).root[{}]", i * (i + 1) / 2 + j)
        };
        let through: Vec<(usize, Vec<String>)> = (0..nodes.len() * size)
            .map(|at| (at, of_row(at / size, at % size).map(|place| root(place, at % size)).collect()))
            .collect();
        all.push_str(&sums("readings_of_rest", "S", &rests));
        all.push_str(&sums("readings_through", "READ", &through));
    }
    Some(all)
}

fn sums(name: &str, count: &str, sums: &[(usize, Vec<String>)]) -> String {
    let array = format!("array<f32, {count}>");
    let mut text =
        format!("fn {name}(b: ptr<function, Belief>, by: array<f32, READ>) -> {array} {{\n  var out: {array};\n");
    for (place, terms) in sums.iter().filter(|(_, terms)| !terms.is_empty()) {
        text.push_str(&format!("  out[{place}] = {};\n", terms.join(" + ")));
    }
    text + "  return out;\n}\n"
}

fn apart(notes: &Notes, name: &str, count: &str, nodes: &[Node]) -> Option<String> {
    let outputs: Vec<(usize, Node)> = nodes.iter().copied().enumerate().collect();
    let text = ShaderText { builder: &notes.builder, size: notes.size };
    let array = format!("array<f32, {count}>");
    let values = text.function(name, &array, &outputs, false)?;
    Some(values + &text.function(&format!("{name}_apart"), &array, &outputs, true)?)
}
