//! The settings of a filter.

use serde::{Deserialize, Serialize};

use super::values;
use super::{FilterColor, Values};
use crate::filter::{Adaptation, FilterKind, Propagation};
use crate::model::{InputKind, Model};
use crate::{Channel, PlantKind};

/// One filter: what it believes at first and how far it trusts the model and the sensors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct FilterSettings {
    /// The number by which the filter is known as others come and go, from 1 on; 0 or left out in a file for that of its
    /// place. An ensemble's random numbers and the usual colour follow from it.
    #[serde(skip_serializing_if = "is_zero")]
    pub id: u32,
    /// The name on screen and in files; its kind's if left empty.
    pub name: String,
    /// The kind of filter.
    pub kind: FilterKind,
    /// The colour in which the filter is drawn; by its id if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<FilterColor>,
    /// The kind of plant that the filter takes the truth for; the truth's own if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plant: Option<PlantKind>,
    /// The augmentations ([`crate::augment`]) that the filter estimates, or knows where their standard deviations are zero.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub augment: Vec<Channel>,
    /// Whether the filter estimates the logarithms of the parameters that cannot be negative.
    pub log_parameters: bool,
    /// How the mean of a KF, EKF or IEKF moves.
    pub propagation: Propagation,
    /// The most times that an IEKF linearises the sensors in one update.
    pub iterations: usize,
    /// The number of members of an EnKF, or of particles of a PF.
    pub ensemble_size: usize,
    /// Whether the filter learns R and Q from its innovations.
    pub adaptation: Adaptation,
    /// Whether the whole record is smoothed once the filter has seen it.
    pub smoother: bool,
    /// Fading factor λ ≥ 1 on the predicted covariance; 1 forgets nothing.
    pub fading: f64,
    /// Rate η ≥ 0 at which the model lets the parameters decay \[1/s\]; 0 keeps them constant.
    pub eta: f64,
    /// Standard deviations that the filter ascribes to the sensors, in their order: the square roots of the diagonal of
    /// R. The sensors' true ones if left empty in a file.
    pub sensor_std: Vec<f64>,
    /// Mean of the initial belief.
    #[serde(deserialize_with = "values::initial_mean")]
    pub initial_mean: Values,
    /// Standard deviations of the initial belief.
    #[serde(deserialize_with = "values::initial_std")]
    pub initial_std: Values,
    /// Standard deviations of the process noise per step: the square roots of the diagonal of Q.
    #[serde(deserialize_with = "values::process_std")]
    pub process_std: Values,
}

impl Default for FilterSettings {
    fn default() -> Self {
        Self {
            id: 0,
            name: String::new(),
            kind: FilterKind::EKF,
            color: None,
            plant: None,
            augment: Vec::new(),
            log_parameters: false,
            propagation: Propagation::LocalLinearisation,
            iterations: 5,
            ensemble_size: 500,
            adaptation: Adaptation::default(),
            smoother: false,
            fading: 1.0,
            eta: 0.0,
            sensor_std: Vec::new(),
            initial_mean: Values::INITIAL_MEAN,
            initial_std: Values::INITIAL_STD,
            process_std: Values::PROCESS_STD,
        }
    }
}

impl FilterSettings {
    /// The filter's model of a truth of some kind under an input.
    pub fn model(&self, truth: PlantKind, input: InputKind) -> Model {
        // The KF knows the parameters: they do not decay.
        let eta = if self.kind == FilterKind::KF { 0.0 } else { self.eta };
        let model = Model::new(self.plant.unwrap_or(truth)).augmented(self.augment.iter().copied());
        model.decaying(eta).with_logarithms(self.log_parameters).driven_by(input)
    }

    /// Whether the filter takes a channel for known and exact, whatever its standard deviations: the KF takes the
    /// parameters of its plant so.
    pub fn knows(&self, channel: Channel) -> bool {
        self.kind == FilterKind::KF && channel.is_parameter() && !channel.is_augmentation()
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn is_zero(id: &u32) -> bool {
    *id == 0
}
