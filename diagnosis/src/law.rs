//! The law that an estimated force follows: a wave, or a function of the motion that the plant lacks.

use std::f64::consts::TAU;

use kalmanscope_core::internals::FilterContext;
use kalmanscope_core::internals::mapped;
use kalmanscope_core::internals::{FixedInterval, Forward, Smoother};
use kalmanscope_core::{Channel, Estimates, Pass, Record, Scenario};

use super::periodogram::{Periodogram, window_length};
use crate::words::short;

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Law {
    pub(super) text: String,
    /// Whether neither plant nor input of a filter can have this law, so that the force is real.
    pub(super) is_own: bool,
}

const SHARE: f64 = 0.5;

const BEYOND: f64 = 0.1;

const MARGIN: f64 = 0.05;

const FINE: f64 = 4.0;

const CHUNK: usize = 100;

/// The smoothed unknown force of a filter, computed in slices of time: the filter's own estimate comes late.
pub(super) struct ForceInHindsight {
    smoother: Box<dyn Smoother>,
    estimates: Box<Estimates>,
}

impl ForceInHindsight {
    pub(super) fn new(scenario: &Scenario, record: &Record) -> Option<Self> {
        let filter = scenario.filters.first()?;
        filter.augment.contains(&Channel::UNKNOWN_FORCE).then_some(())?;
        let context = FilterContext::new(scenario, record.dt(), filter).over(record, filter);
        let sensors = Pass::columns(scenario, 0, record).ok()?;
        let smoother = Box::new(FixedInterval::new(Forward::new(filter, &context, sensors)?));
        let estimates = Estimates::new(filter, scenario, Vec::new()).of_smoother();
        Some(Self { smoother, estimates: Box::new(estimates) })
    }

    pub(super) fn advance(&mut self, record: &Record, while_time: &mut dyn FnMut() -> bool) -> bool {
        loop {
            if self.smoother.advance(record, record.len(), true, CHUNK, &mut self.estimates) {
                return true;
            }
            if !while_time() {
                return false;
            }
        }
    }

    pub(super) fn law(&self, dt: f64) -> Option<Law> {
        let of = |channel| self.estimates.place(channel).map(|place| self.estimates.canonical_means(place));
        let force = of(Channel::UNKNOWN_FORCE)?;
        law(force, of(Channel::DISPLACEMENT)?, of(Channel::VELOCITY)?, dt)
    }
}

/// Of a force \[m/s²\], given displacement \[m\] and velocity \[m/s\]. The filter's parameters explain a linear part.
/// ```text
/// u = a x + b v + c l(x, v),  l = sign v, v |v| or x³:  the one with the largest share of the mean square
/// ```
fn law(force: &[f64], displacement: &[f64], velocity: &[f64], dt: f64) -> Option<Law> {
    let n = force.len().min(displacement.len()).min(velocity.len());
    let margin = (MARGIN * n as f64) as usize;
    let [mut u, mut x, mut v] = [force, displacement, velocity].map(|all| all[margin..n - margin].to_vec());
    let samples = u.len();
    [&mut u, &mut x, &mut v].into_iter().for_each(|values| center(values));
    let whole = dot(&u, &u);
    if samples < 100 || !(whole > 0.0 && whole.is_finite()) {
        return None;
    }
    if let Some((share, turn)) = wave(&u).filter(|(share, _)| *share > SHARE) {
        let amplitude = (2.0 * share * whole / samples as f64).sqrt();
        let (frequency, amplitude) = (short(turn / dt), short(amplitude));
        let text = format!("it is a wave of {frequency} rad/s with an amplitude of {amplitude} m/s²");
        return Some(Law { text, is_own: true });
    }
    let left_of_v = without(&v, &[&x]);
    let linear = share(&u, &x) + share(&u, &left_of_v);
    let size = (dot(&v, &v) / samples as f64).sqrt();
    // The sign of a speed near zero is uncertain: `tanh` stands in for it.
    let laws: [Vec<f64>; 3] =
        [mapped(&v, &|v| libm::tanh(10.0 * v / size)), mapped(&v, &|v| v * v.abs()), mapped(&x, &|x| x * x * x)];
    let rests = laws.map(|law| without(&law, &[&x, &left_of_v]));
    let shares = rests.each_ref().map(|rest| share(&u, rest));
    let best = (0..3).max_by(|&a, &b| shares[a].total_cmp(&shares[b]))?;
    let grows = dot(&u, &rests[best]) > 0.0;
    if linear + shares[best] < SHARE {
        return None;
    }
    let is_linear = shares[best] < BEYOND;
    let text = match (best, grows) {
        _ if is_linear => "it is linear in the motion: the parameters themselves are wrong",
        (0, false) => "it opposes the motion with the same size at any speed: dry friction",
        (0, true) | (1, false) => "it opposes the motion, and grows faster than the speed: a drag, as in a fluid",
        (1, true) => "it opposes the motion, and grows less than the speed: friction",
        (_, false) => "it grows with the cube of the displacement: the spring hardens",
        (_, true) => "it grows with the cube of the displacement: the spring softens",
    };
    Some(Law { text: format!("{text}; do not trust ζ"), is_own: !is_linear && best < 2 })
}

/// The largest share of the mean square that one wave explains over all samples, and its frequency in radians a sample.
fn wave(values: &[f64]) -> Option<(f64, f64)> {
    let n = values.len();
    let (_, turn) = Periodogram::of_all(&[values.to_vec()], std::slice::from_ref(&(0..n))).first()?.peak()?;
    let step = TAU / n as f64 / FINE;
    // The periodogram's windows are shorter than the record: its peak is known to half a cycle a window.
    let reach = (0.75 * FINE * n as f64 / window_length(n)? as f64).ceil() as i64;
    let of = |turn: f64| {
        let (mut re, mut im) = (0.0, 0.0);
        let (cos, sin) = (libm::cos(turn), libm::sin(turn));
        let (mut c, mut s) = (1.0, 0.0);
        for value in values {
            re += value * c;
            im += value * s;
            (c, s) = (c * cos - s * sin, s * cos + c * sin);
        }
        2.0 * (re * re + im * im) / n as f64 / dot(values, values)
    };
    let all = (-reach..=reach).map(|i| turn + i as f64 * step).filter(|turn| *turn > 0.0);
    all.map(|turn| (of(turn), turn)).max_by(|a, b| a.0.total_cmp(&b.0))
}

fn center(values: &mut [f64]) {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter_mut().for_each(|value| *value -= mean);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn without(values: &[f64], others: &[&[f64]]) -> Vec<f64> {
    let mut rest = values.to_vec();
    for other in others {
        let square = dot(other, other);
        let factor = if square > 0.0 { dot(&rest, other) / square } else { 0.0 };
        rest.iter_mut().zip(*other).for_each(|(rest, other)| *rest -= factor * other);
    }
    rest
}

fn share(u: &[f64], along: &[f64]) -> f64 {
    let (product, squares) = (dot(u, along), dot(u, u) * dot(along, along));
    if squares > 0.0 { product * product / squares } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_core::filter::Normal;

    fn motion() -> [Vec<f64>; 3] {
        let mut normal = Normal::from_seed(5);
        let (mut x, mut v) = (0.0, 0.0);
        let mut motion = [Vec::new(), Vec::new(), Vec::new()];
        for _ in 0..6000 {
            v += 0.01 * (-36.0 * x - 0.6 * v) + 0.1 * normal.sample();
            x += 0.01 * v;
            for (values, value) in motion.iter_mut().zip([x, v, normal.sample()]) {
                values.push(value);
            }
        }
        motion
    }

    #[test]
    fn the_law_of_a_force_is_named() {
        let [x, v, noise] = motion();
        let named = |of: &dyn Fn(usize) -> f64| {
            let force: Vec<f64> = (0..x.len()).map(|k| of(k) + 0.1 * noise[k]).collect();
            law(&force, &x, &v, 0.01).map_or(String::new(), |law| law.text)
        };
        assert!(named(&|k| 0.3 * v[k] - v[k].signum()).contains("dry friction"));
        assert!(named(&|k| -v[k] * v[k].abs() + 0.5 * v[k]).contains("drag"));
        assert!(named(&|k| -20.0 * x[k] * x[k] * x[k]).contains("hardens"));
        let wave = named(&|k| libm::sin(0.0713 * k as f64));
        assert!(wave.starts_with("it is a wave of 7.1 rad/s with an amplitude of 1.0 m/s²"), "{wave}");
        assert!(!wave.contains('ζ'), "{wave}");
        assert_eq!(named(&|_| 0.0), "");
    }
}
