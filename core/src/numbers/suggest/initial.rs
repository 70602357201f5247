//! The belief that filters begin with, and the gain of the input.

use super::decay::Decay;
use super::response::{Response, order};
use super::{Suggestion, hysteresis, moments, rounded};
use crate::{Channel, Quantity, Record, Signal};

/// The spread that a filter of a free decay begins with, in standard deviations of the fit.
pub(super) const LOOSE: f64 = 30.0;

impl Suggestion {
    /// Lets every filter begin with an oscillator that `quantity` shows, for this reason.
    pub(super) fn begin_at(&mut self, record: &mut Record, quantity: Quantity, found: &Response, reason: &str) {
        let Response { natural_frequency, damping_ratio, gain } = *found;
        let (wn, zeta) = (rounded(natural_frequency), rounded(damping_ratio));
        let hertz = rounded(wn / std::f64::consts::TAU);
        self.reasons.push(format!("guess of ωₙ: {wn} rad/s ({hertz} Hz) and of ζ: {zeta}, {reason}"));
        for (channel, value) in [(Channel::NATURAL_FREQUENCY, wn), (Channel::DAMPING_RATIO, zeta)] {
            // The truth of a measured record is not known: these values are for a simulation in its place.
            if self.scenario.plant.parameter(channel).is_some() {
                self.scenario.plant.set(channel, Signal::Constant(value));
            }
        }
        self.gain(record, gain);
        let measured = record.measured_quantity(quantity).unwrap_or_default();
        let (_, size) = moments(measured);
        let order = order(quantity);
        let displacement = size / libm::pow(natural_frequency, f64::from(order));
        let first = measured.iter().copied().find(|value| !value.is_nan()).filter(|_| order == 0).unwrap_or(0.0);
        for filter in self.filters() {
            let std = |value: f64| rounded(value.max(f64::MIN_POSITIVE));
            let mean = [
                (Channel::DISPLACEMENT, rounded(first)),
                (Channel::VELOCITY, 0.0),
                (Channel::NATURAL_FREQUENCY, wn),
                (Channel::DAMPING_RATIO, zeta),
                (Channel::CUBIC_STIFFNESS, 0.0),
            ];
            let spread = [
                (Channel::DISPLACEMENT, std(displacement)),
                (Channel::VELOCITY, std(displacement * natural_frequency)),
                (Channel::NATURAL_FREQUENCY, std(0.1 * natural_frequency)),
                (Channel::DAMPING_RATIO, std((0.5 * damping_ratio).max(0.01))),
                (Channel::CUBIC_STIFFNESS, std(cubic_scale(natural_frequency, measured, order))),
            ];
            for (channel, value) in mean {
                filter.initial_mean[channel] = value;
            }
            for (channel, value) in spread {
                filter.initial_std[channel] = value;
            }
            for (channel, _) in spread.iter().skip(2) {
                filter.process_std[*channel] = 0.0;
            }
        }
        self.reasons.push("initial spread: a tenth of ωₙ, half of ζ, and the size of the motion itself".to_owned());
        let (kind, input) = (self.scenario.plant.kind, self.scenario.input);
        let mut yields = false;
        self.filters().for_each(|filter| yields |= hysteresis::start(filter, kind, input, displacement));
        if yields {
            self.reasons.push(
                "β and γ: the spring is about to yield at twice the root mean square of the displacement".to_owned(),
            );
        }
    }

    /// Lets every filter expect a motion as large as the beginning of a decay, which a long record's mean square hides.
    pub(super) fn begin_as_large(&mut self, quantity: Quantity, decay: &Decay) {
        let Decay { natural_frequency, damping_ratio, spread, amplitude, is_all, .. } = *decay;
        let displacement = amplitude / libm::pow(natural_frequency, f64::from(order(quantity)));
        let sizes = [(Channel::DISPLACEMENT, displacement), (Channel::VELOCITY, displacement * natural_frequency)];
        for filter in self.filters() {
            for (channel, size) in sizes {
                filter.initial_std[channel] = filter.initial_std[channel].max(rounded(size));
            }
        }
        if is_all {
            self.begin_near([natural_frequency, damping_ratio], spread);
        }
    }

    /// Lets every filter begin near the parameters of a fit. The readings count again in the filter: a spread far above that
    /// of the fit says next to nothing, and a linearisation holds within it.
    fn begin_near(&mut self, fitted: [f64; 2], spread: [f64; 2]) {
        let eight_digits = |value: f64| format!("{value:.7e}").parse().unwrap_or(value);
        let [frequency, damping] = spread.map(|std| LOOSE * std);
        let spread = [frequency.max(1e-5 * fitted[0]), damping.max(0.01 * fitted[1])];
        let channels = [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];
        for filter in self.filters() {
            for ((channel, value), spread) in channels.into_iter().zip(fitted).zip(spread) {
                if rounded(spread) < filter.initial_std[channel] {
                    filter.initial_std[channel] = rounded(spread);
                    filter.initial_mean[channel] = eight_digits(value);
                }
            }
        }
        self.reasons.push(format!("spread of ωₙ and ζ: {LOOSE} times that of the fit at most"));
    }

    /// Puts a gain that is far from 1 into the mapping; the filters estimate the rest of it.
    fn gain(&mut self, record: &mut Record, gain: Option<f64>) {
        // The fitted gain may include terms of the equation that an oscillator lacks.
        let gain = gain.filter(|_| self.own_parameters().is_none());
        let Some(gain) = gain.filter(|gain| gain.is_finite() && *gain != 0.0) else { return };
        if (gain - 1.0).abs() < 0.02 {
            return;
        }
        let gain = rounded(gain);
        if let Some(input) = self.scenario.record.as_mut().and_then(|mapping| mapping.input.as_mut()) {
            input.gain *= gain;
            record.change_input(|value| value * gain);
            self.reasons.push(format!(
                "gain of the input: {} m/s² for one unit of its column, from the same fit; the filters estimate the rest",
                input.gain
            ));
        } else {
            self.reasons.push(format!("gain of the input: {gain}, from the same fit"));
        }
        let is_mapped = self.scenario.record.is_some();
        for filter in self.filters() {
            if !filter.augment.contains(&Channel::INPUT_GAIN) {
                filter.augment.push(Channel::INPUT_GAIN);
            }
            let mean = if is_mapped { 1.0 } else { gain };
            if !is_mapped && filter.augment.contains(&Channel::INPUT_OFFSET) {
                // The offset belongs to the true input; its gain is not yet known well.
                let offset = mean * filter.initial_mean[Channel::INPUT_OFFSET];
                filter.initial_mean[Channel::INPUT_OFFSET] = offset;
                filter.initial_std[Channel::INPUT_OFFSET] = rounded(0.2 * offset.abs());
            }
            filter.initial_mean[Channel::INPUT_GAIN] = mean;
            filter.initial_std[Channel::INPUT_GAIN] = rounded(0.2 * mean.abs());
            filter.process_std[Channel::INPUT_GAIN] = 0.0;
        }
    }
}

/// A cubic stiffness that carries half of the load at the largest displacement.
fn cubic_scale(natural_frequency: f64, measured: &[f64], order: i32) -> f64 {
    let most = measured.iter().filter(|value| !value.is_nan()).fold(0.0_f64, |most, value| most.max(value.abs()));
    let displacement = most / libm::pow(natural_frequency, f64::from(order));
    if displacement > 0.0 { 0.5 * natural_frequency * natural_frequency / (displacement * displacement) } else { 1.0 }
}
