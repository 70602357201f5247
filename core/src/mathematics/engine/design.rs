//! What the runs of a batch share.

use super::course::Course;
use super::model::Model;
use super::propagation::Propagation;
use crate::mathematics::filter::adaptation::Adaptation;
use crate::mathematics::filter::robust::Robust;
use crate::mathematics::model::Reading;

/// The places and weights of sigma points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rule {
    /// c², the square of their distance in standard deviations; each but the centre weighs `W = 1/(2 c²)`.
    pub spread: f64,
    /// o, the part of `s sᵀ` in a covariance.
    pub offset: f64,
}

/// The way in which a filter predicts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// KF, EKF and IEKF: linearised. An update linearises the sensors this many times, each time at the last result.
    Linearised(Propagation, usize),
    /// UKF and CKF.
    SigmaPoints(Rule),
    /// SR-UKF, by a rule whose o is one.
    SquareRoot(Rule),
}

/// The part of a setup that is the same for all runs of a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// The model of the state.
    pub model: Model,
    /// The way of prediction.
    pub method: Method,
    /// Time between samples \[s\].
    pub dt: f64,
    /// Whether the recorded force is linear between samples.
    pub has_slope: bool,
    /// The number of steps from a sample to the next.
    pub substeps: usize,
    /// The reading of each sensor.
    pub readings: Vec<Reading>,
    /// The place of a white force and its course between samples.
    pub white: Option<(usize, Course)>,
    /// The rule by which measurements are weighed.
    pub robust: Robust,
    /// The noise that is learnt.
    pub adaptation: Adaptation,
    /// Whether P widens where the innovations grow at once.
    pub jumps: bool,
    /// The places of components that count but are not estimated.
    pub considered: Vec<usize>,
}
