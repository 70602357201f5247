//! Why a run cannot begin.

use kalmanscope_filters::{ForcedMass, InputKind, Quantity};
use kalmanscope_records::Record;
use thiserror::Error;

use crate::{Scenario, ScenarioError};

/// The reason why a run cannot begin.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum RunError {
    /// The scenario is impossible.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The record lacks a sensor of the scenario.
    #[error("the record does not measure {}, but the scenario has a sensor for it", .0.key())]
    MissingSensor(Quantity),
    /// The record has a force on a mass that the plant lacks.
    #[error("the record has a {}, but the plant has no such mass", .0.name())]
    MissingMass(ForcedMass),
    /// Readings that come one by one have one input, but a force acts on a single mass.
    #[error("readings that come one by one have one input: there can be no {} besides it", .0.name())]
    OneInput(ForcedMass),
    /// The record's input is of another kind than the scenario's.
    #[error("the record's input is {}, but the scenario's is {}", input_name(*.0), input_name(*.1))]
    InputKind(InputKind, InputKind),
    /// There is no filter at this place.
    #[error("the scenario has no filter number {}", .0 + 1)]
    NoFilter(usize),
    /// A smoother begins with the first sample, but this many of the record's first samples have been forgotten.
    #[error("the record's first {0} samples have been forgotten, and a smoother begins with the first")]
    Forgotten(usize),
}

fn input_name(kind: InputKind) -> &'static str {
    match kind {
        InputKind::Force => "a force",
        InputKind::GroundAcceleration => "the acceleration of the ground",
    }
}

pub(crate) fn sensor_places(scenario: &Scenario, record: &Record) -> Result<Vec<usize>, RunError> {
    if record.input_kind() != scenario.input {
        return Err(RunError::InputKind(record.input_kind(), scenario.input));
    }
    if let Some(mass) = record.forced().iter().find(|mass| mass.mass() >= scenario.plant.kind.masses()) {
        return Err(RunError::MissingMass(*mass));
    }
    let place = |q: Quantity| q.place_in(record.sensors()).ok_or(RunError::MissingSensor(q));
    scenario.sensors.iter().map(|s| place(s.measures)).collect()
}

pub(crate) fn one_input(scenario: &Scenario) -> Result<(), RunError> {
    scenario.forced().first().map_or(Ok(()), |mass| Err(RunError::OneInput(*mass)))
}
