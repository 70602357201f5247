//! The numbers of one step of a filter, for one channel and one sensor, rounded so that sums hold as they are read.

use kalmanscope_core::{Channel, Quantity, Spread};

use crate::view::ViewContext;

/// Mean and variance of one number, as they are read.
#[derive(Clone, Copy)]
pub(super) struct Normal {
    pub(super) mean: f64,
    pub(super) variance: f64,
}

impl Normal {
    pub(super) fn std(self) -> f64 {
        self.variance.max(0.0).sqrt()
    }

    fn rounded(self, [of_mean, of_variance]: [Digits; 2]) -> Self {
        Self { mean: of_mean.rounded(self.mean), variance: of_variance.rounded(self.variance) }
    }
}

/// The results of a step, which a reader may fill in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StepResult {
    PredictedMean,
    PredictedVariance,
    Innovation,
    InnovationVariance,
    Gain,
    Shift,
    Mean,
    Variance,
}

pub(super) struct FilterStep {
    pub(super) channel: Channel,
    pub(super) unit: &'static str,
    pub(super) dt: f64,
    /// Before, as predicted, and after; with the digits of their means and variances.
    pub(super) beliefs: [Normal; 3],
    pub(super) digits: [Digits; 2],
    pub(super) truth: [Option<f64>; 2],
    /// Q of the channel, where it is the settings' own; and whether P fades.
    pub(super) process: Option<f64>,
    pub(super) is_fading: bool,
    pub(super) spread: Option<Spread>,
    /// Of each sensor with a reading: the innovation, and the gain of the channel.
    pub(super) terms: Vec<(Quantity, f64, f64)>,
    pub(super) update: Option<SensorUpdate>,
    /// Whether `y - K e` is the filter's own prediction.
    pub(super) is_exact: bool,
}

/// The update by the chosen sensor, if it has a reading.
pub(super) struct SensorUpdate {
    pub(super) quantity: Quantity,
    pub(super) unit: &'static str,
    /// h(y⁻) and S, z and R.
    pub(super) expected: Normal,
    pub(super) measured: Normal,
    pub(super) digits: [Digits; 2],
    pub(super) gain: f64,
}

impl SensorUpdate {
    pub(super) fn innovation(&self) -> String {
        self.digits[0].text(self.measured.mean - self.expected.mean)
    }
}

impl FilterStep {
    /// The step to sample `k` > 0 of the filter at a place. `None` if the filter does not estimate the channel.
    pub(super) fn of(context: &ViewContext<'_>, place: usize, choice: (Channel, usize), k: usize) -> Option<Self> {
        let (run, (channel, sensor)) = (context.session.run(), choice);
        let (record, estimates, settings) = (run.record(), &run.estimates()[place], run.scenario().filters.get(place)?);
        let at = estimates.place(channel)?;
        let (n, m) = (estimates.channels().len(), estimates.sensors().len());
        let (gain, e, s) = (estimates.gain(k), estimates.innovation(k), estimates.innovation_cov(k));
        if gain.len() != n * m {
            return None;
        }
        let delivered: Vec<usize> = (0..m).filter(|sensor| !e[*sensor].is_nan()).collect();
        // K e and K S Kᵀ of the sensors with a measurement.
        let shift: f64 = delivered.iter().map(|a| gain[a * n + at] * e[*a]).sum();
        let term = |a: usize, b: usize| gain[a * n + at] * s[a * m + b] * gain[b * n + at];
        let known: f64 = delivered.iter().flat_map(|a| delivered.iter().map(move |b| term(*a, *b))).sum();
        let of = |k: usize| Normal { mean: estimates.mean(k)[at], variance: estimates.variances(at)[k] };
        let [prior, after] = [of(k - 1), of(k)];
        let ahead = Normal { mean: after.mean - shift, variance: after.variance + known };
        let digits = [
            Digits::new(&[prior.mean, ahead.mean, after.mean, after.std()], 0.1 * after.std()),
            Digits::new(&[prior.variance, ahead.variance], 0.01 * ahead.variance),
        ];
        let update = delivered.contains(&sensor).then(|| {
            let z = estimates.measured(record, sensor).map_or(f64::NAN, |z| z(k));
            let own = settings.sensor_std.get(sensor).copied().unwrap_or(f64::NAN);
            let noise = estimates.sensor_noise(k, sensor).map_or(own, |[std, _]| std);
            let expected = Normal { mean: z - e[sensor], variance: s[sensor * (m + 1)] };
            let digits = [
                Digits::new(&[z, expected.mean, expected.std()], expected.std()),
                Digits::new(&[expected.variance], 0.1 * expected.variance),
            ];
            let quantity = estimates.sensors()[sensor];
            let measured = Normal { mean: z, variance: noise * noise }.rounded(digits);
            let (expected, gain) = (expected.rounded(digits), gain[sensor * n + at]);
            SensorUpdate { quantity, unit: context.unit(quantity.unit()), expected, measured, digits, gain }
        });
        let truth = |k: usize| record.truth(channel).filter(|_| context.visible.truth).map(|truth| truth[k]);
        let std = if settings.knows(channel) { 0.0 } else { settings.process_std[channel] };
        let spread = Spread::of(run, place, channel, k);
        let is_q_known = !settings.adaptation.is_on() && !settings.jump && !settings.log_parameters;
        Some(Self {
            channel,
            unit: context.unit(channel.unit()),
            dt: record.dt(),
            beliefs: [prior, ahead, after].map(|normal| normal.rounded(digits)),
            digits,
            truth: [k - 1, k].map(truth),
            process: (spread.is_some() && is_q_known).then_some(std * std),
            is_fading: settings.fading != 1.0,
            spread,
            terms: delivered.iter().map(|a| (estimates.sensors()[*a], e[*a], gain[a * n + at])).collect(),
            update,
            is_exact: settings.kind.is_gaussian() && settings.bounds.is_empty() && settings.kind.key() != "iekf",
        })
    }
}

/// The last digit of some numbers, the same for all of them, and their power of ten.
#[derive(Clone, Copy, Debug)]
pub(super) struct Digits {
    exponent: i32,
    decimals: i32,
}

impl Digits {
    /// So that a number as small as `least` has three digits, but the largest of some numbers three to seven.
    pub(super) fn new(numbers: &[f64], least: f64) -> Self {
        let power = |x: f64| if x.is_normal() { x.abs().log10().floor() as i32 } else { -300 };
        let first = numbers.iter().map(|x| power(*x)).max().unwrap_or(0);
        let last = (power(least) - 2).clamp(first - 6, first - 2);
        let exponent = if (-3..6).contains(&first) || first == -300 { 0 } else { first };
        Self { exponent, decimals: (exponent - last).clamp(0, 12) }
    }

    fn rounded(self, x: f64) -> f64 {
        self.written(x).parse().unwrap_or(f64::NAN)
    }

    pub(super) fn text(self, x: f64) -> String {
        let text = self.written(x);
        let is_zero = x.is_finite() && !text.contains(|digit| matches!(digit, '1'..='9'));
        if is_zero { "0".to_owned() } else { text.replace('-', "−") }
    }

    fn written(self, x: f64) -> String {
        let decimals = self.decimals as usize;
        match self.exponent {
            _ if x == 0.0 => "0".to_owned(),
            0 => format!("{x:.decimals$}"),
            exponent => format!("{:.decimals$}e{exponent}", x / 10f64.powi(exponent)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::parse;

    #[test]
    fn sums_hold_as_they_are_read() {
        for scale in [1e-9, 3.3e-4, 1.0, 770.0, 4e8] {
            let [before, after, least] = [5.978_235_6, 5.978_436_1, 0.002].map(|x| x * scale);
            let digits = Digits::new(&[before, after], least);
            let [before, after] = [before, after].map(|x| digits.rounded(x));
            let [a, b, sum] = [before, after - before, after].map(|x| parse(&digits.text(x)).unwrap());
            assert!((a + b - sum).abs() < 1e-9 * sum && b > 0.0, "{a} + {b} = {sum}");
        }
        let digits = Digits::new(&[6.1, 0.02], 0.02);
        assert_eq!([6.0, -0.012_34, 1e-9].map(|x| digits.text(x)), ["6.0000", "−0.0123", "0"]);
        assert_eq!(Digits::new(&[5.2e-7], 5e-9).text(5.2137e-7), "5.2137e−7");
    }
}
