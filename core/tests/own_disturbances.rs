//! Forces that are not recorded and have a course of their own are part of a filter's equation.

use kalmanscope_core::record::{Input, Record};
use kalmanscope_core::{Channel, Hold, InputKind, Quantity, Scenario};

use crate::run::{finished_on, last};

const DT: f64 = 0.01;
const SAMPLES: usize = 4000;

/// Standard normal numbers that look random.
struct Normal(u64);

impl Normal {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (((x ^ (x >> 31)) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn next(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// The record of an oscillator with 6 rad/s and 5 %: of the force on it, `acts` is not recorded.
fn record(normal: &mut Normal, mut acts: impl FnMut(usize, &mut Normal) -> f64) -> Record {
    let (frequency, damping) = (6.0_f64, 0.05_f64);
    let turn = frequency * (1.0 - damping * damping).sqrt();
    let (decay, (sin, cos)) = ((-damping * frequency * DT).exp(), (turn * DT).sin_cos());
    let (mut x, mut v) = (0.0, 0.0);
    let (mut told, mut measured) = (Vec::new(), Vec::new());
    for k in 0..SAMPLES {
        told.push(4.0 * normal.next());
        measured.push(x + 0.003 * normal.next());
        let at_rest = (told[k] + acts(k, normal)) / (frequency * frequency);
        let y = x - at_rest;
        let next = at_rest + decay * (y * (cos + damping * frequency / turn * sin) + v * sin / turn);
        v = decay * (v * (cos - damping * frequency / turn * sin) - y * frequency * frequency / turn * sin);
        x = next;
    }
    let input = Input { kind: InputKind::Force, hold: Hold::Zero, values: told };
    Record::new(DT, input, vec![(Quantity::DISPLACEMENT, measured)]).unwrap()
}

/// Counts the bands of ωₙ and ζ that have the truth at the end, for each filter.
fn inside(
    filters: &str,
    seeds: u64,
    acts: impl Fn(&mut Normal) -> Box<dyn FnMut(usize, &mut Normal) -> f64>,
) -> Vec<u32> {
    let text = format!("dt = 0.01\n[[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.003\n{filters}");
    let scenario = Scenario::from_toml(&text).unwrap();
    let mut inside = vec![0; scenario.filters.len()];
    for seed in 0..seeds {
        let mut normal = Normal(seed << 32);
        let force = acts(&mut normal);
        let run = finished_on(&scenario, record(&mut normal, force));
        for (estimates, inside) in run.estimates().iter().zip(&mut inside) {
            assert_eq!(estimates.stop(), None, "seed {seed}");
            for (channel, truth) in [(Channel::NATURAL_FREQUENCY, 6.0), (Channel::DAMPING_RATIO, 0.05)] {
                let (mean, std) = last(estimates, channel);
                *inside += u32::from((mean - truth).abs() < 2.0 * std);
            }
        }
    }
    inside
}

const PLAIN: &str = "[[filters]]\nkind = \"ukf\"\n\
                     process_std = { natural_frequency = 0, damping_ratio = 0, displacement = 0, velocity = 1e-4 }\n";

#[test]
fn a_gauss_markov_force_has_its_memory_in_the_equation() {
    let (rate, std) = (2.0_f64, 1.5);
    let keep = (-rate * DT).exp();
    let step = std * (1.0 - keep * keep).sqrt();
    let told = format!(
        "[[filters]]\nkind = \"ukf\"\nplant = {{ equation = \"x'' + 2 ζ ωₙ x' + ωₙ² x = f + u; u' = -2 u\" }}\n\
         initial_std = {{ u = {std} }}\n\
         process_std = {{ natural_frequency = 0, damping_ratio = 0, displacement = 0, velocity = 1e-4, u = {step} }}\n"
    );
    let counts = inside(&format!("{PLAIN}{told}"), 16, |normal| {
        let mut force = std * normal.next();
        Box::new(move |_, normal| {
            let now = force;
            force = keep * force + step * normal.next();
            now
        })
    });
    assert!(counts[0] < 12 && counts[1] >= 27, "{counts:?} of 32 bands");
}

#[test]
fn a_sine_of_unknown_frequency_is_an_oscillator_in_the_equation() {
    let told = "[[filters]]\nkind = \"ukf\"\n\
                plant = { equation = \"x'' + 2 ζ ωₙ x' + ωₙ² x = f + u; u' = s; s' = -w² u\" }\n\
                initial_mean = { w = 10.0 }\ninitial_std = { u = 3.0, s = 30.0, w = 1.0 }\n\
                process_std = { natural_frequency = 0, damping_ratio = 0, displacement = 0, velocity = 1e-4, u = 0, s = 0, w = 0 }\n";
    let counts = inside(&format!("{PLAIN}{told}"), 16, |normal| {
        let (frequency, phase) = (9.0 + 2.0 * normal.uniform(), std::f64::consts::TAU * normal.uniform());
        Box::new(move |k, _| 3.0 * (frequency * DT * k as f64 + phase).sin())
    });
    assert!(counts[0] < 12 && counts[1] >= 27, "{counts:?} of 32 bands");
}
