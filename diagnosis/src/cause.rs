//! Causes by name, each with its evidence and the edit that repairs it.

mod changes;
mod disagreement;
mod input;
mod noise;
mod plant;
mod sensors;

pub use changes::change_point;
pub use disagreement::Agreement;
pub use input::still_part;
pub use sensors::Readings;

use std::ops::{Range, RangeInclusive};

use kalmanscope_core::setting::Edit;
use kalmanscope_core::{Channel, FilterSettings, Quantity, Scenario};

use super::case::Case;
use super::checks::{Evidence, Subject};
use super::periodogram::Periodogram;
use super::sums::{FIRST_CROSS_LAG, SensorInnovations};

/// Every cause. A new one is an item of a file and a line here.
pub static CAUSES: &[&Cause] = &[
    &noise::WIND_UP,
    &noise::COLLAPSED_SAMPLE,
    &changes::NO_EXCITATION,
    &disagreement::SIGN,
    &disagreement::TIMES,
    &disagreement::SCALE_OF,
    &disagreement::LATENESS,
    &sensors::OUTLIERS,
    &sensors::CLIPPED,
    &sensors::STICKING,
    &sensors::COARSE,
    &noise::SENSOR_NOISE,
    &noise::CHANGING_NOISE,
    &noise::FELT_DISTURBANCE,
    &noise::PROCESS_NOISE,
    &input::INPUT_DELAY,
    &input::INPUT_HOLD,
    &input::INPUT_GAIN,
    &input::INPUT_OFFSET,
    &input::STILL_INPUT,
    &plant::UNKNOWN_FORCE,
    &plant::PERIODIC_FORCE,
    &sensors::SENSOR_BIAS,
    &plant::SPRING,
    &plant::DRY_FRICTION,
    &plant::DRAG,
    &plant::MISSING_MODE,
    &changes::SUDDEN_CHANGE,
    &changes::SLOW_DRIFT,
    &changes::INITIAL_GUESS,
    &input::COARSE_PROPAGATION,
    &input::ABSOLUTE_ACCELERATION,
    &sensors::COLOURED_NOISE,
    &sensors::WRAPS,
    &noise::WHITE_FORCE,
    &noise::COMMON_NOISE,
    &plant::UNEVEN_SPRING,
    &plant::DAMPING_OF_SWING,
    &plant::SWINGING_STIFFNESS,
    &plant::CREEP,
];

/// Causes to try on a consistent filter: a wrong model can have white innovations too. After a recovery the first three.
pub(super) static ALTERNATIVES: &[&Cause] = &[
    &input::COARSE_PROPAGATION,
    &input::INPUT_HOLD,
    &noise::WHITE_FORCE,
    &plant::SPRING,
    &plant::DRY_FRICTION,
    &plant::DRAG,
    &changes::SLOW_DRIFT,
    &noise::COLLAPSED_SAMPLE,
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
    /// Whether its trial may restart the filter at the first of `samples`, if that is likelier: an edit acts slowly on a sudden change.
    pub begins_anew: bool,
    /// The kept samples in which it happened, if it has a time.
    pub samples: Option<Range<usize>>,
    /// The parameter whose sign counts, with the sentences for a positive and a negative one.
    pub(crate) sign: Option<(Channel, [&'static str; 2])>,
    /// Whether a hardening spring, or a slow force that fits as well, rules it out.
    pub(crate) softens: bool,
    pub(crate) renews_guess: bool,
    pub(crate) of_record: bool,
    /// Whether its remedy silences a sensor instead of explaining it: it comes after every other cause.
    pub(crate) silences: bool,
}

pub(crate) struct BadFilter<'a> {
    pub(crate) case: &'a Case<'a>,
    pub(crate) evidence: &'a [Evidence],
    pub(crate) scenario: &'a Scenario,
    pub(crate) filter: &'a FilterSettings,
    pub(crate) origin: &'a FilterSettings,
}

impl BadFilter<'_> {
    pub(crate) fn effect_of(&self, is: impl Fn(&Evidence) -> bool) -> f64 {
        let effects = self.evidence.iter().filter(|one| one.counts && is(one)).map(|one| one.effect);
        let largest = effects.fold(0.0, f64::max);
        largest / (1.0 + largest)
    }

    pub(crate) fn effect_of_pattern(&self) -> f64 {
        self.effect_of(|one| one.test.name.contains("spectrum") || one.test.name.contains("whiteness"))
    }

    pub(crate) fn effect_of_lines(&self) -> f64 {
        self.effect_of(|one| one.test.name.contains("spectrum") && one.subject != Subject::All)
    }

    pub(crate) fn follows_input(&self, lags: RangeInclusive<i32>) -> f64 {
        let of = |one: &SensorInnovations| (FIRST_CROSS_LAG..).zip(one.cross_correlation(&self.case.kept));
        let chosen = self.case.sensors.iter().flat_map(of).filter(|(lag, _)| lags.contains(lag));
        chosen.fold(0.0, |most: f64, (_, r)| most.max(r.abs()))
    }

    pub(crate) fn frequency(&self) -> Option<f64> {
        let place = self.case.estimates.place(Channel::NATURAL_FREQUENCY)?;
        Some(self.case.estimates.initial_mean(place).abs())
    }

    pub(crate) fn edit(&self, key: &str, value: impl Into<toml::Value>) -> Edit {
        Edit::of_filter(self.filter.id, key, value)
    }

    pub(crate) fn entry(&self, table: &str, channel: Channel, value: f64) -> Edit {
        self.edit(&format!("{table}.{}", channel.key()), value)
    }

    pub(crate) fn begins(&self, key: &str, mean: f64, std: f64) -> [Edit; 3] {
        [("initial_mean", mean), ("initial_std", std), ("process_std", 0.0)]
            .map(|(table, value)| self.edit(&format!("{table}.{key}"), value))
    }

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
    pub(crate) fn new(cause: &'static Cause, weight: f64, fitted: f64, edits: Vec<Edit>, sentence: String) -> Self {
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

    /// The evidence is enough without a trial, and the record itself shows it, without a model: it comes before every other cause.
    pub(crate) fn of_record(self) -> Self {
        Self { certain: true, of_record: true, ..self }
    }
}

fn rms(values: &[f64]) -> f64 {
    let (sum, count) = values.iter().filter(|x| x.is_finite()).fold((0.0, 0_u32), |(sum, n), x| (sum + x * x, n + 1));
    (sum / f64::from(count.max(1))).sqrt()
}
