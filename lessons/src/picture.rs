//! Pictures of lessons in the menu.

use kalmanscope_core::{Channel, Quantity, Scenario};
use serde::Deserialize;

use crate::LessonError;

/// The picture of a lesson in the menu: a small plot of a step's run that shows the point of the lesson.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonPicture {
    /// The step whose run is drawn, counted from 1.
    #[serde(default = "first")]
    pub step: usize,
    /// The course that is drawn.
    pub show: PictureCourse,
    /// The channel of an estimate or an error; the first parameter if left out.
    pub channel: Option<Channel>,
    /// The sensor of all that has one; the first if left out.
    pub sensor: Option<Quantity>,
    /// The names of the filters that are drawn; all if left out.
    #[serde(default)]
    pub filters: Vec<String>,
    /// The beginning of the time axis \[s\]; that of the record if left out.
    pub from: Option<f64>,
    /// The end of the time axis \[s\]; that of the record if left out.
    pub to: Option<f64>,
    /// The lowest and the highest value; those that occur if left out.
    pub range: Option<[f64; 2]>,
}

const fn first() -> usize {
    1
}

/// A course that a picture can show. All but `measured` and `map` have their ±2σ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PictureCourse {
    /// The estimates of a channel, and the truth.
    Estimate,
    /// The errors of a channel.
    Error,
    /// The innovations of a sensor.
    Innovation,
    /// The readings of a sensor.
    Measured,
    /// The standard deviation that is learnt for a sensor, over the true one.
    LearntNoise,
    /// The factor on √Q that is learnt.
    ProcessScale,
    /// The probability of each filter as a model class.
    Probability,
    /// The step's map, without time.
    Map,
}

impl LessonPicture {
    /// Checks that the step's scenario has the filters and the sensor.
    pub(crate) fn validate(&self, scenario: &Scenario, has_map: bool) -> Result<(), LessonError> {
        if let Some(name) = self.filters.iter().find(|name| !scenario.filters.iter().any(|own| own.name == **name)) {
            return Err(LessonError::UnknownFilter(name.clone()));
        }
        if let Some(sensor) = self.sensor.filter(|one| !scenario.sensors.iter().any(|own| own.measures == *one)) {
            return Err(LessonError::UnknownSensor(sensor));
        }
        if self.show == PictureCourse::Map && !has_map { Err(LessonError::Picture("map")) } else { Ok(()) }
    }
}
