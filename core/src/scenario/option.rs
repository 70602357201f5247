//! The options of a filter that exclude each other.

use std::sync::LazyLock;

use kalmanscope_filters::Channel;
use kalmanscope_filters::filter::FilterKind;

use super::{Between, FilterSettings, Values};

use crate::PlantKind;

/// An option that excludes others, or that others exclude.
pub struct FilterOption {
    /// The key of its setting in scenario files.
    pub key: &'static str,
    /// The end of a sentence about a filter that has it: "a filter that …".
    pub words: &'static str,
    /// Whether a filter has it.
    pub is_on: fn(&FilterSettings) -> bool,
    turn_off: fn(&mut FilterSettings),
}

static OFF: LazyLock<FilterSettings> = LazyLock::new(FilterSettings::default);

macro_rules! options {
    ($($name:ident: $($field:ident).+, $words:literal;)*) => {$(
        #[doc = concat!("The option of a filter that ", $words, ".")]
        pub static $name: FilterOption = FilterOption {
            key: stringify!($($field).+),
            words: $words,
            is_on: |filter| filter.$($field).+ != OFF.$($field).+,
            turn_off: |filter| filter.$($field).+.clone_from(&OFF.$($field).+),
        };
    )*};
}

options! {
    LEARNT_R: adaptation.sensor_noise, "learns R";
    LEARNT_Q: adaptation.process_noise, "learns Q";
    JUMPING: jump, "jumps";
    WEIGHED: robust, "weighs its readings";
    SMOOTHED: smoother, "has a smoother";
    WALKING: walk, "has a walk";
    GUESSED: guesses, "has several guesses";
    SCALED: process_scales, "has several scales of Q";
    CONSIDERED: consider, "considers channels";
    BOUNDED: bounds, "has bounds";
    PLUCKED: plucks, "begins its motion again";
    LOGARITHMIC: log_parameters, "estimates logarithms";
}

static SAMPLED: FilterOption = FilterOption {
    key: "kind",
    words: "samples its belief",
    is_on: |filter| !filter.kind.is_gaussian(),
    turn_off: |_| {},
};

static WITHOUT_PARAMETERS: FilterOption = FilterOption {
    key: "kind",
    words: "has no parameter to estimate",
    is_on: |filter| filter.kind == FilterKind::KF && filter.augment.is_empty(),
    turn_off: |_| {},
};

/// All pairs that do not work together: an option, those that it excludes, which are turned off for it, and the reason.
pub static EXCLUSIONS: [(&FilterOption, &[&FilterOption], &str); 11] = [
    (
        &SAMPLED,
        &[&SCALED, &WALKING, &WEIGHED, &SMOOTHED, &CONSIDERED, &BOUNDED, &PLUCKED],
        "it needs the mean and the covariance of a normal belief",
    ),
    (&WITHOUT_PARAMETERS, &[&JUMPING, &WALKING], "no parameter can change"),
    (&LEARNT_R, &[&WALKING, &WEIGHED, &CONSIDERED], "both would explain the same innovations"),
    (&LEARNT_Q, &[&SCALED, &WALKING, &CONSIDERED], "both would explain the same innovations"),
    (&JUMPING, &[&SCALED, &WALKING, &CONSIDERED], "both would answer the same sudden change"),
    (&WEIGHED, &[&SCALED, &WALKING], "models are compared by the likelihood of all readings"),
    (&SMOOTHED, &[&GUESSED, &SCALED, &WALKING, &CONSIDERED], "a smoother follows one filter that estimates all"),
    (&WALKING, &[&SCALED, &CONSIDERED, &PLUCKED], "two models mix before each step"),
    (&GUESSED, &[&SCALED, &CONSIDERED], "several filters run side by side already"),
    (&SCALED, &[&CONSIDERED], "several filters run side by side already"),
    (&LOGARITHMIC, &[&BOUNDED], "a logarithm is a bound already"),
];

impl PartialEq for FilterOption {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl FilterSettings {
    /// Whether no option of the filter excludes this one. It may exclude others itself.
    pub fn can(&self, option: &FilterOption) -> bool {
        self.can_have(option.key)
    }

    pub(super) fn can_have(&self, key: &str) -> bool {
        EXCLUSIONS.iter().all(|(first, others, _)| others.iter().all(|other| other.key != key) || !(first.is_on)(self))
    }

    /// Whether one filter alone estimates all of its state, without bounds, of a motion without plucks.
    pub(crate) fn is_single(&self) -> bool {
        [&GUESSED, &WALKING, &SCALED, &PLUCKED, &CONSIDERED, &BOUNDED].iter().all(|option| !(option.is_on)(self))
    }

    pub(crate) fn has_plain_update(&self) -> bool {
        let learns = [&LEARNT_R, &LEARNT_Q, &JUMPING, &WEIGHED].iter().any(|option| (option.is_on)(self));
        self.is_single() && !learns && self.correlation_time == Values::ZERO
    }

    pub(super) fn excluded(&self) -> Option<(&'static FilterOption, &'static FilterOption, &'static str)> {
        EXCLUSIONS.into_iter().find_map(|(first, others, reason)| {
            let other = others.iter().find(|other| (first.is_on)(self) && (other.is_on)(self))?;
            Some((*other, first, reason))
        })
    }

    /// Turns off excluded options and those that this truth lacks, but never the mean of the initial belief. Returns their keys.
    pub(crate) fn turn_off_excluded(&mut self, truth: &PlantKind) -> Vec<&'static str> {
        let mut keys = Vec::new();
        if self.guesses != OFF.guesses && !self.has_frequency(truth) {
            self.guesses = OFF.guesses;
            keys.push(GUESSED.key);
        }
        while let Some((other, ..)) = self.excluded() {
            (other.turn_off)(self);
            keys.push(other.key);
        }
        let before = (self.augment.len(), self.consider.len(), self.bounds.clone());
        let plant = self.plant.as_ref().unwrap_or(truth);
        self.augment.retain(|channel| plant.augmentations().any(|own| own == *channel));
        let has: Vec<Channel> = self.considerable(truth).collect();
        self.consider.retain(|channel| has.contains(channel));
        self.bounds.retain(|channel| has.contains(&channel));
        for (channel, Between { least, most }) in self.bounds.iter().collect::<Vec<_>>() {
            let mean = self.initial_mean[channel];
            let within = Between { least: least.map(|least| least.min(mean)), most: most.map(|most| most.max(mean)) };
            self.bounds.set(channel, within);
        }
        let are_other = [self.augment.len() != before.0, self.consider.len() != before.1, self.bounds != before.2];
        let lists = ["augment", CONSIDERED.key, BOUNDED.key].into_iter().zip(are_other);
        keys.extend(lists.filter(|(_, is_other)| *is_other).map(|(key, _)| key));
        keys
    }
}
