//! The settings of a filter, each with its row where it is a number or a yes or no, and its colour.

use std::sync::LazyLock;

use crate::document::{is_default, is_one};
use kalmanscope_filters::filter::{Adaptation, FilterKind, MethodSettings, Propagation, Robust};
use kalmanscope_filters::{Channel, InputKind};
use kalmanscope_records::record::Delays;
use serde::de::{Error as _, IntoDeserializer as _};
use serde::{Deserialize, Deserializer, Serialize};

use super::row::{Allowed, Field, SettingInfo, row, settings};
use super::{Bounds, Values, values};

use crate::{Model, PlantKind};

/// Limits the samples by which the plant can feel the input after or before it is recorded.
pub(crate) const MAX_DELAY: i64 = 100;

/// Limits the samples that a smoother keeps which goes along with a run without an end.
const LONGEST_LAG: usize = 10_000;

settings! {
    /// One filter: its initial belief and the noise that it assumes of the model and the sensors.
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
    #[serde(default, deny_unknown_fields, expecting = "a table")]
    pub struct FilterSettings {
        /// The filter's number, from 1 on, for its random numbers and its colour; 0, or no entry in a file, for that of its place.
        #[serde(skip_serializing_if = "is_default")]
        pub id: u32 = 0;
        /// The name on screen, in files and in keys, of which each filter has its own; that of its kind if empty.
        #[serde(deserialize_with = "super::identity::name")]
        pub name: String = String::new();
        /// The kind of filter.
        pub kind: FilterKind = FilterKind::EKF;
        /// The colour in which the filter is drawn; that of its id if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub color: Option<FilterColor> = None;
        /// The kind of plant that the filter assumes; the truth's own if left out.
        #[serde(skip_serializing_if = "Option::is_none")]
        pub plant: Option<PlantKind> = None;
        /// The augmentations in the filter's state; one with zero standard deviations is held constant.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        pub augment: Vec<Channel> = Vec::new();
        /// Parameters and augmentations that it does not estimate, but whose uncertainty it counts (Schmidt 1966).
        #[serde(skip_serializing_if = "Vec::is_empty")]
        pub consider: Vec<Channel> = Vec::new();
        /// The least and the most that parameters and augmentations can be; estimates are moments of the belief between them.
        #[serde(skip_serializing_if = "Bounds::is_empty")]
        pub bounds: Bounds = Bounds::default();
        /// The number of samples after which the plant feels the recorded input; negative where the record is late.
        #[serde(skip_serializing_if = "is_default")]
        pub input_delay: i32 = 0;
        INPUT_DELAY: input_delay, "delay of the input" {
            unit: "samples",
            allowed: Allowed::Whole(-MAX_DELAY, MAX_DELAY),
        }
        /// Whether it estimates the logarithms of parameters that cannot be negative; their std are over the initial mean.
        pub log_parameters: bool = false;
        LOG_PARAMETERS: log_parameters, "logarithms of positive parameters" {
            allowed: Allowed::Flag,
            hint: "Estimate the logarithms of frequency, damping and stiffness, which then stay positive",
        }
        /// The propagation of the mean of a KF, EKF or IEKF; that which [suits the plant](Self::propagation_for) if left out.
        #[serde(deserialize_with = "propagation", skip_serializing_if = "Option::is_none")]
        pub propagation: Option<Propagation> = None;
        /// The number of steps into which a prediction is divided; 0 for as many as [the plant asks for](Self::steps).
        #[serde(skip_serializing_if = "is_default")]
        pub substeps: usize = 0;
        SUBSTEPS: substeps, "substeps per sample" {
            allowed: Allowed::Whole(0, 100),
            note: "0 for as many as accuracy needs",
            slider: (0.0, 20.0),
            hint: "Divide each prediction into this number of steps; 0 takes one step on a linear plant, and on others \
                   as many as accuracy needs",
        }
        /// Limits the linearisations of the sensors in one update of an IEKF, which stops earlier once it has converged.
        pub iterations: usize = 5;
        ITERATIONS: iterations, "iterations" {
            allowed: Allowed::Whole(1, 100),
            slider: (1.0, 20.0),
            hint: "Limit of the linearisations of the sensors in one update",
            serves: |filter, _| filter.kind == FilterKind::IEKF,
        }
        /// The number of guesses of the natural frequency, of which the likeliest so far is reported. 1 for the initial mean alone.
        #[serde(skip_serializing_if = "is_one")]
        pub guesses: usize = 1;
        GUESSES: guesses, "guesses of ωₙ" {
            allowed: Allowed::Whole(1, 8),
            slider: (1.0, 8.0),
            hint: "Run this many filters side by side, with guesses of ωₙ from 0.14 to 7.4 times the initial mean, and \
                   show the likeliest",
            serves: |filter, truth| filter.has_frequency(truth) && filter.can_have("guesses"),
        }
        /// The number of filters side by side with √Q from 1/30 to 30 times its setting, whose mixture is reported. 1 for Q as it is.
        #[serde(skip_serializing_if = "is_one")]
        pub process_scales: usize = 1;
        PROCESS_SCALES: process_scales, "scales of Q" {
            allowed: Allowed::Whole(1, 41),
            note: "1 for Q as it is set",
            slider: (1.0, 25.0),
            hint: "Run this many filters side by side, with √Q from 1/30 to 30 times its setting. Their likelihoods \
                   give the size of Q, with ±2σ, and the plots show their mixture. 17 are usually enough (Magill 1965)",
            serves: |filter, _| filter.can_have("process_scales"),
        }
        /// The number of members of an EnKF, or of particles of a PF.
        // 200 particles are too few for four parameters and their motion.
        pub ensemble_size: usize = 500;
        ENSEMBLE_SIZE: ensemble_size, "members" {
            label: |filter| filter.kind.info().has_own_likelihood.then_some("particles"),
            allowed: Allowed::Whole(2, 100_000),
            slider: (2.0, 2000.0),
            hint: "More are more exact, and slower",
            serves: |filter, _| filter.kind.is_sampled(),
        }
        /// Whether the filter learns R and Q from its innovations.
        pub adaptation: Adaptation = Adaptation::default();
        LEARNS_R: adaptation.sensor_noise, "learn R from the innovations" {
            allowed: Allowed::Flag,
            hint: "Akhlaghi, Zhou and Huang (2017)",
        }
        LEARNS_Q: adaptation.process_noise, "learn Q from the innovations" {
            allowed: Allowed::Flag,
            hint: "Akhlaghi, Zhou and Huang (2017)",
        }
        FORGETTING: adaptation.forgetting, "share that stays in learning" {
            allowed: Allowed::Between(0.0, 1.0),
        }
        TRAINING: adaptation.training, "training of the learnt noise" {
            label: |_| Some("training"),
            unit: "s",
            allowed: Allowed::AtLeast(0.0),
            note: "0 learns all the time",
            slider: (0.0, 60.0),
            hint: "Learn R and Q for this many seconds, then keep them; 0 learns all the time",
            serves: |filter, _| filter.adaptation.is_on() || filter.process_scales > 1,
        }
        /// Whether the filter widens P by its initial covariance, once, where its innovations grow at once.
        #[serde(skip_serializing_if = "is_default")]
        pub jump: bool = false;
        JUMP: jump, "jump at a sudden change" {
            allowed: Allowed::Flag,
            hint: "If the innovations suddenly grow, widen P once by its initial covariance, and learn again. \
                   Otherwise forget nothing. A remark says when",
            serves: |filter, _| filter.can_have("jump"),
        }
        /// w \[1/√s\] of a bank of two models: in the second, parameters walk by w initial std in a second. 0 for one model.
        #[serde(skip_serializing_if = "is_default")]
        pub walk: f64 = 0.0;
        WALK: walk, "walk of a bank's second model" {
            symbol: "w",
            label: |_| Some("drift of the bank w"),
            unit: "1/√s",
            allowed: Allowed::AtLeast(0.0),
            note: "0 for no bank",
            slider: (0.0, 2.0),
            hint: "Mix two filters by the likelihood of their readings. In one, parameters are constant; in the other, \
                   they walk by this many initial σ in a second. 0 for one filter (IMM: Blom and Bar-Shalom 1988)",
            serves: |filter, _| filter.can_have("walk"),
            is_varied: true,
        }
        /// How measurements that do not fit are weighed. A filter that learns R or samples its belief weighs none.
        #[serde(skip_serializing_if = "is_default")]
        pub robust: Robust = Robust::NONE;
        /// Whether the whole record is smoothed once the filter has seen it. Fading counts as process noise then.
        pub smoother: bool = false;
        SMOOTHER: smoother, "hindsight" {
            allowed: Allowed::Flag,
            hint: "For the whole record, also show, dashed, each estimate with the help of all later readings: Rauch, \
                   Tung and Striebel (1965)",
            serves: |filter, _| filter.can_have("smoother"),
        }
        /// The time after each sample of which its smoothed estimate knows \[s\], 10,000 samples at most; 0 for all of the record.
        #[serde(skip_serializing_if = "is_default")]
        pub look_ahead: f64 = 0.0;
        LOOK_AHEAD: look_ahead, "look-ahead of hindsight" {
            label: |_| Some("look-ahead"),
            unit: "s",
            allowed: Allowed::AtLeast(0.0),
            note: "0 waits for the whole record",
            slider: (0.0, 5.0),
            hint: "Hindsight of this many seconds follows the filter with that delay, of at most 10,000 samples; 0 \
                   waits for the whole record",
            serves: |filter, _| filter.smoother,
        }
        /// Fading factor λ ≥ 1 on the predicted covariance; 1 forgets nothing.
        pub fading: f64 = 1.0;
        FADING: fading, "fading factor" {
            symbol: "λ",
            label: |_| Some("λ fading factor"),
            allowed: Allowed::AtLeast(1.0),
            note: "1 forgets nothing",
            slider: (1.0, 1.05),
            hint: "Multiplies the predicted covariance at every step: 1 forgets nothing, more forgets faster",
            is_varied: true,
        }
        /// Rate η ≥ 0 at which the model lets the parameters decay \[1/s\]; 0 keeps them constant.
        pub eta: f64 = 0.0;
        ETA: eta, "parameter decay" {
            symbol: "η",
            label: |_| Some("η decay"),
            unit: "1/s",
            allowed: Allowed::AtLeast(0.0),
            slider: (0.0, 0.1),
            hint: "Rate at which the parameters decay in the filter's model; 0 keeps them constant",
            serves: |filter, _| filter.kind != FilterKind::KF,
            is_varied: true,
        }
        /// Standard deviations of the sensors: the square roots of the diagonal of R. The true ones if empty in a file.
        pub sensor_std: Vec<f64> = Vec::new();
        /// The time by which each sensor is late, negative where it is early \[s\]. No sensor is if the list is empty.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        pub sensor_delay: Vec<f64> = Vec::new();
        /// The times at which the motion begins again, pulled by an unknown force, in rising order \[s\].
        #[serde(skip_serializing_if = "Vec::is_empty")]
        pub plucks: Vec<f64> = Vec::new();
        /// Mean of the initial belief.
        #[serde(deserialize_with = "values::initial_mean")]
        pub initial_mean: Values = Values::INITIAL_MEAN;
        /// Standard deviations of the initial belief.
        #[serde(deserialize_with = "values::initial_std")]
        pub initial_std: Values = Values::INITIAL_STD;
        /// Standard deviations of the process noise per step: the square roots of the diagonal of Q.
        #[serde(deserialize_with = "values::process_std")]
        pub process_std: Values = Values::PROCESS_STD;
        /// The correlation times of biases, input offset and unknown force, as Gauss-Markov processes; 0 for one that lasts \[s\].
        #[serde(deserialize_with = "values::correlation_time", skip_serializing_if = "is_default")]
        pub correlation_time: Values = Values::ZERO;
    }
}

type Row = SettingInfo<FilterSettings>;

/// The settings that are shown first: how long the filter remembers.
pub static MEMORY: [&Row; 2] = [&FADING, &ETA];

/// The ways in which parameters may change, one of which a filter has: in words, and the value that turns it on.
pub static CHANGES: [(&Row, &str, f64); 3] =
    [(&WALK, "walk", 0.1), (&JUMP, "jump", 1.0), (&PROCESS_SCALES, "Q of unknown size", 17.0)];

static ORDER: [&Row; 15] = [
    &FADING,
    &ETA,
    &JUMP,
    &WALK,
    &PROCESS_SCALES,
    &GUESSES,
    &SUBSTEPS,
    &ITERATIONS,
    &ENSEMBLE_SIZE,
    &LOG_PARAMETERS,
    &SMOOTHER,
    &LOOK_AHEAD,
    &LEARNS_R,
    &LEARNS_Q,
    &TRAINING,
];

static ALL: LazyLock<Vec<&Row>> =
    LazyLock::new(|| ORDER.into_iter().chain(ROWS.iter().copied().filter(|row| !ORDER.contains(row))).collect());

/// All settings of a filter that are one number each, or a yes or no.
pub fn of_filter() -> impl Iterator<Item = &'static Row> {
    ALL.iter().copied()
}

/// The less common settings. One without a hint is set in files alone.
pub fn options() -> impl Iterator<Item = &'static Row> {
    let is_elsewhere = |row: &Row| MEMORY.contains(&row) || CHANGES.iter().any(|(other, ..)| *other == row);
    of_filter().filter(move |row| !row.hint.is_empty() && !is_elsewhere(row))
}

impl FilterSettings {
    /// The delays that the filter assumes, in steps of `dt` \[s\].
    pub fn delays(&self, dt: f64) -> Delays {
        Delays::new(self.input_delay, self.sensor_delay.iter().map(|late| late / dt))
    }

    /// The filter's model of a truth of this kind under this input.
    pub fn model(&self, truth: &PlantKind, input: InputKind) -> Model {
        // The parameters of a KF are known and do not decay.
        let eta = if self.kind == FilterKind::KF { 0.0 } else { self.eta };
        let model = Model::new(self.plant.as_ref().unwrap_or(truth).clone())
            .augmented(self.augment.iter().copied())
            .forgetting(self.correlation_time.iter());
        model.decaying(eta).with_logarithms(self.log_parameters).driven_by(input)
    }

    /// The samples, at least one, after each one of which its smoothed estimate knows; `None` for all of the record.
    pub fn lag(&self, dt: f64) -> Option<usize> {
        (self.look_ahead > 0.0).then(|| ((self.look_ahead / dt).round() as usize).clamp(1, LONGEST_LAG))
    }

    /// The settings that its method reads, of a truth of this kind.
    pub fn method(&self, truth: &PlantKind) -> MethodSettings {
        let Self { iterations, ensemble_size, .. } = *self;
        MethodSettings { propagation: self.propagation_for(truth), iterations, ensemble_size }
    }

    /// The channels of a filter of this truth that it can consider, or that can have bounds.
    pub fn considerable<'a>(&'a self, truth: &'a PlantKind) -> impl Iterator<Item = Channel> + 'a {
        let of_plant = self.plant.as_ref().unwrap_or(truth).parameters().filter(|channel| !self.knows(*channel));
        of_plant.chain(self.augment.iter().copied().filter(|channel| *channel != Channel::WHITE_FORCE))
    }

    pub(crate) fn has_frequency(&self, truth: &PlantKind) -> bool {
        let frequency = Channel::NATURAL_FREQUENCY;
        let channels = self.plant.as_ref().unwrap_or(truth).channels();
        channels.contains(&frequency) && !self.knows(frequency) && self.initial_mean[frequency] > 0.0
    }

    /// The settings without the numbers in which the lanes of a batch may differ.
    pub(crate) fn of_batch(&self) -> Self {
        let Self { id, name, color, input_delay, sensor_delay, fading, sensor_std, .. } = Self::default();
        let (initial_mean, initial_std, process_std) = (Values::ZERO, Values::ZERO, Values::ZERO);
        let plain = Self { id, name, color, input_delay, sensor_delay, fading, sensor_std, ..self.clone() };
        Self { initial_mean, initial_std, process_std, ..plain }
    }

    /// Whether the filter takes a channel as exact: a KF does so for the parameters of its plant.
    pub fn knows(&self, channel: Channel) -> bool {
        self.kind == FilterKind::KF && channel.is_parameter() && !channel.is_augmentation()
    }
}

fn propagation<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Propagation>, D::Error> {
    const WORDS: [&str; 4] = ["automatic", "local_linearisation", "runge_kutta", "euler"];
    let word = String::deserialize(deserializer)?;
    if word == WORDS[0] {
        return Ok(None);
    }
    if !WORDS.contains(&word.as_str()) {
        return Err(D::Error::unknown_variant(&word, &WORDS));
    }
    Propagation::deserialize(word.into_deserializer()).map(Some)
}

/// A colour of the palette of Okabe and Ito, which colour-blind readers can distinguish. Each theme chooses the shade.
///
/// Source: Okabe and Ito (2008), Color Universal Design.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FilterColor {
    /// Blue.
    Blue,
    /// Vermilion, a red that leans to orange.
    Vermilion,
    /// Bluish green.
    Green,
    /// Reddish purple.
    Purple,
    /// Orange.
    Orange,
    /// Sky blue.
    Sky,
}

impl FilterColor {
    /// Every colour, in the order in which filters get them.
    pub const ALL: [Self; 6] = [Self::Blue, Self::Vermilion, Self::Green, Self::Purple, Self::Orange, Self::Sky];

    /// The colour of the filter with this id, unless it has one of its own.
    pub const fn of(id: u32) -> Self {
        Self::ALL[(id as usize).saturating_sub(1) % Self::ALL.len()]
    }

    /// The name in running text.
    pub const fn name(self) -> &'static str {
        ["blue", "vermilion", "green", "purple", "orange", "sky"][self as usize]
    }
}
