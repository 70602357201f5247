//! Problems of an accelerometer's readings while they come, in sentences.

use crate::text::fixed;

/// An interval is a gap from this length on, and from this many usual steps on \[s\].
const GAP: f64 = 0.25;
const STEPS: f64 = 10.0;

const AT_ONCE: usize = 100;
const CHANGED: f64 = 1.25;

/// The time over which the direction of gravity is looked at \[s\], and the angle by which it turns \[degrees\].
const STILL: f64 = 2.0;
const TURNED: f64 = 20.0;

#[derive(Default)]
pub(super) struct Health {
    seen: usize,
    /// The largest time so far \[s\].
    last: Option<f64>,
    gaps: usize,
    /// The time and the length of the longest gap \[s\].
    longest: (f64, f64),
    late: usize,
    without: usize,
    /// The usual step of the first readings and of the last ones \[s\].
    steps: Option<[f64; 2]>,
    /// By how much gravity has turned since the beginning \[degrees\].
    turn: f64,
}

impl Health {
    pub(super) fn follow(&mut self, readings: &[[f64; 4]]) {
        for reading in &readings[self.seen.min(readings.len())..] {
            if !reading.iter().all(|x| x.is_finite()) {
                self.without += 1;
                continue;
            }
            let Some(last) = self.last else {
                self.last = Some(reading[0]);
                continue;
            };
            let step = reading[0] - last;
            if step <= 0.0 {
                self.late += 1;
                continue;
            }
            if step > GAP.max(STEPS * self.steps.map_or(0.0, |steps| steps[0])) {
                self.gaps += 1;
                if step > self.longest.1 {
                    self.longest = (last - readings[0][0], step);
                }
            }
            self.last = Some(reading[0]);
        }
        let is_new = readings.len() > self.seen;
        self.seen = readings.len();
        if is_new && readings.len() >= 2 * AT_ONCE {
            let usual = |part: &[[f64; 4]]| {
                let mut steps: Vec<f64> =
                    part.windows(2).map(|pair| pair[1][0] - pair[0][0]).filter(|dt| *dt > 0.0).collect();
                steps.sort_by(f64::total_cmp);
                steps.get(steps.len() / 2).copied()
            };
            let ends = [&readings[..AT_ONCE], &readings[readings.len() - AT_ONCE..]].map(usual);
            self.steps = ends[0].zip(ends[1]).map(|(first, last)| [first, last]);
            self.turn = turn(readings);
        }
    }

    pub(super) fn sentences(&self) -> Vec<String> {
        let mut said = Vec::new();
        if self.gaps > 0 {
            let (at, length) = self.longest;
            let more = if self.gaps > 1 { format!(" It is the longest of {} gaps.", self.gaps) } else { String::new() };
            said.push(format!(
                "No readings for {} s at {} s: a hidden page, a dark screen or a lost connection.{more}",
                fixed(length, 1),
                fixed(at, 1)
            ));
        }
        if self.late > 0 {
            said.push(format!("{} came late, or twice.", readings(self.late)));
        }
        if self.without > 0 {
            said.push(format!("{} had no number.", readings(self.without)));
        }
        if let Some([first, last]) = self.steps.filter(|[a, b]| a / b > CHANGED || b / a > CHANGED) {
            let [first, last] = [first, last].map(|step| fixed(1.0 / step, 0));
            said.push(format!("The rate has changed from {first} to {last} readings a second."));
        }
        if self.turn > TURNED {
            said.push(format!("It has turned by {}°: do not turn it while measuring.", fixed(self.turn, 0)));
        }
        said
    }
}

fn readings(count: usize) -> String {
    if count == 1 { "1 reading".to_owned() } else { format!("{count} readings") }
}

/// The angle between gravity in the first seconds and in the last ones \[degrees\].
fn turn(readings: &[[f64; 4]]) -> f64 {
    let (begin, end) = (readings[0][0], readings[readings.len() - 1][0]);
    let direction = |some: &mut dyn Iterator<Item = &[f64; 4]>| {
        let mut sum = [0.0; 3];
        for reading in some {
            sum.iter_mut().zip(&reading[1..]).filter(|(_, x)| x.is_finite()).for_each(|(sum, x)| *sum += x);
        }
        let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
        sum.map(|x| x / length)
    };
    let first = direction(&mut readings.iter().take_while(|reading| reading[0] < begin + STILL));
    let last = direction(&mut readings.iter().rev().take_while(|reading| reading[0] > end - STILL));
    let cos: f64 = first.iter().zip(&last).map(|(a, b)| a * b).sum();
    if cos.is_finite() { cos.clamp(-1.0, 1.0).acos().to_degrees() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sentences about readings at these times, with gravity along an angle \[degrees\].
    fn said(times: impl Iterator<Item = f64>, angle: impl Fn(f64) -> f64) -> Vec<String> {
        let of = |t: f64| {
            let (sin, cos) = angle(t).to_radians().sin_cos();
            [t, 9.8 * sin, 9.8 * cos + 0.5 * (9.0 * t).sin(), 0.0]
        };
        let readings: Vec<[f64; 4]> = times.map(of).collect();
        let mut health = Health::default();
        (0..=readings.len()).step_by(7).for_each(|count| health.follow(&readings[..count]));
        health.follow(&readings);
        health.sentences()
    }

    #[test]
    fn each_fault_has_its_sentence() {
        let even = || (0..1500).map(|k| 0.02 * f64::from(k));
        assert!(said(even(), |_| 10.0).is_empty());
        // The clock of the device began long before.
        let gap = said(even().filter(|t| !(12.0..15.5).contains(t)).map(|t| t + 30.0), |_| 0.0);
        assert_eq!(gap, ["No readings for 3.5 s at 12.0 s: a hidden page, a dark screen or a lost connection."]);
        let late = said(even().map(|t| if (7.01..7.03).contains(&t) { 6.5 } else { t }), |_| 0.0);
        assert_eq!(late, ["1 reading came late, or twice."]);
        let missing = said(even().map(|t| if (7.0..7.05).contains(&t) { f64::NAN } else { t }), |_| 0.0);
        assert!(missing[0].ends_with("had no number."), "{missing:?}");
        let slower =
            said((0..900).map(|k| if k < 500 { 0.01 * f64::from(k) } else { 5.0 + 0.02 * f64::from(k - 500) }), |_| {
                0.0
            });
        assert_eq!(slower, ["The rate has changed from 100 to 50 readings a second."]);
        let turned = said(even(), |t| if t < 15.0 { 0.0 } else { 40.0 });
        assert_eq!(turned, ["It has turned by 40°: do not turn it while measuring."]);
    }

    #[test]
    fn nothing_makes_it_panic() {
        let mut state = 1_u64;
        let mut random = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            match state >> 60 {
                0 => f64::NAN,
                1 => f64::INFINITY,
                2 => -1e300,
                _ => (state >> 40) as f64,
            }
        };
        let readings: Vec<[f64; 4]> = (0..5000).map(|_| std::array::from_fn(|_| random())).collect();
        let mut health = Health::default();
        (0..readings.len()).step_by(13).for_each(|count| health.follow(&readings[..count]));
        assert!(!health.sentences().is_empty());
    }
}
