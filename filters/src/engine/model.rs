//! A plant with its surroundings: estimated parts of the force, and the readings of sensors.

use super::dynamics::{Dynamics, EquationWork, RateFunction, Slopes, fits};
use super::level::{Baseline, Level, apart};
use super::number::{Function, Number, Real};
use crate::Hold;
use crate::linalg::Matrix;

/// The n-component state of a plant and its surroundings, and how it moves.
///
/// ```text
/// y = [motion, parameters, augmentations],  ẏ = g(y, F),  F = g f + o + u + w,  ṗ = -η p
/// ```
///
/// with the recorded force over mass f, its gain g, an offset o, an unknown force u and a white force w. In place of a parameter
/// θ the state may have `ln θ`. All that does not move is constant over a step.
#[derive(Clone, Debug, PartialEq)]
pub struct StateModel<P> {
    /// The plant.
    pub plant: P,
    /// n, the number of components.
    pub size: usize,
    /// η, the rate at which the parameters decay \[1/s\].
    pub eta: f64,
    /// The places of logarithms.
    pub logarithms: Vec<usize>,
    /// The place of the input gain.
    pub gain: Option<usize>,
    /// The place of the input offset.
    pub offset: Option<usize>,
    /// The places of the forces that are not recorded.
    pub unrecorded: Vec<usize>,
    /// The places of what does not last, and their correlation times \[s\].
    pub forgotten: Vec<(usize, f64)>,
    /// `∂g/∂F` of the components that move.
    pub by_force: Vec<f64>,
}

impl<P: Dynamics> StateModel<P> {
    /// The model of a plant that nothing surrounds.
    pub fn new(plant: P) -> Self {
        let ([size, _], by_force) = (plant.sizes(), plant.by_force());
        let (logarithms, unrecorded, forgotten) = (Vec::new(), Vec::new(), Vec::new());
        Self { plant, size, eta: 0.0, logarithms, gain: None, offset: None, unrecorded, forgotten, by_force }
    }

    /// The number of components that a step moves, which come first: those of the motion, and with a decay the parameters.
    #[inline(always)]
    pub fn moving(&self) -> usize {
        self.by_force.len()
    }

    /// Whether the linear step has a closed form.
    #[inline(always)]
    pub fn is_oscillator(&self) -> bool {
        self.plant.is_oscillator() && self.moving() == 2
    }

    pub(super) fn coupling(&self) -> Option<[usize; 2]> {
        self.plant.coupling().filter(|[masses, _]| self.moving() == 2 * masses)
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

    /// The rates of the components that move under this input. `plain` is memory for n numbers.
    #[inline(always)]
    pub fn rate<T: Number, L: Level>(
        &self,
        level: L,
        state: &[T],
        input: Input<'_, T>,
        plain: &mut [T],
        rate: &mut [T],
    ) {
        self.plant.with_equation(RateWork { model: self, level, state, input, plain, rate });
    }

    #[cfg_attr(target_arch = "wasm32", inline(never))]
    #[cfg_attr(not(target_arch = "wasm32"), inline(always))]
    pub(super) fn rate_by<T: Number>(
        &self,
        equation: impl RateFunction<T>,
        state: &[T],
        input: Input<'_, T>,
        plain: &mut [T],
        rate: &mut [T],
    ) {
        let acting = self.acting(state, input.force);
        let own = self.plain(state, plain);
        equation.rate(own, acting, rate);
        input.push(rate);
        self.decay(own, rate);
    }

    /// A state with parameters in place of their logarithms. `plain` is memory for n numbers where there are some.
    #[inline(always)]
    pub fn plain<'a, T: Number>(&self, state: &'a [T], plain: &'a mut [T]) -> &'a [T] {
        if self.logarithms.is_empty() {
            return state;
        }
        self.plain_into(state, plain);
        plain
    }

    #[inline(always)]
    pub(super) fn plain_into<T: Number>(&self, state: &[T], plain: &mut [T]) {
        plain.copy_from_slice(state);
        for &place in &self.logarithms {
            plain[place] = plain[place].call(Function::Exp);
        }
    }

    /// The rates at which parameters decay.
    #[inline(always)]
    pub fn decay<T: Real>(&self, plain: &[T], rate: &mut [T]) {
        if self.eta == 0.0 {
            return;
        }
        for place in self.plant.sizes()[1]..self.moving() {
            rate[place] = plain[place] * -self.eta;
        }
        for &place in &self.logarithms {
            rate[place] = T::of(-self.eta);
        }
    }

    /// `A = ∂g/∂y`, n × n, under this recorded force over mass \[m/s²\].
    pub fn jacobian(&self, state: &[f64], force: f64) -> Matrix {
        let mut derivatives = Derivatives::new(self);
        derivatives.take(Baseline, self, state, &force.into());
        let rows = Matrix::from_column_slice(self.moving(), self.size, &derivatives.columns);
        rows.resize_vertically(self.size, 0.0)
    }

    /// `H = ∂h/∂y` of some sensors in a state, m × n.
    pub fn gradients(&self, readings: &[&Reading], state: &[f64], input: Input<'_>) -> Matrix {
        let mut derivatives = Derivatives::new(self);
        derivatives.take(Baseline, self, state, &input);
        let mut transposed = Matrix::zeros(self.size, readings.len());
        for (reading, row) in readings.iter().zip(transposed.as_mut_slice().chunks_exact_mut(self.size)) {
            gradient(self, reading, state, &derivatives, input.force, row);
        }
        transposed.transpose()
    }
}

struct RateWork<'a, T, L, P> {
    model: &'a StateModel<P>,
    level: L,
    state: &'a [T],
    input: Input<'a, T>,
    plain: &'a mut [T],
    rate: &'a mut [T],
}

impl<T: Number, L: Level, P: Dynamics> EquationWork<T> for RateWork<'_, T, L, P> {
    #[inline(always)]
    fn with(self, equation: impl RateFunction<T>) {
        let Self { model, level, state, input, plain, rate } = self;
        if fits(level, equation) {
            model.rate_by(equation, state, input, plain, rate);
        }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Derivatives<T> {
    /// `g(y, F)` of the components that move.
    pub rate: Vec<T>,
    /// The upper rows of `A = ∂g/∂y`, column by column.
    pub columns: Vec<T>,
    pub plain: Vec<T>,
}

impl<T: Number> Derivatives<T> {
    pub(crate) fn new(model: &StateModel<impl Dynamics>) -> Self {
        let (zero, moving) = (T::of(0.0), model.moving());
        Self { rate: vec![zero; moving], columns: vec![zero; moving * model.size], plain: vec![zero; model.size] }
    }

    /// A function apart: it is long, and called from many places.
    #[inline(always)]
    pub(crate) fn take<L: Level>(
        &mut self,
        level: L,
        model: &StateModel<impl Dynamics>,
        state: &[T],
        input: &Input<'_, T>,
    ) {
        apart!(level, {
            let force = input.force;
            let Self { rate, columns, plain } = self;
            let (n, moving) = (level.size(model.size), level.moving(model.moving()));
            let (state, rate, columns) = (&state[..n], &mut rate[..moving], &mut columns[..moving * n]);
            let own = model.plain(state, plain);
            let out = Slopes { rate: &mut *rate, columns: &mut *columns, rows: moving };
            model.plant.linearise(level, own, model.acting(state, force), out);
            input.push(rate);
            model.decay(own, rate);
            if model.eta != 0.0 {
                for place in model.plant.sizes()[1]..moving {
                    columns[place * moving + place] = T::of(-model.eta);
                }
            }
            for &place in &model.logarithms {
                let column = &mut columns[place * moving..(place + 1) * moving];
                column.iter_mut().for_each(|entry| *entry = *entry * own[place]);
                if model.eta != 0.0 {
                    // -η θ / θ does not depend on θ.
                    column[place] = T::of(0.0);
                }
            }
            // The columns of biases stay zero.
            if let Some(place) = model.gain {
                for i in 0..moving {
                    columns[place * moving + i] = force * model.by_force[i];
                }
            }
            for &place in model.offset.iter().chain(&model.unrecorded) {
                for i in 0..moving {
                    columns[place * moving + i] = T::of(model.by_force[i]);
                }
            }
        });
    }
}

/// The reading of a sensor, in places of a model's state.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Components by their places, and their factors.
    pub components: Vec<(usize, f64)>,
    /// Components by their places whose rates it reads, and their factors.
    pub rates: Vec<(usize, f64)>,
    /// The factor of the ground's acceleration.
    pub ground: f64,
    /// The component, if the reading is one component with the factor 1 and nothing else.
    pub component: Option<usize>,
    /// The gain of the sensor, which multiplies components, rates and ground.
    pub gain: Option<Scale>,
}

/// The places of a sensor's gain and bias.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    pub gain: usize,
    /// The bias, which is not multiplied. Without a gain it is one of the components.
    pub bias: Option<usize>,
}

impl Reading {
    /// A sensor that reads one component.
    pub fn component(place: usize) -> Self {
        Self { components: vec![(place, 1.0)], rates: Vec::new(), ground: 0.0, component: Some(place), gain: None }
    }

    /// Whether it reads a rate.
    pub fn is_of_rates(&self) -> bool {
        !self.rates.is_empty()
    }

    /// Whether it is linear in the state for every plant.
    #[inline]
    pub fn is_of_components(&self) -> bool {
        self.rates.is_empty() && self.ground == 0.0 && self.gain.is_none()
    }
}

/// `h(y, f)` at this rate of the state, in the unit of the sensor's quantity.
#[inline(always)]
pub fn read<T: Real>(model: &StateModel<impl Dynamics>, reading: &Reading, state: &[T], rate: &[T], force: T) -> T {
    if let Some(place) = reading.component {
        return state[place];
    }
    let exact = read_exact(model, reading, state, rate, force);
    match reading.gain {
        None => exact,
        Some(Scale { gain, bias: None }) => state[gain] * exact,
        Some(Scale { gain, bias: Some(bias) }) => state[gain] * exact + state[bias],
    }
}

#[inline(always)]
fn read_exact<T: Real>(model: &StateModel<impl Dynamics>, reading: &Reading, state: &[T], rate: &[T], force: T) -> T {
    let mut sum = T::of(0.0);
    for &(place, factor) in &reading.components {
        sum = sum + state[place] * factor;
    }
    for &(place, factor) in &reading.rates {
        sum = sum + rate[place] * factor;
    }
    if reading.ground != 0.0 {
        // The force over mass is the negative of the ground's acceleration.
        sum = sum - model.recorded(state, force) * reading.ground;
    }
    sum
}

/// `∂h/∂y`, n numbers, of a sensor that reads more than components.
#[inline(always)]
pub(crate) fn gradient<T: Number>(
    model: &StateModel<impl Dynamics>,
    reading: &Reading,
    state: &[T],
    derivatives: &Derivatives<T>,
    force: T,
    row: &mut [T],
) {
    let moving = model.moving();
    for (k, entry) in row.iter_mut().enumerate() {
        *entry = T::of(0.0);
        for &(place, factor) in &reading.rates {
            *entry = *entry + derivatives.columns[k * moving + place] * factor;
        }
    }
    for &(place, factor) in &reading.components {
        row[place] = row[place] + factor;
    }
    if reading.ground != 0.0 {
        if let Some(place) = model.gain {
            row[place] = row[place] - force * reading.ground;
        }
        if let Some(place) = model.offset {
            row[place] = row[place] + -reading.ground;
        }
    }
    if let Some(Scale { gain, bias }) = reading.gain {
        row.iter_mut().for_each(|entry| *entry = *entry * state[gain]);
        row[gain] = row[gain] + read_exact(model, reading, state, &derivatives.rate, force);
        if let Some(bias) = bias {
            row[bias] = row[bias] + 1.0;
        }
    }
}

/// A recorded force over mass on one mass \[m/s²\], besides the force on all of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceOn {
    /// The place of the mass's velocity.
    pub place: usize,
    /// Its values at a sample and at the next one.
    pub ends: [f64; 2],
}

impl ForceOn {
    /// The value at a share of the step.
    #[inline(always)]
    pub fn value(&self, at: f64) -> f64 {
        let [begin, end] = self.ends;
        begin + (end - begin) * at
    }
}

/// The recorded input at a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input<'a, T = f64> {
    /// The force over mass on all masses \[m/s²\].
    pub force: T,
    /// The forces on single masses. This is no slice, whose length would be copied with each step.
    pub on: &'a Vec<ForceOn>,
    /// The share of the step between samples at which the forces on single masses act: 0 for its beginning, 1 for its end.
    pub at: f64,
}

impl<T> From<T> for Input<'_, T> {
    /// A force on all masses alone.
    fn from(force: T) -> Self {
        static NONE: Vec<ForceOn> = Vec::new();
        Self { force, on: &NONE, at: 0.0 }
    }
}

impl<'a, T: Real> Input<'a, T> {
    /// Adds the forces on single masses to the rates.
    #[inline(always)]
    pub fn push(&self, rate: &mut [T]) {
        for on in self.on {
            rate[on.place] = rate[on.place] + on.value(self.at);
        }
    }

    /// The same with another force on all masses.
    #[inline(always)]
    pub fn with<U>(self, force: U) -> Input<'a, U> {
        Input { force, on: self.on, at: self.at }
    }

    #[inline(always)]
    fn between([begin, end]: [Self; 2], share: f64) -> Self {
        let force = begin.force + (end.force - begin.force) * share;
        Self { force, on: begin.on, at: begin.at + (end.at - begin.at) * share }
    }
}

/// A step from one sample to the next, or a part of one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<'a, T = f64> {
    /// The recorded input at its beginning and at its end, linear in between; the same where it is held.
    pub inputs: [Input<'a, T>; 2],
    /// The course of the force between samples.
    pub hold: Hold,
    /// The time that it takes \[s\].
    pub dt: f64,
}

impl<'a, T: Number> Step<'a, T> {
    #[inline(always)]
    pub(crate) fn has_slope(&self) -> bool {
        self.hold == Hold::First
    }

    /// \[m/s³\]
    #[inline(always)]
    pub(crate) fn slope(&self) -> T {
        (self.inputs[1].force - self.inputs[0].force) * (1.0 / self.dt)
    }

    /// The places of the forces on single masses, and their slopes \[m/s³\].
    #[inline(always)]
    pub(crate) fn slopes_on(&self) -> impl Iterator<Item = (usize, T)> + use<'a, T> {
        let [begin, end] = self.inputs;
        let share = (end.at - begin.at) / self.dt;
        begin.on.iter().map(move |on| (on.place, T::of((on.ends[1] - on.ends[0]) * share)))
    }

    #[inline(always)]
    pub(crate) fn thrice(&self) -> [Input<'a, T>; 3] {
        let [begin, end] = self.inputs;
        [begin, Input::between(self.inputs, 0.5), end]
    }

    /// One of some equal parts, counted from 0.
    pub fn part(&self, i: usize, parts: usize) -> Self {
        let input = |i: usize| match i {
            0 => self.inputs[0],
            i if i == parts => self.inputs[1],
            i => Input::between(self.inputs, i as f64 / parts as f64),
        };
        Self { inputs: [input(i), input(i + 1)], dt: self.dt / parts as f64, ..*self }
    }

    #[inline(always)]
    pub(crate) fn with<U>(&self, force: impl Fn(T) -> U) -> Step<'a, U> {
        Step { inputs: self.inputs.map(|input| input.with(force(input.force))), hold: self.hold, dt: self.dt }
    }
}
