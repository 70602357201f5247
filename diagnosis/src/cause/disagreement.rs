//! Two sensors of one mass do not agree: one has a wrong sign, a wrong scale, or is late; or the times of all are wrong.

use kalmanscope_core::internals::mapped;
use kalmanscope_core::{Aspect, Quantity};

use super::sensors::clipped_ends;
use super::{BadFilter, Cause, LikelyCause};
use crate::words::short;

/// The least deviation of a factor from 1 that is a fault, and the least lateness in samples.
const SCALE: f64 = 0.04;
const LATE: f64 = 1.0;

const SURE: f64 = 5.0;

/// This many times its first σ leaves a sensor out.
const SILENCE: f64 = 1000.0;

pub(super) static SIGN: Cause = Cause {
    key: "sensor_sign",
    name: "the sign of a sensor",
    hint: "One of two sensors has the opposite sign. Let the filter estimate its gain, or give its column the gain -1.",
    likely_causes: |bad, cause, found| likely_causes(bad, cause, found, Fault::Sign),
};

pub(super) static SCALE_OF: Cause = Cause {
    key: "sensor_scale",
    name: "the scale of a sensor",
    hint: "One of two sensors reads too much or too little by a factor: a wrong unit, gain or calibration. Let the \
           filter estimate its gain, or give its column the right gain.",
    likely_causes: |bad, cause, found| likely_causes(bad, cause, found, Fault::Scale),
};

pub(super) static TIMES: Cause = Cause {
    key: "times",
    name: "the time between samples",
    hint: "All sensors agree with each other if the times are stretched: the sample rate or the unit of time is wrong. \
           Give the record the right one.",
    likely_causes: |bad, cause, found| {
        let Some(factor) = common_factor(&pairs(bad)) else { return };
        let (dt, times) = (bad.case.record.dt(), short(factor));
        let sentence = format!(
            "each sensor changes {times} times as much as the next one says: the true time between samples is about \
             {factor:.3} times the stated {dt} s, and no setting corrects that"
        );
        let off = (factor - 1.0).abs();
        found.push(LikelyCause::new(cause, off / (1.0 + off), 0.0, Vec::new(), sentence).of_record());
    },
};

pub(super) static LATENESS: Cause = Cause {
    key: "sensor_late",
    name: "a sensor that is late",
    hint: "One of two sensors is late: its amplifier filters the signal, or it has another clock. Set the delay in the \
           filter, or in its column.",
    likely_causes: |bad, cause, found| likely_causes(bad, cause, found, Fault::Late),
};

const DERIVATIVES: [(Aspect, Aspect, usize); 3] = [
    (Aspect::DISPLACEMENT, Aspect::VELOCITY, 1),
    (Aspect::VELOCITY, Aspect::ACCELERATION, 1),
    (Aspect::DISPLACEMENT, Aspect::ACCELERATION, 2),
];

#[derive(Clone, Copy, PartialEq)]
enum Fault {
    Sign,
    Scale,
    Late,
}

struct SensorPair {
    places: [usize; 2],
    order: usize,
    agreement: Agreement,
}

impl SensorPair {
    fn of_time(&self) -> f64 {
        let factor = self.agreement.factor;
        if self.order == 2 { factor.abs().sqrt() } else { factor }
    }
}

fn pairs(bad: &BadFilter<'_>) -> Vec<SensorPair> {
    let case = bad.case;
    let sensors = &bad.scenario.sensors;
    let of = |(place, one): (usize, &kalmanscope_core::Sensor)| {
        let derivative = |(of, rate, order): &(Aspect, Aspect, usize)| {
            let rate = Quantity::new(*rate, one.measures.mass());
            Some((bad.scenario.sensor_place(rate).filter(|_| *of == one.measures.aspect())?, *order))
        };
        let (other, order) = DERIVATIVES.iter().find_map(derivative)?;
        let is_left_out = |place: usize| bad.filter.sensor_std[place] >= SILENCE * bad.origin.sensor_std[place];
        if [place, other].into_iter().any(is_left_out) {
            return None;
        }
        let part = |place: usize| {
            let values: Vec<f64> = case.samples.clone().map(case.estimates.measured(case.record, place)?).collect();
            let ends = clipped_ends(&values);
            Some(mapped(&values, &|value| if ends.contains(value) { f64::NAN } else { *value }))
        };
        let (values, rates) = (part(place)?, part(other)?);
        let agreement = Agreement::of(&values, &rates, order, case.record.dt(), bad.filter.sensor_std[other])?;
        Some(SensorPair { places: [place, other], order, agreement })
    };
    sensors.iter().enumerate().filter_map(of).collect()
}

/// The true factor is between that without attenuation and that with the attenuation of the assumed noise.
fn is_off(Agreement { factor, attenuated, std, .. }: &Agreement) -> bool {
    let (off, other) = (factor.abs() - 1.0, attenuated.abs() - 1.0);
    off * other > 0.0 && off.abs().min(other.abs()) > SCALE.max(SURE * std)
}

/// The factor by which sensors change more than their rates say, if two pairs or more share it: then the times are wrong.
fn common_factor(pairs: &[SensorPair]) -> Option<f64> {
    let [first, others @ ..] = pairs else { return None };
    let (factor, std) = (first.of_time(), first.agreement.std);
    let is_same = |pair: &SensorPair| {
        let (other, other_std) = (pair.of_time(), pair.agreement.std);
        (other - factor).abs() <= 0.02 * factor.abs() + SURE * libm::hypot(std, other_std)
    };
    let is_common = !others.is_empty() && factor > 0.0 && others.iter().all(is_same);
    (is_common && pairs.iter().all(|pair| is_off(&pair.agreement))).then_some(factor)
}

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>, fault: Fault) {
    let pairs = pairs(bad);
    if fault == Fault::Scale && common_factor(&pairs).is_some() {
        return;
    }
    for pair in pairs {
        let sensors = pair.places.map(|place| bad.scenario.sensors[place].measures);
        // With the gain of either the filter can make them agree.
        if fault != Fault::Late && sensors.iter().any(|sensor| bad.filter.augment.contains(&sensor.gain())) {
            continue;
        }
        let dt = bad.case.record.dt();
        let Some((size, sentence)) = disagreement(&pair, sensors, fault, dt) else { continue };
        let Agreement { factor, late, .. } = pair.agreement;
        // The sensor itself reads more by this factor, or later; or its rate less, or earlier.
        for (which, gain, steps) in [(0, factor, -late), (1, 1.0 / factor, late)] {
            let name = sensors[which].name();
            let (edits, end) = match fault {
                Fault::Sign | Fault::Scale => {
                    let channel = sensors[which].gain();
                    let mean = bad.entry("initial_mean", channel, gain);
                    let std = bad.entry("initial_std", channel, 0.05 * gain.abs());
                    let [times, rate, not] = [gain.abs(), 1.0 / (pair.of_time().abs() * dt), 1.0 / dt].map(short);
                    let scale =
                        format!("reads {times} times what it should, or there are {rate} samples a second, not {not}");
                    let what = if fault == Fault::Sign { "has the wrong sign" } else { &scale };
                    let end = format!("perhaps the {name} {what}");
                    (vec![bad.augmented(channel), mean, std], end)
                }
                Fault::Late => {
                    let (own, other) = (pair.places[which], pair.places[1 - which]);
                    let delay = delay_of(bad, own, other, steps);
                    let mut delays = bad.filter.sensor_delay.clone();
                    delays.resize(bad.scenario.sensors.len(), 0.0);
                    delays[own] = delay;
                    let end = match delay {
                        0.0 => format!("perhaps the {name} has no delay"),
                        late if late > 0.0 => format!("perhaps the {name} is {} s late", short(late)),
                        early => format!("perhaps the {name} is {} s early", short(-early)),
                    };
                    (vec![bad.edit("sensor_delay", delays)], end)
                }
            };
            found.push(LikelyCause::new(cause, size, 1.0, edits, format!("{sentence}: {end}")).of_record());
        }
    }
}

fn disagreement(pair: &SensorPair, sensors: [Quantity; 2], fault: Fault, dt: f64) -> Option<(f64, String)> {
    let Agreement { factor, late, late_std, .. } = pair.agreement;
    let (name, rate_name) = (sensors[0].name(), sensors[1].name());
    let off = (factor.abs() - 1.0).abs();
    let (is_so, size, sentence) = match fault {
        Fault::Sign => (factor < 0.0, 1.0, format!("the {name} falls where the {rate_name} says that it rises")),
        Fault::Scale => {
            let times = short(factor.abs());
            let sentence = format!("the {name} changes {times} times as much as the {rate_name} says");
            (is_off(&pair.agreement), off / (1.0 + off), sentence)
        }
        Fault::Late => {
            let (first, second) = if late > 0.0 { (&rate_name, &name) } else { (&name, &rate_name) };
            let sentence = format!("the {first} is {} s later than the {second}", short(late.abs() * dt));
            let is_so = late.abs() > LATE && late.abs() > SURE * late_std;
            (is_so, late.abs() / (1.0 + late.abs()), sentence)
        }
    };
    is_so.then_some((size, sentence))
}

/// The delay with which a sensor agrees with another one \[s\]. It is `steps` later than the filter takes it to be.
fn delay_of(bad: &BadFilter<'_>, own: usize, other: usize, steps: f64) -> f64 {
    let dt = bad.case.record.dt();
    let delays = bad.filter.delays(dt);
    // The two were compared at whole steps of each.
    let between = libm::round(delays.of(own)) - libm::round(delays.of(other));
    let delay = delays.of(other) + between + steps;
    if delay.abs() < 0.1 { 0.0 } else { delay * dt }
}

/// Two sensors of one mass compared: the changes of one with the integral of the other.
#[derive(Clone, Copy, Debug)]
pub struct Agreement {
    /// The scale of the first over that of the second, and its standard deviation.
    pub factor: f64,
    attenuated: f64,
    /// See `factor`.
    pub std: f64,
    /// The samples by which the second is late, and their standard deviation.
    pub late: f64,
    /// See `late`.
    pub late_std: f64,
}

/// Limits the lateness that is looked for, in samples.
const MOST_LATE: usize = 60;

/// Limits the changes that are compared: more add little.
const PAIRS: usize = 1000;

/// The spans over which changes are taken, in samples: the one in which both are most alike is used.
const SPANS: [usize; 8] = [2, 4, 8, 16, 32, 64, 128, 256];

impl Agreement {
    /// `noise` is the standard deviation of the rate's noise by the filter. `None` where readings are too few, or the two too unlike.
    /// ```text
    /// x(k + m) - x(k) = c + b ∫ v dt,  x(k + 2 m) - 2 x(k + m) + x(k) = c + b ∬ a dt²
    /// ```
    /// b by least squares, without the attenuation by the rate's noise.
    pub fn of(values: &[f64], rates: &[f64], order: usize, dt: f64, noise: f64) -> Option<Self> {
        let count = values.len().min(rates.len());
        let integral = (1..order).fold(integral(rates, dt), |once, _| integral(&once, dt));
        let spans = SPANS.into_iter().filter(|span| 20 * order * span < count);
        let at = |span: usize, late: isize| RatioSums::of([values, &integral], order, span, late);
        let lates = -(MOST_LATE as isize)..=MOST_LATE as isize;
        let coarse = spans.flat_map(|span| lates.clone().step_by(5).map(move |late| (span, late)));
        let likeness = |sums: &Option<RatioSums>| sums.as_ref().map_or(0.0, |sums| sums.correlation().abs());
        let likenesses = coarse.map(|(span, late)| (likeness(&at(span, late)), span, late));
        let (_, span, near) = likenesses.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let fine = (near - 5).max(-(MOST_LATE as isize))..=(near + 5).min(MOST_LATE as isize);
        let likenesses = fine.map(|late| (likeness(&at(span, late)), late));
        let (_, best) = likenesses.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let sums = at(span, best)?;
        let r = sums.correlation();
        if r.abs() < 0.9 {
            return None;
        }
        let (before, here, after) = (likeness(&at(span, best - 1)), r.abs(), likeness(&at(span, best + 1)));
        let curvature = before - 2.0 * here + after;
        let peak = if curvature < 0.0 { (0.5 * (before - after) / curvature).clamp(-0.5, 0.5) } else { 0.0 };
        let independent = (count as f64 / (order * span) as f64).max(3.0);
        let noise = noise.min(roughness(rates));
        let span = span as f64;
        // The effect of white noise in the derivative: its integral over a span, or over a triangle of two spans.
        let of_noise = if order == 1 { span } else { 2.0 / 3.0 * dt * dt * span * span * span };
        let attenuation = 1.0 - of_noise * (dt * noise).powi(2) / (sums.squares[1] / sums.count);
        let factor = sums.slope() / attenuation.max(0.5);
        let std = factor.abs() * ((1.0 / (r * r) - 1.0) / independent).sqrt();
        let scatter = ((1.0 - r * r) / independent).sqrt();
        let late_std =
            if curvature < 0.0 { (scatter * (1.0 - r * r).sqrt() / -curvature).sqrt() } else { f64::INFINITY };
        Some(Self { factor, attenuated: sums.slope(), std, late: best as f64 + peak, late_std })
    }
}

/// The standard deviation of white noise with the second differences of these readings: that of their own noise, and a little more.
fn roughness(readings: &[f64]) -> f64 {
    let squares =
        readings.windows(3).map(|three| three[0] - 2.0 * three[1] + three[2]).filter(|second| second.is_finite());
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), second| (sum + second * second, count + 1.0));
    // 1 + 4 + 1 times the variance of one reading.
    if count > 0.0 { (sum / (6.0 * count)).sqrt() } else { f64::INFINITY }
}

fn integral(rates: &[f64], dt: f64) -> Vec<f64> {
    let mut last = rates.iter().copied().find(|rate| !rate.is_nan()).unwrap_or(0.0);
    let mut sum = 0.0;
    let step = |rate: &f64| {
        let before = last;
        if !rate.is_nan() {
            last = *rate;
        }
        sum += 0.5 * dt * (before + last);
        sum
    };
    rates.iter().map(step).collect()
}

struct RatioSums {
    count: f64,
    means: [f64; 2],
    squares: [f64; 2],
    product: f64,
}

impl RatioSums {
    fn of([values, integral]: [&[f64]; 2], order: usize, span: usize, late: isize) -> Option<Self> {
        let count = values.len().min(integral.len());
        let first = late.min(0).unsigned_abs();
        let end = count.checked_sub(order * span + late.max(0).unsigned_abs())?;
        let change = |of: &[f64], k: usize| {
            let once = of[k + span] - of[k];
            if order == 1 { once } else { of[k + 2 * span] - of[k + span] - once }
        };
        let stride = (end.saturating_sub(first) / PAIRS).max(1);
        let mut sums = Self { count: 0.0, means: [0.0; 2], squares: [0.0; 2], product: 0.0 };
        for k in (first..end).step_by(stride) {
            let other = k.checked_add_signed(late)?;
            let pair = [change(values, k), change(integral, other)];
            if pair.iter().any(|x| !x.is_finite()) {
                continue;
            }
            // Welford (1962), Note on a method for calculating corrected sums of squares and products.
            sums.count += 1.0;
            let before = [pair[0] - sums.means[0], pair[1] - sums.means[1]];
            for (mean, difference) in sums.means.iter_mut().zip(before) {
                *mean += difference / sums.count;
            }
            let after = [pair[0] - sums.means[0], pair[1] - sums.means[1]];
            for ((square, before), after) in sums.squares.iter_mut().zip(before).zip(after) {
                *square += before * after;
            }
            sums.product += before[0] * after[1];
        }
        (sums.count > 50.0 && sums.squares.iter().all(|square| *square > 0.0)).then_some(sums)
    }

    fn correlation(&self) -> f64 {
        self.product / (self.squares[0] * self.squares[1]).sqrt()
    }

    fn slope(&self) -> f64 {
        self.product / self.squares[1]
    }
}
