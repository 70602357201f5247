//! A plant in motion.

use super::TruthError;
use crate::integrate::{exponential_integrals, runge_kutta};
use crate::linalg::{Matrix, Vector};
use crate::model::Model;

/// How far a Runge-Kutta step may be from two of half its length, relative to the largest that each component has been.
/// What is left after extrapolation is a hundredth of that, and below 1e-9 of the signal after a minute.
const ACCURACY: f64 = 3e-12;

/// A plant has run away that has come this many times as far as ever before when it can no longer be followed.
const RUNAWAY: f64 = 100.0;

/// The most steps that one sample is halved into.
const MAX_STEPS: u32 = 4096;

/// The state of a plant and its surroundings, as it moves.
pub(super) struct Response {
    state: Vector,
    /// The largest that each component has been.
    size: Vector,
    /// The constant components of the last step and the exact integrals that go with them: they seldom change.
    exact: Option<(Vec<f64>, Exact)>,
}

/// The effects after a step of a constant rate and of a slope of the rate, on what moves; both are square.
struct Exact {
    constant: Matrix,
    slope: Matrix,
}

impl Response {
    /// At rest but for what `initial` says of each component.
    pub(super) fn new(initial: impl Iterator<Item = f64>) -> Self {
        let state = Vector::from_iterator(initial.size_hint().0, initial);
        Self { size: Vector::zeros(state.len()), state, exact: None }
    }

    /// The state.
    pub(super) fn state(&self) -> &[f64] {
        self.state.as_slice()
    }

    /// Gives a component that does not move its present value.
    pub(super) fn set(&mut self, place: usize, value: f64) {
        self.state[place] = value;
    }

    /// Moves on by a step of `dt` \[s\], in which the recorded force over mass goes linearly from the first to the second
    /// of `forces`, and an unrecorded one is held \[m/s²\].
    pub(super) fn advance(
        &mut self,
        model: &Model,
        forces: [f64; 2],
        disturbance: f64,
        dt: f64,
    ) -> Result<(), TruthError> {
        let Self { state, size, exact } = self;
        let [begin, end] = forces;
        if !model.is_linear() {
            *size = size.sup(&state.abs());
            let motion = Motion { model, forces, disturbance };
            *state = motion.advance(state, dt, size)?;
            return Ok(());
        }
        let constant = &state.as_slice()[model.motion()..];
        let integrals = match exact {
            Some((before, integrals)) if before == constant => integrals,
            _ => &exact.insert((constant.to_vec(), Exact::new(model, state, dt))).1,
        };
        let rate = model.rate_under(state.as_slice(), model.acting_force(state.as_slice(), begin) + disturbance);
        let motion = model.motion();
        let mut change = &integrals.constant * rate.rows(0, motion);
        if begin != end {
            let by_force = model.by_recorded_force(state.as_slice());
            change += &integrals.slope * by_force.rows(0, motion) * ((end - begin) / dt);
        }
        for i in 0..motion {
            state[i] += change[i];
        }
        Ok(())
    }
}

impl Exact {
    fn new(model: &Model, state: &Vector, dt: f64) -> Self {
        let motion = model.motion();
        let a = model.jacobian(state.as_slice(), 0.0).view((0, 0), (motion, motion)).into_owned();
        let integrals = exponential_integrals(&a, dt);
        Self { constant: integrals.constant, slope: integrals.slope }
    }
}

/// A plant under a load over one sample.
struct Motion<'a> {
    model: &'a Model,
    forces: [f64; 2],
    disturbance: f64,
}

impl Motion<'_> {
    /// The state after `dt` \[s\], by Runge-Kutta steps as short as it takes, which is shorter around kinks of the rate.
    fn advance(&self, state: &Vector, dt: f64, size: &Vector) -> Result<Vector, TruthError> {
        let mut halvings = MAX_STEPS;
        let coarse = self.step(state, 0.0, 1.0, dt);
        self.refined(state, coarse, (0.0, 1.0), dt, size, &mut halvings).map_err(|reached| {
            // A plant that runs away does so within ever shorter times: no number of halvings follows it to the end.
            let far = (0..size.len()).find(|&i| size[i] > 0.0 && reached[i].abs() > RUNAWAY * size[i]);
            far.map_or(TruthError::StepTooLong, |i| TruthError::Channel(self.model.channels()[i]))
        })
    }

    /// One Runge-Kutta step over a share of the sample.
    fn step(&self, state: &Vector, from: f64, share: f64, dt: f64) -> Vector {
        let [begin, end] = self.forces;
        runge_kutta(state, share * dt, |s, y| {
            let force = if begin == end { begin } else { begin + (end - begin) * (from + share * s) };
            let acting = self.model.acting_force(y.as_slice(), force) + self.disturbance;
            self.model.rate_under(y.as_slice(), acting)
        })
    }

    /// The step that `coarse` takes in one, halved again and again until it makes no difference, and then extrapolated.
    ///
    /// # Errors
    /// The state at which no halvings were left.
    ///
    /// Source: Hairer, Nørsett and Wanner (1993), *Solving Ordinary Differential Equations I*, section II.4.
    fn refined(
        &self,
        state: &Vector,
        coarse: Vector,
        (from, share): (f64, f64),
        dt: f64,
        size: &Vector,
        halvings: &mut u32,
    ) -> Result<Vector, Vector> {
        let half = 0.5 * share;
        let middle = self.step(state, from, half, dt);
        let fine = self.step(&middle, from + half, half, dt);
        let difference = &fine - coarse;
        let close = |i: usize| difference[i].abs() <= ACCURACY * size[i].max(fine[i].abs());
        if (0..fine.len()).all(close) {
            return Ok(fine + difference / 15.0);
        }
        if fine.iter().any(|x| !x.is_finite()) {
            // The plant runs away, which the next sample says.
            return Ok(fine);
        }
        let Some(rest) = halvings.checked_sub(1) else { return Err(state.clone()) };
        *halvings = rest;
        let middle = self.refined(state, middle, (from, half), dt, size, halvings)?;
        let rest = self.step(&middle, from + half, half, dt);
        self.refined(&middle, rest, (from + half, half), dt, size, halvings)
    }
}
