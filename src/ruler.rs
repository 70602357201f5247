//! Two marked times, A and B, and what lies between them.

mod decay;
mod table;

use kalmanscope_core::{Channel, Record};

use crate::session::Session;
use crate::theme::Palette;
use crate::visibility::Visibility;

pub use decay::{Decay, NoDecay};
pub(crate) use table::table_ui;

/// One of the two marks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The first.
    A,
    /// The second.
    B,
}

impl End {
    /// Both marks.
    pub const BOTH: [Self; 2] = [Self::A, Self::B];

    /// Its letter.
    pub const fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
        }
    }
}

/// The times that the user has marked.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ruler {
    /// A and B \[s\], none where not set.
    times: [Option<f64>; 2],
}

impl Ruler {
    /// The time of a mark \[s\].
    pub fn time(&self, end: End) -> Option<f64> {
        self.times[end as usize]
    }

    /// Sets A, then B, then moves the nearer of both.
    pub fn mark(&mut self, time: f64) {
        let end = match self.times {
            [None, _] => End::A,
            [_, None] => End::B,
            [Some(a), Some(b)] if (time - a).abs() < (time - b).abs() => End::A,
            _ => End::B,
        };
        self.place(end, time);
    }

    /// Puts a mark at a time \[s\].
    pub fn place(&mut self, end: End, time: f64) {
        self.times[end as usize] = Some(time);
    }

    /// Puts a mark at a time \[s\], or takes it away where it already is.
    pub fn toggle(&mut self, end: End, time: f64) {
        let mark = &mut self.times[end as usize];
        *mark = if *mark == Some(time) { None } else { Some(time) };
    }

    /// Takes both marks away.
    pub fn clear(&mut self) {
        self.times = [None; 2];
    }

    /// Whether any mark is set.
    pub fn is_used(&self) -> bool {
        self.times.iter().any(Option::is_some)
    }

    /// The values of what is shown at both marks; none without A.
    pub(crate) fn reading(&self, session: &Session, visible: &Visibility, palette: &Palette) -> Option<Reading> {
        let times = [self.times[0]?, self.times[1].unwrap_or_else(|| session.time())];
        let record = session.run().record();
        let samples = times.map(|time| session.sample_at(time));
        let mut rows = Vec::new();
        for channel in visible.channels(session.run().channels()) {
            let mut add = |name: &str, color, values: &[f64]| {
                if let [Some(a), Some(b)] = samples.map(|k| values.get(k).copied()) {
                    rows.push(Row { channel, name: name.to_owned(), color, values: [a, b] });
                }
            };
            if let Some(truth) = record.truth(channel).filter(|_| visible.truth) {
                add("truth", palette.truth, truth);
            }
            for estimates in session.run().estimates().iter().filter(|one| visible.filter(one.id())) {
                if let Some(at) = estimates.place(channel) {
                    add(estimates.name(), palette.shade(estimates.color()), estimates.canonical_means(at));
                }
            }
        }
        let decay = self.times[1].map(|_| Decay::between(samples, displacement(session), record));
        Some(Reading { times, is_b_set: self.times[1].is_some(), rows, decay })
    }
}

/// The first mass's displacement: the truth, or else the first filter's estimate.
fn displacement(session: &Session) -> &[f64] {
    let channel = Channel::displacement(0);
    let run = session.run();
    let of_filter = || run.estimates().first().and_then(|one| Some(one.canonical_means(one.place(channel)?)));
    run.record().truth(channel).or_else(of_filter).unwrap_or_default()
}

/// The numbers between A and B; without B, between A and playback.
pub(crate) struct Reading {
    /// \[s\]
    pub(crate) times: [f64; 2],
    pub(crate) is_b_set: bool,
    pub(crate) rows: Vec<Row>,
    pub(crate) decay: Option<Result<Decay, NoDecay>>,
}

/// A series at both marks.
pub(crate) struct Row {
    pub(crate) channel: Channel,
    /// Whose value it is.
    pub(crate) name: String,
    pub(crate) color: egui::Color32,
    pub(crate) values: [f64; 2],
}

impl Decay {
    fn between(samples: [usize; 2], motion: &[f64], record: &Record) -> Result<Self, NoDecay> {
        let [first, last] = [samples[0].min(samples[1]), samples[0].max(samples[1])];
        if (first..last).any(|k| record.force(k) != 0.0) {
            return Err(NoDecay::Forced);
        }
        Self::of(motion, first, last, record.dt())
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
        assert_eq!(End::BOTH.map(|end| ruler.time(end)), [Some(1.0), Some(9.0)]);
        ruler.toggle(End::A, 1.0);
        assert_eq!(ruler.time(End::A), None);
        ruler.clear();
        assert!(!ruler.is_used());
    }
}
