//! From equations to rates: each is solved for its highest derivative, in which it is linear: `left - right = r + s h = 0`, `h = -r / s`.

use super::EquationError;
use super::parse::{Sides, Tree, parse};
use super::typed::Typed;
use kalmanscope_filters::channel::MAX_MASSES;
use kalmanscope_filters::engine::builder::Builder;
use kalmanscope_filters::engine::list::Node;
use kalmanscope_filters::lists::sort_items;

// Components, the force and an unknown for each equation are bits of 64.
const COMPONENTS: usize = 32;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum StateComponent {
    /// x of a mass, counted from 0.
    Displacement(usize),
    Velocity(usize),
    Internal(String),
    Parameter(String),
}

impl StateComponent {
    pub(super) fn key(&self) -> Option<&String> {
        match self {
            Self::Internal(key) | Self::Parameter(key) => Some(key),
            Self::Displacement(_) | Self::Velocity(_) => None,
        }
    }
}

pub(super) struct Solved {
    pub(super) components: Vec<StateComponent>,
    pub(super) typed: Typed,
    pub(super) is_linear: bool,
}

struct Name<'a> {
    key: &'a str,
    primes: usize,
    place: usize,
}

pub(super) fn solve(text: &str) -> Result<Solved, EquationError> {
    let equations = parse(text).map_err(|error| error.within(text))?;
    solved(&equations).map_err(|error| error.within(text))
}

fn solved(equations: &[Sides]) -> Result<Solved, EquationError> {
    let names = names(equations);
    let components = components(&names, equations)?;
    let motion = components.iter().take_while(|one| !matches!(one, StateComponent::Parameter(_))).count();
    let (n, masses) =
        (components.len(), components.iter().filter(|one| matches!(one, StateComponent::Displacement(_))).count());
    let mut builder = Builder::default();
    let inputs = RateInputs { components: &components, masses, force: n };
    let velocities = (0..masses).map(|mass| builder.input(masses + mass));
    let mut rates: Vec<Option<Node>> = velocities.map(Some).collect();
    rates.resize(motion, None);
    for equation in equations {
        let (place, rate) = inputs.solve(equation, &mut builder)?;
        if rates[place].replace(rate).is_some() {
            return Err(EquationError::at(equation.place, "another equation already gives the same derivative"));
        }
        let by_force = builder.derivative(rate, n);
        if builder.value(by_force).is_none() && !builder.is_too_long() {
            return Err(EquationError::at(
                equation.place,
                "f is the force over mass, and its factor is a number: write `m f` beside `m x''`, or divide by m (the gain of \
                 the input stands for 1/m)",
            ));
        }
    }
    // Each derivative has one equation.
    let rates: Vec<Node> = rates.into_iter().flatten().collect();
    let mut entries = Vec::new();
    for (i, &rate) in rates.iter().enumerate() {
        for j in 0..n {
            let entry = builder.derivative(rate, j);
            if builder.value(entry) != Some(0.0) {
                entries.push((j * motion + i, entry));
            }
        }
    }
    let moving = (1_u64 << motion) - 1;
    let mut is_linear =
        entries.iter().all(|(place, entry)| place / motion >= motion || builder.needs(*entry) & moving == 0);
    for &rate in &rates {
        let at_rest = builder.without(rate, moving | 1 << n);
        is_linear &= builder.value(at_rest) == Some(0.0);
    }
    let too_long =
        || EquationError::new("the equation is too long: its rates or their derivatives take too many operations");
    if builder.is_too_long() {
        return Err(too_long());
    }
    let outputs: Vec<(usize, Node)> = rates.iter().copied().enumerate().collect();
    let rates = builder.list(n + 1, &outputs).ok_or_else(too_long)?;
    let jacobian = builder.list(n + 1, &entries).ok_or_else(too_long)?;
    let typed = Typed { size: n, motion, masses, rates, jacobian };
    Ok(Solved { components, typed, is_linear })
}

fn names(equations: &[Sides]) -> Vec<Name<'_>> {
    let mut names: Vec<Name<'_>> = Vec::new();
    let mut take = |key, primes, place| match names.iter_mut().find(|name| name.key == key) {
        Some(name) if primes > name.primes => (name.primes, name.place) = (primes, place),
        Some(_) => {}
        None => names.push(Name { key, primes, place }),
    };
    for equation in equations {
        equation.left.names(&mut take);
        equation.right.names(&mut take);
    }
    names
}

fn mass(key: &str) -> Option<usize> {
    match key.strip_prefix('x')? {
        "" => Some(0),
        number => number.parse::<usize>().ok().filter(|_| !number.starts_with('0'))?.checked_sub(1),
    }
}

fn components(names: &[Name<'_>], equations: &[Sides]) -> Result<Vec<StateComponent>, EquationError> {
    let (mut masses, mut internal, mut parameters) = (Vec::new(), Vec::new(), Vec::new());
    for name in names {
        let Name { key, primes, place } = *name;
        let fault = |what: String| Err(EquationError::at(place, what));
        match primes {
            _ if key == "f" && primes > 0 => {
                return fault("f is the force over mass: it has no rate".to_owned());
            }
            0 if key == "f" => {}
            0 if mass(key).is_some() => {
                return fault(format!("`{key}` is a displacement, and no equation has its acceleration `{key}''`"));
            }
            0 => parameters.push(StateComponent::Parameter(key.to_owned())),
            1 if mass(key).is_some() => {
                return fault(format!("`{key}'` is a velocity, and no equation has the acceleration `{key}''`"));
            }
            1 => internal.push(StateComponent::Internal(key.to_owned())),
            2 => match mass(key) {
                Some(mass) if mass < MAX_MASSES => masses.push((mass, key, place)),
                _ => return fault(format!("masses are x, or x1 to x{MAX_MASSES}: `{key}''` is not one")),
            },
            _ => return fault(format!("`{key}` has at most two primes")),
        }
    }
    sort_items(&mut masses, Ord::cmp);
    for (expected, &(mass, key, place)) in masses.iter().enumerate() {
        if mass != expected {
            let what = if mass < expected {
                "stands for the first mass twice: write x1"
            } else {
                "lacks the masses before it"
            };
            return Err(EquationError::at(place, format!("`{key}` {what}")));
        }
    }
    if masses.is_empty() {
        return Err(EquationError::at(0, "no equation has an acceleration: `x''`"));
    }
    let unknown = masses.len() + internal.len();
    if equations.len() != unknown {
        let (have, need) = (equations.len(), unknown);
        return Err(EquationError::at(0, format!("there are {have} equations for {need} components that move")));
    }
    // ωₙ and ζ come first, as in built-in plants.
    let place = |one: &StateComponent| {
        one.key().map_or(2, |key| if key == "omega_n" { 0 } else { 1 + usize::from(key != "zeta") })
    };
    sort_items(&mut parameters, |a, b| place(a).cmp(&place(b)));
    let count = masses.len();
    let displacements = (0..count).map(StateComponent::Displacement).chain((0..count).map(StateComponent::Velocity));
    let all: Vec<StateComponent> = displacements.chain(internal).chain(parameters).collect();
    if all.len() > COMPONENTS {
        return Err(EquationError::at(0, format!("a plant has at most {COMPONENTS} components, not {}", all.len())));
    }
    Ok(all)
}

struct RateInputs<'a> {
    components: &'a [StateComponent],
    masses: usize,
    force: usize,
}

impl RateInputs<'_> {
    fn solve(&self, equation: &Sides, builder: &mut Builder) -> Result<(usize, Node), EquationError> {
        let (left, right) = (self.node(&equation.left, builder), self.node(&equation.right, builder));
        let residual = builder.subtract(left, right);
        let highest = self.force + 1;
        let has = builder.needs(residual) >> highest;
        let fault = |what: &str| Err(EquationError::at(equation.place, what));
        if has == 0 {
            return fault("this equation has no highest derivative, as `x''` or `z'`");
        }
        if has.count_ones() > 1 {
            return fault(
                "this equation has the highest derivatives of two components: each equation has one, so that it can be solved",
            );
        }
        let input = highest + has.trailing_zeros() as usize;
        let slope = builder.derivative(residual, input);
        if builder.needs(slope) & 1 << input != 0 {
            return fault("the highest derivative is in a product or a function of itself");
        }
        let rest = builder.without(residual, 1 << input);
        let negative = builder.negative(rest);
        Ok((input - highest + self.masses, builder.divide(negative, slope)))
    }

    fn node(&self, tree: &Tree, builder: &mut Builder) -> Node {
        match tree {
            Tree::Number(number) => builder.constant(*number),
            Tree::Name(key, primes, _) => builder.input(self.input(key, *primes)),
            Tree::Negative(a) => {
                let a = self.node(a, builder);
                builder.negative(a)
            }
            Tree::Call(function, a) => {
                let a = self.node(a, builder);
                builder.call(*function, a)
            }
            Tree::Power(a, exponent) => {
                let a = self.node(a, builder);
                builder.power(a, *exponent)
            }
            Tree::Binary(sign, a, b) => {
                let (a, b) = (self.node(a, builder), self.node(b, builder));
                match sign {
                    '+' => builder.add(a, b),
                    '-' => builder.subtract(a, b),
                    '/' => builder.divide(a, b),
                    _ => builder.multiply(a, b),
                }
            }
        }
    }

    fn input(&self, key: &str, primes: usize) -> usize {
        let place = |one: &StateComponent| self.components.iter().position(|other| other == one).unwrap_or(self.force);
        match (mass(key), primes) {
            (Some(mass), 0) => place(&StateComponent::Displacement(mass)),
            (Some(mass), 1) => place(&StateComponent::Velocity(mass)),
            (Some(mass), _) => self.force + 1 + mass,
            // An internal state at place p of the moving components is the unknown p - masses, after the masses.
            (None, 1) => self.force + 1 + place(&StateComponent::Internal(key.to_owned())) - self.masses,
            _ if key == "f" => self.force,
            _ if self.components.contains(&StateComponent::Internal(key.to_owned())) => {
                place(&StateComponent::Internal(key.to_owned()))
            }
            _ => place(&StateComponent::Parameter(key.to_owned())),
        }
    }
}
