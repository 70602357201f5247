//! Gaps in an accelerometer's readings while they come, in a sentence.

use crate::text::fixed;

/// An interval is a gap from this length on \[s\].
const GAP: f64 = 0.25;

#[derive(Default)]
pub(super) struct Health {
    seen: usize,
    /// The time and the length of the longest interval \[s\].
    longest: (f64, f64),
}

impl Health {
    pub(super) fn follow(&mut self, readings: &[[f64; 4]]) {
        for pair in readings[self.seen.min(readings.len()).saturating_sub(1)..].windows(2) {
            let [last, now] = [pair[0][0], pair[1][0]];
            if now - last > self.longest.1 {
                self.longest = (last - readings[0][0], now - last);
            }
        }
        self.seen = readings.len();
    }

    pub(super) fn sentence(&self) -> Option<String> {
        let (at, length) = self.longest;
        let [at, long] = [at, length].map(|time| fixed(time, 1));
        let sentence =
            || format!("No readings for {long} s at {at} s: a hidden page, a dark screen or a lost connection.");
        (length > GAP).then(sentence)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(times: impl Iterator<Item = f64>) -> Option<String> {
        let readings: Vec<[f64; 4]> = times.map(|t| [t, 0.0, 9.8, 0.0]).collect();
        let mut health = Health::default();
        (0..=readings.len()).step_by(7).for_each(|count| health.follow(&readings[..count]));
        health.follow(&readings);
        health.sentence()
    }

    #[test]
    fn a_gap_has_its_sentence() {
        let even = || (0..1500).map(|k| 0.02 * f64::from(k));
        assert_eq!(said(even()), None);
        let gap = "No readings for 3.5 s at 12.0 s: a hidden page, a dark screen or a lost connection.";
        // The clock of the device began long before.
        assert_eq!(said(even().filter(|t| !(12.0..15.5).contains(t)).map(|t| t + 30.0)).as_deref(), Some(gap));
    }
}
