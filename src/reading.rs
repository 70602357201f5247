//! Compares the values at the marks A and B.

use egui::{Align2, Context, Grid, RichText, ScrollArea, TextStyle, Ui, vec2};
use kalmanscope_core::{Channel, Record};

use crate::request::Request;
use crate::ruler::{End, Ruler};
use crate::session::Session;
use crate::text::{decimals, fixed, in_hertz, significant};
use crate::theme::{self, Palette};
use crate::visibility::Visibility;

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

/// Frequency and damping, computed from two peaks of a free decay.
///
/// ```text
/// δ = ln(x₁ / x₂) / n,  ζ = δ / √(4π² + δ²),  T = (t₂ - t₁) / n,  ωₙ = 2π / (T √(1 - ζ²))
/// ```
///
/// Source: Chopra (2012), *Dynamics of Structures*, section 2.2.4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Decay {
    pub(crate) periods: usize,
    pub(crate) decrement: f64,
    pub(crate) damping_ratio: f64,
    /// Damped period \[s\].
    pub(crate) period: f64,
    /// Natural frequency \[rad/s\].
    pub(crate) natural_frequency: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoDecay {
    Forced,
    NoPeaks,
}

impl NoDecay {
    pub(crate) const fn words(self) -> &'static str {
        match self {
            Self::Forced => "ζ by hand needs a free decay: no force between A and B",
            Self::NoPeaks => "ζ by hand needs two falling peaks: put A and B near them",
        }
    }
}

impl Decay {
    /// The decay from the peak next to sample `first` to the peak of the same side next to `last`, of a motion with the time
    /// step `dt` \[s\].
    pub(super) fn of(motion: &[f64], first: usize, last: usize, dt: f64) -> Result<Self, NoDecay> {
        let peaks: Vec<Peak> = peaks(motion);
        let nearest = |to: usize, side: Option<bool>| {
            let of_side = peaks.iter().filter(|peak| side.is_none_or(|side| peak.is_above() == side));
            of_side.min_by(|a, b| a.distance(to).total_cmp(&b.distance(to)))
        };
        let one = nearest(first, None).ok_or(NoDecay::NoPeaks)?;
        let other = nearest(last, Some(one.is_above())).ok_or(NoDecay::NoPeaks)?;
        let between = |peak: &&Peak| peak.at > one.at && peak.at <= other.at && peak.is_above() == one.is_above();
        let periods = peaks.iter().filter(between).count();
        let ratio = one.value / other.value;
        if periods == 0 || ratio.is_nan() || ratio <= 1.0 {
            return Err(NoDecay::NoPeaks);
        }
        let decrement = ratio.ln() / periods as f64;
        let damping_ratio = decrement / (decrement * decrement + 4.0 * std::f64::consts::PI.powi(2)).sqrt();
        let period = (other.at - one.at) * dt / periods as f64;
        let natural_frequency = std::f64::consts::TAU / (period * (1.0 - damping_ratio * damping_ratio).sqrt());
        Ok(Self { periods, decrement, damping_ratio, period, natural_frequency })
    }
}

struct Peak {
    at: f64,
    value: f64,
}

impl Peak {
    fn is_above(&self) -> bool {
        self.value > 0.0
    }

    fn distance(&self, sample: usize) -> f64 {
        (self.at - sample as f64).abs()
    }
}

fn peaks(motion: &[f64]) -> Vec<Peak> {
    let mut peaks = Vec::new();
    let mut start = 0;
    for part in motion.chunk_by(|a, b| (*a > 0.0) == (*b > 0.0)) {
        let largest = (0..part.len()).max_by(|&i, &j| part[i].abs().total_cmp(&part[j].abs()));
        let k = start + largest.unwrap_or(0);
        if k > 0 && k + 1 < motion.len() {
            let [before, top, after] = [motion[k - 1], motion[k], motion[k + 1]];
            let curvature = before - 2.0 * top + after;
            if (top - before) * (after - top) <= 0.0 && curvature != 0.0 {
                let shift = 0.5 * (before - after) / curvature;
                peaks.push(Peak { at: k as f64 + shift, value: top - 0.25 * (before - after) * shift });
            }
        }
        start += part.len();
    }
    peaks
}

/// Limits the height of the rows \[points\].
const HEIGHT: f32 = 220.0;

pub(crate) fn table_ui(ctx: &Context, reading: &Reading, requests: &mut Vec<Request>) {
    let mut open = true;
    let window = egui::Window::new("From A to B").id(egui::Id::unique("ruler")).collapsible(true).resizable(false);
    let corner = ctx.content_rect().right_bottom() - vec2(12.0, 12.0);
    let window = window.open(&mut open).pivot(Align2::RIGHT_BOTTOM).default_pos(corner);
    window.show(ctx, |ui| {
        ui.style_mut().override_text_style = Some(TextStyle::Small);
        times_ui(ui, reading);
        ui.separator();
        ScrollArea::vertical().max_height(HEIGHT).show(ui, |ui| rows_ui(ui, reading));
        match &reading.decay {
            Some(Ok(decay)) => {
                ui.separator();
                decay_ui(ui, decay);
            }
            Some(Err(reason)) => {
                ui.small(reason.words());
            }
            None => {
                ui.small("Shift and a click in a plot, or the key B, sets B.");
            }
        }
    });
    if !open {
        requests.push(Request::ClearMarks);
    }
}

fn times_ui(ui: &mut Ui, reading: &Reading) {
    let [a, b] = reading.times;
    let between = b - a;
    let other = if reading.is_b_set { "B" } else { "now" };
    ui.label(format!("A {}   {other} {}   Δt {} s", fixed(a, 3), fixed(b, 3), fixed(between, 3)));
    if between != 0.0 {
        let frequency = 1.0 / between.abs();
        let angular = std::f64::consts::TAU * frequency;
        ui.weak(format!("as one period: {} Hz, {} rad/s", significant(frequency, 4), significant(angular, 4)));
    }
}

fn rows_ui(ui: &mut Ui, reading: &Reading) {
    Grid::new("from A to B").num_columns(5).striped(true).spacing([12.0, 1.0]).show(ui, |ui| {
        for heading in ["", "", "A", if reading.is_b_set { "B" } else { "now" }, "Δ"] {
            ui.weak(heading);
        }
        ui.end_row();
        let mut last = None;
        for row in &reading.rows {
            let is_new = last != Some(row.channel);
            last = Some(row.channel);
            let symbol = if is_new { row.channel.symbol() } else { "" };
            ui.label(RichText::new(symbol).family(theme::strong()));
            ui.colored_label(row.color, &row.name);
            let digits = decimals(row.channel);
            let [a, b] = row.values;
            for value in [a, b, b - a] {
                let label = ui.label(fixed(value, digits));
                if let Some(hertz) = in_hertz(value, row.channel.unit()) {
                    label.on_hover_text(hertz);
                }
            }
            ui.end_row();
        }
    });
}

fn decay_ui(ui: &mut Ui, decay: &Decay) {
    let Decay { periods, decrement, damping_ratio, period, natural_frequency } = *decay;
    let times = if periods == 1 { "period" } else { "periods" };
    ui.label(format!(
        "By hand, from the peaks next to A and B, {periods} {times} apart: T {} s, δ {}",
        significant(period, 4),
        significant(decrement, 3)
    ));
    let [frequency, damping] = [significant(natural_frequency, 4), significant(damping_ratio, 3)];
    let hertz = significant(natural_frequency / std::f64::consts::TAU, 4);
    ui.label(format!("ωₙ {frequency} rad/s ({hertz} Hz), ζ {damping}"));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn free(natural_frequency: f64, damping_ratio: f64, dt: f64) -> Vec<f64> {
        let damped = natural_frequency * (1.0 - damping_ratio * damping_ratio).sqrt();
        let at = |t: f64| (-damping_ratio * natural_frequency * t).exp() * (damped * t).cos();
        (0..2000).map(|k| at(f64::from(k) * dt)).collect()
    }

    #[test]
    fn two_peaks_of_a_free_decay_tell_frequency_and_damping() {
        for (natural_frequency, damping_ratio) in [(6.0, 0.05), (6.0, 0.01), (12.0, 0.1)] {
            let motion = free(natural_frequency, damping_ratio, 0.01);
            let decay = Decay::of(&motion, 90, 430, 0.01).unwrap();
            assert!((decay.damping_ratio / damping_ratio - 1.0).abs() < 0.01, "{decay:?}");
            assert!((decay.natural_frequency / natural_frequency - 1.0).abs() < 0.002, "{decay:?}");
            assert!(decay.periods >= 3);
        }
    }

    #[test]
    fn where_nothing_falls_there_is_no_decay() {
        let growing: Vec<f64> = free(6.0, 0.05, 0.01).into_iter().rev().collect();
        assert_eq!(Decay::of(&growing, 1500, 1800, 0.01), Err(NoDecay::NoPeaks));
        assert_eq!(Decay::of(&free(6.0, 0.05, 0.01), 100, 110, 0.01), Err(NoDecay::NoPeaks));
        for flat in [&[][..], &[0.0; 50], &[1.0; 50]] {
            assert_eq!(Decay::of(flat, 0, 40, 0.01), Err(NoDecay::NoPeaks));
        }
    }
}
