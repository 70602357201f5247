//! The settings of a filter that are one number each, or a yes or no.

use super::Allowed;
use super::info::{Field, SettingInfo, row};
use crate::data::scenario::{FilterSettings, option};
use crate::mathematics::filter::FilterKind;

type Row = SettingInfo<FilterSettings>;

/// Limits the samples by which the plant can feel the input after or before it is recorded.
pub(super) const MAX_DELAY: i64 = 100;

/// λ: how fast the filter forgets.
pub static FADING: Row = row! { fading, "fading factor",
    symbol: "λ",
    label: |_| Some("λ fading factor"),
    allowed: Allowed::AtLeast(1.0),
    note: "1 forgets nothing",
    slider: (1.0, 1.05),
    hint: "Multiplies the predicted covariance at every step: 1 forgets nothing, more forgets faster",
    is_varied: true,
};

/// Whether the filter widens P once where its innovations grow at once. A KF that knows its parameters has none to widen.
pub static JUMP: Row = row! { jump, "jump at a sudden change",
    allowed: Allowed::Flag,
    hint: "Where the innovations grow at once, widen P once by its initial covariance and learn anew; before and after, \
           forget nothing. A remark says when",
    serves: |filter, _| filter.can(&option::JUMPING),
};

/// w: how far the parameters walk in the second model of a bank.
pub static WALK: Row = row! { walk, "walk of a bank's second model",
    symbol: "w",
    label: |_| Some("w bank's walk"),
    unit: "1/√s",
    allowed: Allowed::AtLeast(0.0),
    note: "0 for no bank",
    slider: (0.0, 2.0),
    hint: "Two filters that mix by the likelihood of their readings: parameters are still in one, and walk in the other, by so many \
           initial σ in a second; 0 for one filter (IMM: Blom and Bar-Shalom 1988)",
    serves: |filter, _| filter.can(&option::WALKING),
    is_varied: true,
};

/// η: how fast the parameters decay in the filter's model. Those of a KF are known and do not.
pub static ETA: Row = row! { eta, "parameter decay",
    symbol: "η",
    label: |_| Some("η decay"),
    unit: "1/s",
    allowed: Allowed::AtLeast(0.0),
    slider: (0.0, 0.1),
    hint: "Rate at which the filter's model lets the parameters decay; 0 keeps them constant",
    serves: |filter, _| filter.kind != FilterKind::KF,
    is_varied: true,
};

/// The guesses of ωₙ that filters begin from side by side, where ωₙ is estimated and no smoother needs a single filter.
pub static GUESSES: Row = row! { guesses, "guesses of ωₙ",
    allowed: Allowed::Whole(1, 8),
    slider: (1.0, 8.0),
    hint: "Filters side by side from so many guesses of ωₙ, from 0.14 to 7.4 times the initial mean; the likeliest so far \
           is shown",
    serves: |filter, truth| filter.has_frequency(truth) && filter.can(&option::GUESSED),
};

/// The scales of Q with which filters run side by side.
pub static PROCESS_SCALES: Row = row! { process_scales, "scales of Q",
    allowed: Allowed::Whole(1, 41),
    note: "1 for Q as it is set",
    slider: (1.0, 25.0),
    hint: "Filters side by side with so many scales of Q, √Q from 1/30 to 30 times: the likelihood of their readings tells how large Q is, \
           with ±2σ, and what is shown is their mixture; 17 do well (Magill 1965)",
    serves: |filter, _| filter.can(&option::SCALED),
};

static SUBSTEPS: Row = row! { substeps, "steps a sample",
    allowed: Allowed::Whole(0, 100),
    note: "0 for as many as its error asks for",
    slider: (0.0, 20.0),
    hint: "Divide each prediction into this number of steps; 0 takes one on a linear plant, and on others as many as the error of a \
           Runge-Kutta step asks for",
};

static ITERATIONS: Row = row! { iterations, "iterations",
    allowed: Allowed::Whole(1, 100),
    slider: (1.0, 20.0),
    hint: "Limit of the linearisations of the sensors in one update",
    serves: |filter, _| filter.kind == FilterKind::IEKF,
};

/// The members of an ensemble, or particles. The slider ends where a frame can compute no more of them.
pub static ENSEMBLE_SIZE: Row = row! { ensemble_size, "members",
    label: |filter| filter.kind.info().has_own_likelihood.then_some("particles"),
    allowed: Allowed::Whole(2, 100_000),
    slider: (2.0, 2000.0),
    hint: "More are more exact, and slower",
    serves: |filter, _| filter.kind.is_sampled(),
};

static LOG_PARAMETERS: Row = row! { log_parameters, "logarithms of positive parameters",
    allowed: Allowed::Flag,
    hint: "Estimate the logarithms of frequency, damping and stiffness, which then stay positive",
};

/// Whether the whole record is smoothed.
pub static SMOOTHER: Row = row! { smoother, "hindsight",
    allowed: Allowed::Flag,
    hint: "In the whole record also show, dashed, what is known of each instant in the light of all that came after it: \
           Rauch, Tung and Striebel (1965)",
    serves: |filter, _| filter.can(&option::SMOOTHED),
};

static LOOK_AHEAD: Row = row! { look_ahead, "look-ahead of hindsight",
    label: |_| Some("look-ahead"),
    unit: "s",
    allowed: Allowed::AtLeast(0.0),
    note: "0 waits for the whole record",
    slider: (0.0, 5.0),
    hint: "Hindsight of so many seconds goes along with the filter, and stays that much behind it, 10,000 samples at \
           most; 0 waits for the whole record",
    serves: |filter, _| filter.smoother,
};

static LEARNS_R: Row = row! { adaptation.sensor_noise, "learn R from the innovations",
    allowed: Allowed::Flag,
    hint: "Akhlaghi, Zhou and Huang (2017)",
};

static LEARNS_Q: Row = row! { adaptation.process_noise, "learn Q from the innovations",
    allowed: Allowed::Flag,
    hint: "Akhlaghi, Zhou and Huang (2017)",
};

/// The share of the last estimate that stays where a filter learns R or Q.
pub static FORGETTING: Row = row! { adaptation.forgetting, "share that stays in learning",
    allowed: Allowed::Between(0.0, 1.0),
};

static TRAINING: Row = row! { adaptation.training, "training of the learnt noise",
    label: |_| Some("training"),
    unit: "s",
    allowed: Allowed::AtLeast(0.0),
    note: "0 learns all the time",
    slider: (0.0, 60.0),
    hint: "Learns R and Q for so many seconds, then works with what it has learnt; 0 learns all the time",
    serves: |filter, _| filter.adaptation.is_on() || filter.process_scales > 1,
};

static INPUT_DELAY: Row = row! { input_delay, "delay of the input",
    unit: "samples",
    allowed: Allowed::Whole(-MAX_DELAY, MAX_DELAY),
};

/// The settings that are shown first: how long the filter remembers.
pub static MEMORY: [&Row; 2] = [&FADING, &ETA];

/// The ways in which parameters may change that stay as they are otherwise, one of which a filter has: in words, and the value that
/// turns it on.
pub static CHANGES: [(&Row, &str, f64); 3] =
    [(&WALK, "walk", 0.1), (&JUMP, "jump", 1.0), (&PROCESS_SCALES, "Q of unknown size", 17.0)];

static OF_CHANGES: [&Row; 3] = [&JUMP, &WALK, &PROCESS_SCALES];

/// The less common settings.
pub static OPTIONS: [&Row; 10] = [
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

static OF_FILES: [&Row; 2] = [&INPUT_DELAY, &FORGETTING];

/// All settings of a filter that are one number each, or a yes or no.
pub static OF_FILTER: [&[&Row]; 4] = [&MEMORY, &OF_CHANGES, &OPTIONS, &OF_FILES];
