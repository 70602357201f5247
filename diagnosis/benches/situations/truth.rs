//! The faults of the truth: a plant, an input or sensors that the filter does not know.

use kalmanscope_core::signal::{Ramp, Sine, Step};
use kalmanscope_core::{Channel, Force, Hold, PlantKind, Scenario, Signal};

use super::{Draw, Fault};

/// `size` is the root mean square of the displacement \[m\], `power` the density of the force \[m²/s³\].
pub(super) fn disturb(
    fault: Fault,
    truth: &mut Scenario,
    draw: &mut Draw,
    wn: f64,
    size: f64,
    power: f64,
    note: &mut String,
) {
    let rms_force = (power / truth.dt).sqrt();
    match fault {
        Fault::HardeningSpring => {
            truth.plant.kind = PlantKind::DUFFING;
            let share = draw.uniform(0.3, 1.0);
            truth.plant.set(Channel::CUBIC_STIFFNESS, share * wn * wn / (3.0 * size * size));
            *note = format!("cubic part {share:.2} of the linear at 1.7 rms");
        }
        Fault::YieldingSpring => {
            truth.plant.kind = PlantKind::BOUC_WEN;
            for channel in PlantKind::BOUC_WEN.parameters() {
                truth.plant.set(channel, channel.usual_truth());
            }
            truth.plant.set(Channel::NATURAL_FREQUENCY, wn);
            let yielding = draw.uniform(0.7, 1.5) * size;
            for channel in PlantKind::BOUC_WEN.parameters() {
                if [Channel::HYSTERESIS_BETA, Channel::HYSTERESIS_GAMMA].contains(&channel) {
                    truth.plant.set(channel, 0.5 / (yielding * yielding));
                }
            }
            *note = format!("yields at {:.2} rms", yielding / size);
        }
        Fault::MissingMode => {
            truth.plant.kind = PlantKind::SHEAR_2;
            let stiffness = wn * wn * 2.6;
            for channel in PlantKind::SHEAR_2.parameters() {
                if channel.key().starts_with("stiffness") {
                    let value = stiffness * draw.uniform(0.8, 1.3);
                    truth.plant.set(channel, value);
                } else {
                    truth.plant.set(channel, 0.05 * wn);
                }
            }
        }
        Fault::WindUp | Fault::NoExcitation => truth.force = Force::None,
        Fault::SuddenChange => {
            let (to, at) = (wn * draw.uniform(0.75, 0.92), truth.duration * draw.uniform(0.4, 0.93));
            truth.plant.set(Channel::NATURAL_FREQUENCY, Signal::Step(Step { from: wn, to, at }));
            *note = format!("to {:.2} at {:.2}", to / wn, at / truth.duration);
        }
        Fault::SlowDrift => {
            let to = wn * draw.uniform(0.8, 0.93);
            let drift = Ramp { from: wn, to, start: 0.0, end: truth.duration };
            truth.plant.set(Channel::NATURAL_FREQUENCY, Signal::Ramp(drift));
            *note = format!("to {:.2}", to / wn);
        }
        Fault::InputGain => {
            let gain = if draw.chance(0.5) { draw.uniform(0.5, 0.85) } else { draw.uniform(1.18, 1.8) };
            truth.plant.set(Channel::INPUT_GAIN, gain);
            *note = format!("gain {gain:.2}");
        }
        Fault::InputOffset => {
            let offset = draw.sign() * draw.log_uniform(0.5, 2.0) * size * wn * wn;
            truth.plant.set(Channel::INPUT_OFFSET, offset);
            *note = format!("offset {:.2} of the rms force", offset / rms_force);
        }
        Fault::UnknownForce => {
            let force = draw.log_uniform(0.5, 2.0) * size * wn * wn;
            let duration = truth.duration;
            let signal = match draw.choice(&[0, 1, 2]) {
                0 => {
                    let period = draw.log_uniform(4.0, 20.0) * std::f64::consts::TAU / wn;
                    Signal::Sine(Sine { mean: 0.0, amplitude: force, period })
                }
                1 => Signal::Step(Step { from: 0.0, to: force, at: duration * draw.uniform(0.2, 0.8) }),
                _ => Signal::Ramp(Ramp { from: -force, to: force, start: 0.0, end: duration }),
            };
            truth.plant.set(Channel::UNKNOWN_FORCE, signal);
            *note = format!("{:.2} of the spring's rms force, {signal:?}", force / (size * wn * wn));
        }
        Fault::InputDelay => {
            truth.plant.input_delay = draw.choice(&[-3, -2, -1, 1, 2, 3]);
            *note = format!("{} samples", truth.plant.input_delay);
        }
        Fault::InputHold => truth.hold = Hold::First,
        Fault::SensorBias => {
            let sensor = draw.choice(&truth.sensors);
            let bias = draw.sign() * draw.log_uniform(1.0, 6.0) * sensor.noise_std;
            let drifts = draw.chance(0.3);
            let drift = Ramp { from: -bias, to: bias, start: 0.0, end: truth.duration };
            let signal = if drifts { Signal::Ramp(drift) } else { Signal::Constant(bias) };
            truth.plant.set(sensor.measures.bias(), signal);
            let (key, size, drifts) =
                (sensor.measures.key(), bias / sensor.noise_std, if drifts { ", drifts" } else { "" });
            *note = format!("{key} {size:.1} of noise{drifts}");
        }
        _ => {}
    }
}
