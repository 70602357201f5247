//! The plants' equations of motion again, on complex numbers: an infinitesimal imaginary part gives the Jacobian without a formula.

use kalmanscope_core::{Aspect, Channel, PlantKind, Quantity};
use nalgebra::{Complex, DMatrix, DVector};

use crate::run::plants;

pub(crate) type Number = Complex<f64>;

/// The values of functions of a state, and their Jacobian.
///
/// Source: Squire and Trapp (1998), Using complex variables to estimate derivatives of real functions.
pub(crate) fn with_jacobian(of: impl Fn(&[Number]) -> Vec<Number>, at: &[f64]) -> (DVector<f64>, DMatrix<f64>) {
    const STEP: f64 = 1e-100;
    let real: Vec<Number> = at.iter().map(|x| Number::new(*x, 0.0)).collect();
    let values = of(&real);
    let mut jacobian = DMatrix::zeros(values.len(), at.len());
    for j in 0..at.len() {
        let mut moved = real.clone();
        moved[j].im = STEP;
        let slopes = of(&moved).into_iter().map(|value| value.im / STEP);
        jacobian.column_mut(j).iter_mut().zip(slopes).for_each(|(to, slope)| *to = slope);
    }
    (DVector::from_iterator(values.len(), values.iter().map(|value| value.re)), jacobian)
}

pub(crate) fn value(of: impl Fn(&[Number]) -> Vec<Number>, at: &[f64]) -> DVector<f64> {
    let real: Vec<Number> = at.iter().map(|x| Number::new(*x, 0.0)).collect();
    DVector::from_vec(of(&real).iter().map(|value| value.re).collect())
}

fn exp(x: Number) -> Number {
    Number::new(x.im.cos(), x.im.sin()) * x.re.exp()
}

fn abs(x: Number) -> Number {
    if x.re < 0.0 { -x } else { x }
}

pub(crate) fn written() -> impl Iterator<Item = PlantKind> {
    const SINGLE: [PlantKind; 3] = [PlantKind::SDOF, PlantKind::DUFFING, PlantKind::BOUC_WEN];
    plants().filter(|kind| SINGLE.contains(kind) || kind.key().starts_with("shear_"))
}

#[derive(Clone, Debug)]
pub(crate) struct Plant {
    pub(crate) kind: PlantKind,
    pub(crate) eta: f64,
    /// Whether the state has the logarithms of positive parameters.
    pub(crate) log: bool,
}

impl Plant {
    pub(crate) fn channels(&self) -> &[Channel] {
        self.kind.channels()
    }

    pub(crate) fn is_log(&self, component: usize) -> bool {
        self.log && self.channels()[component].is_positive()
    }

    /// `ẏ = g(y, f)`
    pub(crate) fn rate(&self, state: &[Number], force: f64) -> Vec<Number> {
        let y: Vec<Number> = (0..state.len()).map(|i| if self.is_log(i) { exp(state[i]) } else { state[i] }).collect();
        let mut rate = match &self.kind {
            kind if *kind == PlantKind::SDOF => vec![y[1], linear(&y) + force],
            kind if *kind == PlantKind::DUFFING => vec![y[1], linear(&y) - y[4] * y[0] * y[0] * y[0] + force],
            kind if *kind == PlantKind::BOUC_WEN => bouc_wen(&y, force),
            _ => chain(&y, force),
        };
        for (i, &parameter) in y.iter().enumerate().skip(rate.len()) {
            let decay = -self.eta * parameter;
            rate.push(if self.is_log(i) { decay / parameter } else { decay });
        }
        rate
    }

    pub(crate) fn reading(&self, state: &[Number], force: f64, quantity: Quantity) -> Option<Number> {
        let place = |channel: Channel| self.channels().iter().position(|&c| c == channel);
        if quantity.aspect() == Aspect::ACCELERATION {
            return Some(self.rate(state, force)[place(Channel::velocity(quantity.mass()))?]);
        }
        Some(state[place(quantity.channel()?)?])
    }
}

/// `-2ζωₙv - ωₙ²x`
fn linear(y: &[Number]) -> Number {
    let [x, v, wn, zeta, ..] = y else { unreachable!("four components") };
    -2.0 * zeta * wn * v - wn * wn * x
}

fn bouc_wen(y: &[Number], force: f64) -> Vec<Number> {
    let &[x, v, z, wn, zeta, alpha, beta, gamma] = y else { unreachable!("eight components") };
    let spring = wn * wn * (alpha * x + (1.0 - alpha) * z);
    let memory = v - beta * abs(v) * abs(z) * z - gamma * v * z * z;
    vec![v, -2.0 * zeta * wn * v - spring + force, memory]
}

/// `ẍ = f 1 - K x - C v` with the tridiagonal matrices of a shear building.
fn chain(y: &[Number], force: f64) -> Vec<Number> {
    let masses = (y.len() - 1) / 3;
    let (x, v, stiffness, damping) = (&y[..masses], &y[masses..2 * masses], &y[2 * masses..3 * masses], y[3 * masses]);
    let pull = |i: usize| match i {
        0 => stiffness[0] * x[0] + damping * v[0],
        _ => stiffness[i] * (x[i] - x[i - 1]) + damping * (v[i] - v[i - 1]),
    };
    let acceleration = |i: usize| if i + 1 < masses { pull(i + 1) - pull(i) + force } else { -pull(i) + force };
    v.iter().copied().chain((0..masses).map(acceleration)).collect()
}

pub(crate) fn runge_kutta(plant: &Plant, state: &[Number], force: f64, dt: f64) -> Vec<Number> {
    let along = |rate: &[Number], by: f64| -> Vec<Number> { state.iter().zip(rate).map(|(y, r)| y + by * r).collect() };
    let k1 = plant.rate(state, force);
    let k2 = plant.rate(&along(&k1, dt / 2.0), force);
    let k3 = plant.rate(&along(&k2, dt / 2.0), force);
    let k4 = plant.rate(&along(&k3, dt), force);
    along(&(0..state.len()).map(|i| (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) / 6.0).collect::<Vec<_>>(), dt)
}
