//! A plant in motion. Runge-Kutta steps of a nonlinear plant are halved where needed, such as around kinks of the rate.

use kalmanscope_filters::Dynamics as _;
use kalmanscope_filters::engine::exponential::{Exponential, Impulse};
use kalmanscope_filters::engine::level::Baseline;
use kalmanscope_filters::engine::model::{ForceOn, Input};
use kalmanscope_filters::engine::runge_kutta::classical;
use kalmanscope_filters::linalg::{Matrix, Vector};

use super::TruthError;

use crate::Model;

/// Limits the times that steps are halved in a piece of work: about a millisecond.
pub(crate) const HALVED: u64 = 400;

pub(crate) struct Response {
    pub(crate) state: Vector,
    size: Vector,
    /// The constant components of the last step and their exact integrals, which seldom change.
    exact: Option<(Vec<f64>, Exact)>,
    work: [Vector; 2],
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

    /// Moves on by `dt` \[s\] under an input that is linear between its ends and a held force \[m/s²\]. Returns whether the step is done.
    pub(crate) fn advance(
        &mut self,
        model: &Model,
        inputs: [Input<'_>; 2],
        disturbance: f64,
        dt: f64,
        most: u64,
    ) -> Result<bool, TruthError> {
        let Self { state, size, exact, work: [rate, change], step, is_under_way, halved } = self;
        let [begin, end] = inputs.map(|input| input.force);
        if !model.is_linear() {
            let motion = LinearMotion { model, inputs, disturbance, dt };
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
        model.state.plant.motion_rate(state.as_slice(), acting, rate.as_mut_slice());
        inputs[0].push(rate.as_mut_slice());
        integrals.constant.mul_to(rate, change);
        if begin != end {
            let by_force = model.by_force(state.as_slice()) * model.state.gain.map_or(1.0, |place| state[place]);
            *change += &integrals.slope * by_force.rows(0, motion) * ((end - begin) / dt);
        }
        let [from, to] = inputs.map(|input| input.at);
        for ForceOn { place, ends: [begin, end] } in inputs[0].on.iter().filter(|_| from != to) {
            *change += integrals.slope.column(*place) * ((end - begin) * (to - from) / dt);
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

/// Limits the difference of a Runge-Kutta step to two half steps, relative to the largest value so far; extrapolation leaves a hundredth.
const ACCURACY: f64 = 3e-12;

/// After a failed integration, the plant counts as diverged if its state is this many times as large as ever before.
const RUNAWAY: f64 = 100.0;

const MOST: u64 = 4096;

struct LinearMotion<'a> {
    model: &'a Model,
    inputs: [Input<'a>; 2],
    disturbance: f64,
    dt: f64,
}

impl LinearMotion<'_> {
    fn step(&self, memory: &mut [Vec<f64>; 5], to: &mut Vec<f64>, state: &[f64], (from, share): (f64, f64)) {
        let [begin, end] = self.inputs.map(|input| input.force);
        to.clear();
        to.extend_from_slice(state);
        memory.iter_mut().for_each(|numbers| numbers.resize(state.len(), 0.0));
        let rate = |y: &[f64], s: f64, rate: &mut [f64]| {
            let at = from + share * s;
            let force = if begin == end { begin } else { begin + (end - begin) * at };
            let acting = self.model.acting_force(y, force) + self.disturbance;
            self.model.rate_under_into(y, acting, rate);
            let [first, last] = self.inputs.map(|input| input.at);
            Input { at: first + (last - first) * at, ..self.inputs[0] }.push(rate);
        };
        classical(rate, to, [0.0, 0.5, 1.0], share * self.dt, memory.each_mut().map(Vec::as_mut_slice));
    }
}

/// A step under way: the sample is divided into parts that are halved until the difference of one step to two is small enough.
/// Source: Hairer, Nørsett and Wanner (1993), *Solving Ordinary Differential Equations I*, section II.4.
#[derive(Default)]
struct Refinement {
    state: Vec<f64>,
    /// Where the part begins and its length, as shares of the sample.
    part: (f64, f64),
    coarse: Vec<f64>,
    middle: Vec<f64>,
    fine: Vec<f64>,
    rest: Vec<(f64, f64)>,
    halved: u64,
    memory: [Vec<f64>; 5],
}

impl Refinement {
    fn begin(&mut self, motion: &LinearMotion<'_>, from: &[f64]) {
        let Self { state, part, coarse, rest, halved, memory, .. } = self;
        state.clear();
        state.extend_from_slice(from);
        (*part, *halved) = ((0.0, 1.0), 0);
        rest.clear();
        motion.step(memory, coarse, state, *part);
    }

    /// Halves steps at most `most` times; returns whether all parts are done. `size` are the largest absolute values.
    fn advance(&mut self, motion: &LinearMotion<'_>, size: &[f64], most: u64) -> Result<bool, TruthError> {
        let Self { state, part, coarse, middle, fine, rest, halved, memory } = self;
        let begin = *halved;
        loop {
            let (from, share) = *part;
            let half = 0.5 * share;
            motion.step(memory, middle, state, (from, half));
            motion.step(memory, fine, middle, (from + half, half));
            // Relative to the largest value so far: the one at a zero crossing would ask for steps without end.
            let close = |i: usize| (fine[i] - coarse[i]).abs() <= ACCURACY * size[i].max(fine[i].abs());
            let is_close = (0..fine.len()).all(close);
            if is_close || fine.iter().any(|x| !x.is_finite()) {
                // A plant that diverges ends with the next sample, which reports it.
                for ((state, fine), coarse) in state.iter_mut().zip(&*fine).zip(&*coarse) {
                    // Half a step of fourth order errs by a sixteenth: a fifteenth of the difference is left.
                    *state = if is_close { fine + (fine - coarse) / 15.0 } else { *fine };
                }
                let Some(next) = rest.pop() else { return Ok(true) };
                motion.step(memory, coarse, state, next);
                *part = next;
                continue;
            }
            if *halved >= MOST {
                // A diverging plant does so within ever shorter times: no number of halvings is enough.
                let far = (0..size.len()).find(|&i| size[i] > 0.0 && state[i].abs() > RUNAWAY * size[i]);
                return Err(far.map_or(TruthError::StepTooLong, |i| TruthError::Channel(motion.model.channels()[i])));
            }
            *halved += 1;
            rest.push((from + half, half));
            *part = (from, half);
            // The middle is the coarse step of the first half: nothing is computed twice.
            std::mem::swap(coarse, middle);
            if *halved - begin >= most {
                return Ok(false);
            }
        }
    }
}
