//! A plant with what surrounds it: parts of the force that are estimated, and the readings of sensors.

use super::dual::Dual;
use super::number::{Number, Real};
use super::plants::{AT_ONCE, Plant};
use crate::model::Reading;

/// The n-component state of a plant and its surroundings, and how it moves.
///
/// ```text
/// y = [motion, parameters, augmentations],  ẏ = g(y, F),  F = g f + o + u + w
/// ```
///
/// with the recorded force over mass f, its gain g, an offset o, an unknown force u and a white force w. All that does not move
/// is constant over a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// The plant.
    pub plant: Plant,
    /// n, the number of components.
    pub size: usize,
    /// The place of the input gain.
    pub gain: Option<usize>,
    /// The place of the input offset.
    pub offset: Option<usize>,
    /// The places of forces that come without the recorded input.
    pub unrecorded: Vec<usize>,
    /// `∂g/∂F` of the components that move.
    pub by_force: Vec<f64>,
}

impl Model {
    /// The number of components that move, which come first.
    #[inline(always)]
    pub fn motion(&self) -> usize {
        self.by_force.len()
    }

    /// `g f + o`, the part of the force over mass that comes with the recorded input \[m/s²\].
    #[inline(always)]
    pub fn recorded<T: Real>(&self, state: &[T], force: T) -> T {
        let scaled = match self.gain {
            Some(place) => state[place] * force,
            None => force,
        };
        match self.offset {
            Some(place) => scaled + state[place],
            None => scaled,
        }
    }

    /// F, the force over mass that acts \[m/s²\].
    #[inline(always)]
    pub fn acting<T: Real>(&self, state: &[T], force: T) -> T {
        let mut acting = self.recorded(state, force);
        for &place in &self.unrecorded {
            acting = acting + state[place];
        }
        acting
    }

    /// The rates of the components that move under this recorded force.
    #[inline(always)]
    pub fn rate<T: Real>(&self, state: &[T], force: T, rate: &mut [T]) {
        self.plant.rate(state, self.acting(state, force), rate);
    }
}

/// The rates of what moves, and their derivatives.
#[derive(Clone, Debug)]
pub struct Derivatives<T> {
    /// `g(y, F)` of the components that move.
    pub rate: Vec<T>,
    /// The upper rows of `A = ∂g/∂y`, column by column.
    pub columns: Vec<T>,
    duals: Vec<Dual<T, AT_ONCE>>,
}

impl<T: Number> Derivatives<T> {
    /// Memory for those of a model.
    pub fn new(model: &Model) -> Self {
        let (zero, motion, own) = (T::of(0.0), model.motion(), model.plant.size());
        Self {
            rate: vec![zero; motion],
            columns: vec![zero; motion * model.size],
            duals: vec![Dual::constant(zero); own + motion],
        }
    }

    /// Takes them in a state under this recorded force.
    #[inline(always)]
    pub fn take(&mut self, model: &Model, state: &[T], force: T) {
        let Self { rate, columns, duals } = self;
        let motion = model.motion();
        model.plant.linearise(state, model.acting(state, force), rate, columns, duals);
        // The columns of biases stay zero.
        if let Some(place) = model.gain {
            for i in 0..motion {
                columns[place * motion + i] = force * model.by_force[i];
            }
        }
        for &place in model.offset.iter().chain(&model.unrecorded) {
            for i in 0..motion {
                columns[place * motion + i] = T::of(model.by_force[i]);
            }
        }
    }
}

/// `h(y, f)` in a state that moves at this rate, in the unit of the sensor's quantity.
#[inline(always)]
pub fn read<T: Number>(model: &Model, reading: &Reading, state: &[T], rate: &[T], force: T) -> T {
    let mut sum = T::of(0.0);
    for &(place, factor) in reading.components() {
        sum = sum + state[place] * factor;
    }
    for &(place, factor) in reading.rates() {
        sum = sum + rate[place] * factor;
    }
    if reading.ground() != 0.0 {
        // The force over mass is the negative of the ground's acceleration.
        sum = sum - model.recorded(state, force) * reading.ground();
    }
    sum
}

/// `∂h/∂y` of a sensor that reads rates or the ground, n numbers.
#[inline(always)]
pub fn gradient<T: Number>(model: &Model, reading: &Reading, derivatives: &Derivatives<T>, force: T, row: &mut [T]) {
    let motion = model.motion();
    for (k, entry) in row.iter_mut().enumerate() {
        *entry = T::of(0.0);
        for &(place, factor) in reading.rates() {
            *entry = *entry + derivatives.columns[k * motion + place] * factor;
        }
    }
    for &(place, factor) in reading.components() {
        row[place] = row[place] + factor;
    }
    if reading.ground() != 0.0 {
        if let Some(place) = model.gain {
            row[place] = row[place] - force * reading.ground();
        }
        if let Some(place) = model.offset {
            row[place] = row[place] + -reading.ground();
        }
    }
}
