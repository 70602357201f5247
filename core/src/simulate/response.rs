//! A plant in motion.

use super::TruthError;
use crate::integrate::{exponential_integrals, runge_kutta};
use crate::linalg::{Matrix, Vector};
use crate::model::Model;

/// Limits the difference between a Runge-Kutta step and two steps of half its length, relative to the largest value of
/// each component so far. After extrapolation the error is a hundredth of that, and below 1e-9 of the signal after a
/// minute.
const ACCURACY: f64 = 3e-12;

/// A plant whose integration fails has diverged if it is this many times as far as ever before.
const RUNAWAY: f64 = 100.0;

/// Limits the steps into which one sample is halved.
const MAX_STEPS: u32 = 4096;

/// The state of a plant, as it moves.
pub(crate) struct Response {
    state: Vector,
    /// The largest absolute value of each component so far.
    size: Vector,
    /// The constant components of the last step and their exact integrals, which seldom change.
    exact: Option<(Vec<f64>, Exact)>,
    /// Memory for the rates of the motion, and for its change over a step.
    work: [Vector; 2],
    /// The number of times that steps have been halved.
    halved: u64,
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
        Self { size: Vector::zeros(state.len()), state, exact: None, work: [empty(), empty()], halved: 0 }
    }

    /// The state.
    pub(crate) fn state(&self) -> &[f64] {
        self.state.as_slice()
    }

    /// The number of times that steps have been halved so far: up to [`MAX_STEPS`] for one sample, which then takes about ten
    /// milliseconds.
    pub(crate) fn halved(&self) -> u64 {
        self.halved
    }

    /// Sets the present value of a component that does not move.
    pub(crate) fn set(&mut self, place: usize, value: f64) {
        self.state[place] = value;
    }

    /// Moves on by a step of `dt` \[s\]. The recorded force over mass goes linearly from the first to the second of
    /// `forces`, an unrecorded one is held \[m/s²\].
    pub(crate) fn advance(
        &mut self,
        model: &Model,
        forces: [f64; 2],
        disturbance: f64,
        dt: f64,
    ) -> Result<(), TruthError> {
        let Self { state, size, exact, work: [rate, change], halved } = self;
        let [begin, end] = forces;
        if !model.is_linear() {
            *size = size.sup(&state.abs());
            let motion = Motion { model, forces, disturbance };
            let mut left = MAX_STEPS;
            let moved = motion.advance(state, dt, size, &mut left);
            *halved += u64::from(MAX_STEPS - left);
            *state = moved?;
            return Ok(());
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
    /// The state after `dt` \[s\], by Runge-Kutta steps that are refined where needed, such as around kinks of the
    /// rate. `halvings` is the number of times that a step may be halved.
    fn advance(&self, state: &Vector, dt: f64, size: &Vector, halvings: &mut u32) -> Result<Vector, TruthError> {
        let coarse = self.step(state, 0.0, 1.0, dt);
        self.refined(state, coarse, (0.0, 1.0), dt, size, halvings).map_err(|reached| {
            // A diverging plant does so within ever shorter times, which no number of halvings resolves.
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

    /// The result of one step `coarse`, halved until the difference is small enough, then extrapolated.
    ///
    /// # Errors
    /// The state at which the limit of halvings was reached.
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
            // The plant diverges; the next sample reports it.
            return Ok(fine);
        }
        let Some(rest) = halvings.checked_sub(1) else { return Err(state.clone()) };
        *halvings = rest;
        let middle = self.refined(state, middle, (from, half), dt, size, halvings)?;
        let rest = self.step(&middle, from + half, half, dt);
        self.refined(&middle, rest, (from + half, half), dt, size, halvings)
    }
}
