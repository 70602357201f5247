//! Two marked times, A and B.

use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RulerEnd {
    A,
    B,
}

impl RulerEnd {
    pub const BOTH: [Self; 2] = [Self::A, Self::B];

    pub const fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Ruler {
    /// A and B \[s\]. `None` if it is not set.
    times: [Option<f64>; 2],
}

impl Ruler {
    pub fn time(&self, end: RulerEnd) -> Option<f64> {
        self.times[end as usize]
    }

    pub fn mark(&mut self, time: f64) {
        let end = match self.times {
            [None, _] => RulerEnd::A,
            [_, None] => RulerEnd::B,
            [Some(a), Some(b)] if (time - a).abs() < (time - b).abs() => RulerEnd::A,
            _ => RulerEnd::B,
        };
        self.place(end, time);
    }

    pub fn place(&mut self, end: RulerEnd, time: f64) {
        self.times[end as usize] = Some(time);
    }

    pub fn toggle(&mut self, end: RulerEnd, time: f64) {
        let mark = &mut self.times[end as usize];
        *mark = if *mark == Some(time) { None } else { Some(time) };
    }

    pub fn clear(&mut self) {
        self.times = [None; 2];
    }

    /// The marks in whole nanoseconds, which a text gives back as they were.
    pub(crate) fn in_nanoseconds(self) -> Self {
        Self { times: self.times.map(|time| time.map(|time| (time * 1e9).round() / 1e9)) }
    }

    pub fn is_used(&self) -> bool {
        self.times.iter().any(Option::is_some)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_set_in_turn_and_then_the_nearer_one_moves() {
        let mut ruler = Ruler::default();
        for time in [2.0, 5.0, 1.0, 9.0] {
            ruler.mark(time);
        }
        assert_eq!(RulerEnd::BOTH.map(|end| ruler.time(end)), [Some(1.0), Some(9.0)]);
        ruler.toggle(RulerEnd::A, 1.0);
        assert_eq!(ruler.time(RulerEnd::A), None);
        ruler.clear();
        assert!(!ruler.is_used());
    }
}
