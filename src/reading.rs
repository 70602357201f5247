//! Compares the values at the marks A and B.

mod decay;
mod table;

use kalmanscope_core::{Channel, Record};

use crate::ruler::{End, Ruler};
use crate::session::Session;
use crate::theme::Palette;
use crate::visibility::Visibility;

use decay::{Decay, NoDecay};
pub(crate) use table::table_ui;

fn displacement(session: &Session) -> &[f64] {
    let channel = Channel::displacement(0);
    let run = session.run();
    let of_filter = || run.estimates().first().and_then(|one| Some(one.canonical_means(one.place(channel)?)));
    run.record().truth(channel).or_else(of_filter).unwrap_or_default()
}

pub(crate) struct Reading {
    /// \[s\]
    pub(crate) times: [f64; 2],
    pub(crate) is_b_set: bool,
    pub(crate) rows: Vec<Row>,
    pub(crate) decay: Option<Result<Decay, NoDecay>>,
}

pub(crate) struct Row {
    pub(crate) channel: Channel,
    pub(crate) name: String,
    pub(crate) color: egui::Color32,
    pub(crate) values: [f64; 2],
}

impl Reading {
    pub(crate) fn of(ruler: &Ruler, session: &Session, visible: &Visibility, palette: &Palette) -> Option<Self> {
        let b = ruler.time(End::B);
        let times = [ruler.time(End::A)?, b.unwrap_or_else(|| session.time())];
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
        let decay = b.map(|_| Decay::between(samples, displacement(session), record));
        Some(Self { times, is_b_set: b.is_some(), rows, decay })
    }
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
