//! The plants' equations of motion again, on dual numbers, which need no formula for the Jacobian.

use std::ops::{Add, Mul, Neg, Sub};

use kalmanscope_core::{Aspect, Channel, PlantKind, Quantity};

use super::matrix::Matrix;

#[derive(Clone, Debug)]
pub(crate) struct Dual {
    pub(crate) value: f64,
    pub(crate) slope: Vec<f64>,
}

impl Dual {
    pub(crate) fn state(values: &[f64]) -> Vec<Self> {
        let slope = |i: usize| (0..values.len()).map(|j| f64::from(u8::from(i == j))).collect();
        values.iter().enumerate().map(|(i, &value)| Self { value, slope: slope(i) }).collect()
    }

    fn chained(&self, value: f64, derivative: f64) -> Self {
        Self { value, slope: self.slope.iter().map(|s| s * derivative).collect() }
    }

    pub(crate) fn exp(&self) -> Self {
        self.chained(self.value.exp(), self.value.exp())
    }

    fn abs(&self) -> Self {
        if self.value < 0.0 { -self.clone() } else { self.clone() }
    }

    fn inverse(&self) -> Self {
        self.chained(1.0 / self.value, -1.0 / (self.value * self.value))
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        self.chained(-self.value, -1.0)
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let slope = self.slope.iter().zip(&other.slope).map(|(a, b)| a + b).collect();
        Self { value: self.value + other.value, slope }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let value = self.value * other.value;
        Self { value, ..self.chained(0.0, other.value) + other.chained(0.0, self.value) }
    }
}

impl Mul<Dual> for f64 {
    type Output = Dual;
    fn mul(self, other: Dual) -> Dual {
        other.chained(self * other.value, self)
    }
}

impl Add<f64> for Dual {
    type Output = Self;
    fn add(self, other: f64) -> Self {
        Self { value: self.value + other, slope: self.slope }
    }
}

pub(crate) fn written() -> impl Iterator<Item = PlantKind> {
    const SINGLE: [PlantKind; 3] = [PlantKind::SDOF, PlantKind::DUFFING, PlantKind::BOUC_WEN];
    PlantKind::ALL.into_iter().filter(|kind| SINGLE.contains(kind) || kind.key().starts_with("shear_"))
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
    pub(crate) fn rate(&self, state: &[Dual], force: f64) -> Vec<Dual> {
        let plain = |i: usize| if self.is_log(i) { state[i].exp() } else { state[i].clone() };
        let y: Vec<Dual> = (0..state.len()).map(plain).collect();
        let moving = match &self.kind {
            kind if *kind == PlantKind::SDOF => {
                let [x, v, wn, zeta] = &y[..] else { unreachable!("four components") };
                vec![v.clone(), linear(x, v, wn, zeta) + force]
            }
            kind if *kind == PlantKind::DUFFING => {
                let [x, v, wn, zeta, mu] = &y[..] else { unreachable!("five components") };
                let cubic = mu.clone() * x.clone() * x.clone() * x.clone();
                vec![v.clone(), linear(x, v, wn, zeta) - cubic + force]
            }
            kind if *kind == PlantKind::BOUC_WEN => bouc_wen(&y, force),
            _ => chain(&y, force),
        };
        let decay = |i: usize| {
            let rate = -self.eta * y[i].clone();
            if self.is_log(i) { rate * y[i].inverse() } else { rate }
        };
        let parameters = (moving.len()..y.len()).map(decay);
        moving.iter().cloned().chain(parameters).collect()
    }

    pub(crate) fn reading(&self, state: &[Dual], force: f64, quantity: Quantity) -> Option<Dual> {
        let place = |channel: Channel| self.channels().iter().position(|&c| c == channel);
        if quantity.aspect() == Aspect::ACCELERATION {
            return Some(self.rate(state, force)[place(Channel::velocity(quantity.mass()))?].clone());
        }
        Some(state[place(quantity.channel()?)?].clone())
    }
}

/// `-2ζωₙv - ωₙ²x`
fn linear(x: &Dual, v: &Dual, wn: &Dual, zeta: &Dual) -> Dual {
    -2.0 * (zeta.clone() * wn.clone() * v.clone()) - wn.clone() * wn.clone() * x.clone()
}

fn bouc_wen(y: &[Dual], force: f64) -> Vec<Dual> {
    let [x, v, z, wn, zeta, alpha, beta, gamma] = y else { unreachable!("eight components") };
    let elastic = alpha.clone() * x.clone();
    let hysteretic = (-alpha.clone() + 1.0) * z.clone();
    let spring = wn.clone() * wn.clone() * (elastic + hysteretic);
    let damper = 2.0 * (zeta.clone() * wn.clone() * v.clone());
    let memory =
        v.clone() - beta.clone() * v.abs() * z.abs() * z.clone() - gamma.clone() * v.clone() * z.clone() * z.clone();
    vec![v.clone(), -damper - spring + force, memory]
}

/// `ẍ = f 1 - K x - C v` with the tridiagonal matrices of a shear building.
fn chain(y: &[Dual], force: f64) -> Vec<Dual> {
    let masses = (y.len() - 1) / 3;
    let (x, v, stiffness, damping) = (&y[..masses], &y[masses..2 * masses], &y[2 * masses..3 * masses], &y[3 * masses]);
    let zero = || 0.0 * damping.clone();
    let above = |i: usize| if i + 1 < masses { (stiffness[i + 1].clone(), damping.clone()) } else { (zero(), zero()) };
    let acceleration = |i: usize| {
        let (k, c) = above(i);
        let mut pull = (stiffness[i].clone() + k.clone()) * x[i].clone() + (damping.clone() + c.clone()) * v[i].clone();
        if i > 0 {
            pull = pull - stiffness[i].clone() * x[i - 1].clone() - damping.clone() * v[i - 1].clone();
        }
        if i + 1 < masses {
            pull = pull - k * x[i + 1].clone() - c * v[i + 1].clone();
        }
        -pull + force
    };
    v.iter().cloned().chain((0..masses).map(acceleration)).collect()
}

pub(crate) fn values(duals: &[Dual]) -> Vec<f64> {
    duals.iter().map(|d| d.value).collect()
}

pub(crate) fn jacobian(duals: &[Dual]) -> Matrix {
    Matrix(duals.iter().map(|d| d.slope.clone()).collect())
}

pub(crate) fn runge_kutta(plant: &Plant, state: &[Dual], force: f64, dt: f64) -> Vec<Dual> {
    let along = |rate: &[Dual], by: f64| -> Vec<Dual> {
        state.iter().zip(rate).map(|(y, r)| y.clone() + by * r.clone()).collect()
    };
    let k1 = plant.rate(state, force);
    let k2 = plant.rate(&along(&k1, dt / 2.0), force);
    let k3 = plant.rate(&along(&k2, dt / 2.0), force);
    let k4 = plant.rate(&along(&k3, dt), force);
    let mean = |i: usize| {
        let middle = 2.0 * (k2[i].clone() + k3[i].clone());
        (1.0 / 6.0) * (k1[i].clone() + middle + k4[i].clone())
    };
    along(&(0..state.len()).map(mean).collect::<Vec<_>>(), dt)
}
