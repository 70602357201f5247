//! Causes by name, each with its evidence and the edit that repairs it.

mod changing_noise;
mod clipped;
mod coarse;
mod collapsed_sample;
mod disagreement;
mod drag;
mod dry_friction;
mod felt_disturbance;
mod initial_guess;
mod input_delay;
mod input_gain;
mod input_hold;
mod input_offset;
mod missing_mode;
mod no_excitation;
mod outliers;
mod own_equation;
mod periodic_force;
mod process_noise;
mod sensor_bias;
mod sensor_noise;
mod slow_drift;
mod spring;
mod sticking;
mod still_input;
mod sudden_change;
mod unknown_force;
mod wind_up;

use std::ops::Range;

use super::case::Case;
use super::evidence::Evidence;
use super::periodogram::Periodogram;
use crate::data::setting::Edit;
use crate::{Channel, FilterSettings, Quantity, Scenario};

/// Every cause. A new one is a file and a line here.
pub static CAUSES: &[&Cause] = &[
    &wind_up::CAUSE,
    &collapsed_sample::CAUSE,
    &no_excitation::CAUSE,
    &disagreement::SIGN,
    &disagreement::TIMES,
    &disagreement::SCALE_OF,
    &disagreement::LATENESS,
    &outliers::CAUSE,
    &clipped::CAUSE,
    &sticking::CAUSE,
    &coarse::CAUSE,
    &sensor_noise::CAUSE,
    &changing_noise::CAUSE,
    &felt_disturbance::CAUSE,
    &process_noise::CAUSE,
    &input_delay::CAUSE,
    &input_hold::CAUSE,
    &input_gain::CAUSE,
    &input_offset::CAUSE,
    &still_input::CAUSE,
    &unknown_force::CAUSE,
    &periodic_force::CAUSE,
    &sensor_bias::CAUSE,
    &spring::CAUSE,
    &dry_friction::CAUSE,
    &drag::CAUSE,
    &missing_mode::CAUSE,
    &sudden_change::CAUSE,
    &slow_drift::CAUSE,
    &initial_guess::CAUSE,
];

/// A possible cause of a bad verdict.
#[derive(Debug)]
pub struct Cause {
    /// The key in files and links; it never changes.
    pub key: &'static str,
    /// The name in running text.
    pub name: &'static str,
    /// Its symptoms and its remedy.
    pub hint: &'static str,
    /// Appends one likely cause for each way in which it may be the cause.
    pub(crate) likely_causes: fn(&BadFilter<'_>, &'static Self, &mut Vec<LikelyCause>),
}

/// One way in which a cause may be the one: the edit, and how likely it is before it is tried.
#[derive(Clone, Debug)]
pub struct LikelyCause {
    /// The cause.
    pub cause: &'static Cause,
    /// The cause in words and numbers; empty if it only undoes the edit of an earlier cause.
    pub sentence: String,
    /// The share of the evidence that it explains, from 0 to 1, estimated without a trial.
    pub weight: f64,
    /// Whether the evidence is enough without a trial: the likelihood cannot decide.
    pub certain: bool,
    /// The edits that repair it.
    pub edits: Vec<Edit>,
    /// The number of values that they fit to the record.
    pub fitted: f64,
    /// Whether its trial also counts the likelihood of a filter that is restarted at the first of `samples`, and takes
    /// the larger one: an edit acts too slowly on a sudden change.
    pub begins_anew: bool,
    /// The kept samples in which it happened, if it has a time.
    pub samples: Option<Range<usize>>,
    /// The parameter that the trial estimates; its sign chooses the sentence.
    pub(crate) sign: Option<Sign>,
    /// Whether a hardening spring, once found, rules it out.
    pub(crate) softens: bool,
    /// Whether its remedy begins with another guess of the frequency too.
    pub(crate) renews_guess: bool,
    /// Whether the record itself shows it, without a model: it comes before every other cause.
    pub(crate) of_record: bool,
    /// Whether its remedy silences a sensor instead of explaining it: it comes after every other cause.
    pub(crate) silences: bool,
}

/// A parameter with a sentence for each of its signs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sign {
    pub(crate) channel: Channel,
    pub(crate) positive: &'static str,
    pub(crate) negative: &'static str,
}

/// A filter with a bad verdict.
pub(crate) struct BadFilter<'a> {
    pub(crate) case: &'a Case<'a>,
    pub(crate) evidence: &'a [Evidence],
    pub(crate) scenario: &'a Scenario,
    pub(crate) filter: &'a FilterSettings,
    /// The filter before the edits of other causes were made: sentences compare with it.
    pub(crate) origin: &'a FilterSettings,
}

impl BadFilter<'_> {
    /// The largest effect of a chosen test, among the evidence that counts, from 0 to 1.
    pub(crate) fn effect_of(&self, is: impl Fn(&Evidence) -> bool) -> f64 {
        let effects = self.evidence.iter().filter(|one| one.counts && is(one)).map(|one| one.effect);
        let largest = effects.fold(0.0, f64::max);
        largest / (1.0 + largest)
    }

    /// An edit of this filter.
    pub(crate) fn edit(&self, key: &str, value: impl Into<toml::Value>) -> Edit {
        Edit::of_filter(self.filter.id, key, value)
    }

    /// The edit that gives the filter one augmentation more.
    pub(crate) fn augmented(&self, channel: Channel) -> Edit {
        let keys = self.filter.augment.iter().chain([&channel]).map(|one| one.key().to_owned());
        self.edit("augment", keys.collect::<Vec<String>>())
    }

    /// The root mean square of the estimated displacement of the first mass, which loads the springs \[m\].
    pub(crate) fn size(&self) -> f64 {
        let Some(place) = self.case.estimates.place(Channel::DISPLACEMENT) else { return 0.0 };
        rms(&self.case.estimates.canonical_means(place)[self.case.samples.clone()])
    }

    /// The highest line in the spectra of the innovations: its power over the mean, and its frequency \[rad/s\].
    pub(crate) fn line(&self) -> Option<(f64, f64)> {
        let lines = self.case.sensors.iter().filter_map(|one| {
            let (power, turn) = one.periodogram.peak()?;
            Some((power / one.periodogram.mean(), turn / self.case.record.dt()))
        });
        lines.max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The frequency with the most power in the measurements of displacement or velocity \[rad/s\].
    pub(crate) fn measured_peak(&self) -> Option<f64> {
        let record = self.case.record;
        let is_motion = |sensor: &Quantity| [Quantity::DISPLACEMENT, Quantity::VELOCITY].contains(sensor);
        let quantity = self.case.sensors.iter().map(|one| one.sensor).find(is_motion)?;
        let measured = record.measured_quantity(quantity)?.iter();
        let values: Vec<f64> = measured.map(|x| if x.is_nan() { 0.0 } else { *x }).collect();
        let all = 0..values.len();
        let (_, turn) = Periodogram::of_all(&[values], &[all]).first()?.peak()?;
        Some(turn / record.dt())
    }

    /// The root mean square of the input \[m/s²\].
    pub(crate) fn input_size(&self) -> f64 {
        rms(&self.case.record.input()[self.case.samples.clone()])
    }
}

impl LikelyCause {
    /// A likely cause whose edits fit `fitted` numbers to the record.
    pub(crate) fn new(cause: &'static Cause, weight: f64, fitted: f64, edits: Vec<Edit>, sentence: String) -> Self {
        // Numbers are tried as they are told and written.
        let edits = edits.into_iter().map(|edit| edit.rounded()).collect();
        Self {
            cause,
            sentence,
            weight,
            certain: false,
            edits,
            fitted,
            begins_anew: false,
            samples: None,
            sign: None,
            softens: false,
            renews_guess: false,
            of_record: false,
            silences: false,
        }
    }
}

/// The root mean square of some values without NaN.
fn rms(values: &[f64]) -> f64 {
    let (sum, count) = values.iter().filter(|x| x.is_finite()).fold((0.0, 0_u32), |(sum, n), x| (sum + x * x, n + 1));
    (sum / f64::from(count.max(1))).sqrt()
}
