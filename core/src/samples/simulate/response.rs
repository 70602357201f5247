//! A plant in motion.

use super::TruthError;
use super::refinement::{Motion, Refinement};
use crate::mathematics::engine::exponential::Exponential;
use crate::mathematics::engine::impulse::Impulse;
use crate::mathematics::engine::level::Baseline;
use crate::mathematics::linalg::{Matrix, Vector};
use crate::mathematics::model::Model;

/// Limits the times that steps are halved in a piece of work: about a millisecond.
pub(crate) const HALVED: u64 = 400;

pub(crate) struct Response {
    state: Vector,
    /// The largest absolute value of each component so far.
    size: Vector,
    /// The constant components of the last step and their exact integrals, which seldom change.
    exact: Option<(Vec<f64>, Exact)>,
    /// Memory for the rates of the motion, and for its change over a step.
    work: [Vector; 2],
    /// The step of a plant that is not linear, and whether it is under way.
    step: Refinement,
    is_under_way: bool,
    pub(crate) halved: u64,
}

/// The effects on the motion of a constant rate and of a slope of the rate over one step; both are square.
struct Exact {
    constant: Matrix,
    slope: Matrix,
}

impl Response {
    /// At rest, except for the components in `initial`.
    pub(crate) fn new(initial: impl Iterator<Item = f64>) -> Self {
        let state = Vector::from_iterator(initial.size_hint().0, initial);
        let empty = || Vector::zeros(0);
        Self {
            size: Vector::zeros(state.len()),
            state,
            exact: None,
            work: [empty(), empty()],
            step: Refinement::default(),
            is_under_way: false,
            halved: 0,
        }
    }

    pub(crate) fn state(&self) -> &[f64] {
        self.state.as_slice()
    }

    pub(crate) fn set(&mut self, place: usize, value: f64) {
        self.state[place] = value;
    }

    /// Moves on by a step of `dt` \[s\]. The recorded force over mass goes linearly from the first to the second of
    /// `forces`, an unrecorded one is held \[m/s²\]. Halves steps at most `most` times, and returns whether the step is done;
    /// otherwise the next call, with the same arguments, goes on with it, and the state stays as it is until then.
    pub(crate) fn advance(
        &mut self,
        model: &Model,
        forces: [f64; 2],
        disturbance: f64,
        dt: f64,
        most: u64,
    ) -> Result<bool, TruthError> {
        let Self { state, size, exact, work: [rate, change], step, is_under_way, halved } = self;
        let [begin, end] = forces;
        if !model.is_linear() {
            let motion = Motion { model, forces, disturbance, dt };
            if !*is_under_way {
                size.zip_apply(state, |size, x| *size = size.max(x.abs()));
                step.begin(&motion, state.as_slice());
            }
            let before = step.halved;
            let is_done = step.advance(&motion, size.as_slice(), most);
            *halved += step.halved - before;
            *is_under_way = is_done == Ok(false);
            if is_done == Ok(true) {
                state.copy_from_slice(&step.state);
            }
            return is_done;
        }
        let motion = model.motion();
        let constant = &state.as_slice()[motion..];
        let integrals = match exact {
            Some((before, integrals)) if before == constant => integrals,
            _ => &exact.insert((constant.to_vec(), Exact::new(model, state, dt))).1,
        };
        for work in [&mut *rate, &mut *change] {
            if work.len() != motion {
                *work = Vector::zeros(motion);
            }
        }
        let acting = model.acting_force(state.as_slice(), begin) + disturbance;
        model.motion_rate_under_into(state.as_slice(), acting, rate.as_mut_slice());
        integrals.constant.mul_to(rate, change);
        if begin != end {
            let by_force = model.by_recorded_force(state.as_slice());
            *change += &integrals.slope * by_force.rows(0, motion) * ((end - begin) / dt);
        }
        for i in 0..motion {
            state[i] += change[i];
        }
        Ok(true)
    }
}

impl Exact {
    fn new(model: &Model, state: &Vector, dt: f64) -> Self {
        let motion = model.motion();
        let a = model.jacobian(state.as_slice(), 0.0).view((0, 0), (motion, motion)).into_owned();
        if motion == 2 && a[(0, 0)] == 0.0 && a[(0, 1)] == 1.0 {
            let (a, b) = (a[(1, 0)], a[(1, 1)]);
            let Impulse { h, q, p } = Impulse::new(Baseline, a, b, dt, true);
            let constant = Matrix::from_column_slice(2, 2, &[h - b * q, a * q, q, h]);
            return Self { constant, slope: Matrix::from_column_slice(2, 2, &[q - b * p, a * p, p, q]) };
        }
        let mut exponential = Exponential::new(motion);
        exponential.compute(Baseline, a.as_slice(), motion, dt, true);
        let Exponential { constant, slope, .. } = exponential;
        Self { constant: Matrix::from_vec(motion, motion, constant), slope: Matrix::from_vec(motion, motion, slope) }
    }
}
