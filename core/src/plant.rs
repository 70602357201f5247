//! Plants: their equations of motion and parameters.

mod built_in;
pub(crate) mod dynamics;
pub(crate) mod model;

use std::any::Any;
use std::fmt;
use std::sync::{Arc, LazyLock};

use kalmanscope_filters::Dynamics as _;
use kalmanscope_filters::lists::numbers;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::channel::{MAX_MASSES, augment};
use crate::equation::{Equation, EquationError, EquationSettings};
use crate::{Channel, Quantity, Term};
use built_in::BuiltInPlant;
use dynamics::{EnginePlant, Own};

/// A plant's data other than its equation.
#[derive(Clone, Copy, Debug)]
pub struct PlantInfo<'a> {
    /// The key in scenario files.
    pub key: &'a str,
    /// The name in running text.
    pub name: &'a str,
    /// The equation of motion, per mass.
    pub equation: &'a str,
    /// The source of the equation.
    pub reference: &'a str,
    /// The components of the state: the motion, then the parameters.
    pub channels: &'a [Channel],
    /// Whether it is linear while its parameters are constant; its response is exact then.
    pub is_linear: bool,
    /// The symbol of its springs in the picture.
    pub spring: Spring,
}

/// The symbol of a spring in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spring {
    /// A spring of one stiffness.
    Linear,
    /// A spring that hardens or softens with the parameter in this channel.
    Cubic(Channel),
    /// A spring with a slider, which the displacement in this channel follows until it slips.
    Slipping(Channel),
}

/// A plant with the state `y = [motion, parameters]` of N components, of which the first M move.
///
/// ```text
/// ẏ = g(y, f),  A = ∂g/∂y
/// ```
///
/// The force over mass f enters additively, and equally for every mass.
pub trait Plant: Any + Send + Sync {
    /// Names, keys and the components of the state.
    fn info(&self) -> PlantInfo<'_>;

    /// The first M components of `g(y, f)`, each in its unit per second, from all N and the force over mass \[m/s²\].
    fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]);

    /// The first M rows of A, row by row: `∂gᵢ/∂yⱼ` at `i N + j`. `jacobian` has M N numbers, which are zero.
    fn motion_jacobian(&self, state: &[f64], jacobian: &mut [f64]);
}

/// A plant by its data: one of the registry, a user's own, or an equation that a user typed.
#[derive(Clone)]
pub struct PlantKind(Source);

#[derive(Clone)]
enum Source {
    BuiltIn(&'static BuiltInPlant),
    Typed(Arc<Equation>),
    Own(Own),
}

impl PlantKind {
    /// A linear oscillator, `ẍ + 2ζωₙẋ + ωₙ²x = f`, with the state `y = [x, v, ωₙ, ζ]`.
    ///
    /// Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*.
    pub const SDOF: Self = Self(Source::BuiltIn(&built_in::SDOF));
    /// `ẍ + 2ζωₙẋ + ωₙ²x + μx³ = f` with the state `y = [x, v, ωₙ, ζ, μ]`: the spring hardens with μ > 0, and softens with μ < 0.
    ///
    /// Source: Duffing (1918), *Erzwungene Schwingungen bei veränderlicher Eigenfrequenz*; Kovacic and Brennan, eds. (2011),
    /// *The Duffing Equation*.
    pub const DUFFING: Self = Self(Source::BuiltIn(&built_in::DUFFING));
    /// A spring that yields and remembers: Bouc-Wen hysteresis with the exponent n = 2 and the state `y = [x, v, z, ωₙ, ζ, α, β, γ]`.
    ///
    /// ```text
    /// ẍ + 2ζωₙẋ + ωₙ²(α x + (1 - α) z) = f,  ż = ẋ - β |ẋ| |z|ⁿ⁻¹ z - γ ẋ |z|ⁿ
    /// ```
    ///
    /// z follows x until the spring yields, near `|z| = (β + γ)^(-1/n)`; the stiffness is then α times the initial one.
    ///
    /// Source: Wen (1976), Method for random vibration of hysteretic systems; Wu and Smyth (2007), Application of the unscented
    /// Kalman filter for real-time nonlinear structural system identification, section 4; Noël and Schoukens (2016), Hysteretic
    /// benchmark with a dynamic nonlinearity (exponent 1).
    pub const BOUC_WEN: Self = Self(Source::BuiltIn(&built_in::BOUC_WEN));
    /// The same with exponent 1.
    pub const BOUC_WEN_1: Self = Self(Source::BuiltIn(&built_in::BOUC_WEN_1));

    /// A user's own plant. Files name plants of the registry only; a plant with the key of one of these is refused.
    pub const fn new(plant: &'static dyn Plant) -> Self {
        Self(Source::Own(Own(plant)))
    }

    /// The plant of an equation that a user typed.
    ///
    /// # Errors
    /// [`EquationError`] if it is not an equation, with the character and what is allowed there.
    pub fn of_equation(settings: &EquationSettings) -> Result<Self, EquationError> {
        Ok(Self(Source::Typed(Arc::new(Equation::new(settings)?))))
    }

    /// The plant of the registry with this key, if there is one.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.key() == key)
    }

    /// Whether it is a user's own plant with a key of the registry: a file with this key would mean the registry's.
    pub fn is_impostor(&self) -> bool {
        matches!(self.0, Source::Own(_)) && Self::from_key(self.key()).is_some()
    }

    /// The equation of a plant that a user typed. `None` for any other plant.
    pub fn own_equation(&self) -> Option<&Equation> {
        match &self.0 {
            Source::Typed(equation) => Some(equation),
            Source::BuiltIn(_) | Source::Own(_) => None,
        }
    }

    /// The engine's form of the plant.
    pub fn dynamics(&self) -> EnginePlant {
        match &self.0 {
            Source::BuiltIn(built_in) => built_in.dynamics.clone(),
            Source::Typed(equation) => EnginePlant::Typed(Arc::clone(&equation.typed)),
            Source::Own(plant) => EnginePlant::Own(*plant),
        }
    }

    /// The rates of the components that move, from all components and the force over mass \[m/s²\]: see [`Plant::motion_rate`].
    pub fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        self.dynamics().motion_rate(state, force, rate);
    }

    /// The derivatives of these rates, row by row: see [`Plant::motion_jacobian`].
    pub fn motion_jacobian(&self, state: &[f64], jacobian: &mut [f64]) {
        self.dynamics().jacobian(state, jacobian);
    }

    /// Names, keys and the components of the state.
    pub fn info(&self) -> PlantInfo<'_> {
        match &self.0 {
            Source::BuiltIn(built_in) => built_in.info,
            Source::Own(plant) => plant.0.info(),
            Source::Typed(equation) => PlantInfo {
                key: &equation.settings().equation,
                name: "equation of your own",
                equation: &equation.settings().equation,
                reference: "",
                channels: &equation.channels,
                is_linear: equation.is_linear(),
                spring: Spring::Linear,
            },
        }
    }

    /// The key in scenario files.
    pub fn key(&self) -> &str {
        self.info().key
    }

    /// The name in running text.
    pub fn name(&self) -> &str {
        self.info().name
    }

    /// The equation of motion, per mass.
    pub fn equation(&self) -> &str {
        self.info().equation
    }

    /// The components of the state: the motion, then the parameters.
    pub fn channels(&self) -> &[Channel] {
        self.info().channels
    }

    /// The number of components that move.
    pub fn motion(&self) -> usize {
        motion(self.channels())
    }

    /// The number of masses.
    pub fn masses(&self) -> usize {
        (0..MAX_MASSES).take_while(|&mass| self.channels().contains(&Channel::displacement(mass))).count()
    }

    /// The plant's parameters.
    pub fn parameters(&self) -> impl Iterator<Item = Channel> {
        self.channels().iter().copied().filter(|c| c.is_parameter())
    }

    /// The measurable quantities of the plant.
    pub fn quantities(&self) -> impl Iterator<Item = Quantity> + Clone {
        Quantity::all().iter().copied().filter(move |&quantity| self.has(quantity))
    }

    /// The augmentations that the plant can have: those of the input and of its measurable quantities.
    pub fn augmentations(&self) -> impl Iterator<Item = Channel> {
        augment::of_all(self.quantities())
    }

    /// Whether the plant has a quantity to measure.
    pub fn has(&self, quantity: Quantity) -> bool {
        quantity.reads().iter().all(|(term, _)| match term {
            Term::State(channel) | Term::Rate(channel) => self.channels().contains(channel),
            Term::Ground => true,
        })
    }

    /// Whether the force acts on a mass, counted from 0.
    pub fn is_driven(&self, mass: usize) -> bool {
        let rate = |force| {
            let mut rate = vec![0.0; self.motion()];
            self.motion_rate(&self.anywhere(), force, &mut rate);
            Channel::velocity(mass).place_in(self.channels()).map(|place| rate[place])
        };
        rate(1.0) != rate(0.0)
    }

    /// Whether a spring holds a mass, counted from 0, to the one before it, or the first to the wall.
    pub fn is_held(&self, mass: usize) -> bool {
        let mut jacobian = vec![0.0; self.motion() * self.channels().len()];
        self.motion_jacobian(&self.anywhere(), &mut jacobian);
        let accelerates = |by: Channel, mass: usize| {
            let place = Channel::velocity(mass).place_in(self.channels()).zip(by.place_in(self.channels()));
            place.is_some_and(|(row, column)| jacobian[row * self.channels().len() + column] != 0.0)
        };
        match mass.checked_sub(1) {
            Some(before) => {
                accelerates(Channel::displacement(before), mass) || accelerates(Channel::displacement(mass), before)
            }
            None => accelerates(Channel::displacement(0), 0) || accelerates(Channel::velocity(0), 0),
        }
    }

    fn anywhere(&self) -> Vec<f64> {
        numbers(self.channels().len(), &|i| 0.31 + 0.17 * i as f64)
    }
}

macro_rules! kinds {
    ([$($other:ident)*] $($chain:ident $masses:literal)*) => {
        impl PlantKind {
            $(
            /// A chain of equal masses on a shaken base, as the storeys of a building: `y = [x₁ … x_m, v₁ … v_m, κ₁ … κ_m, c]`.
            ///
            /// ```text
            /// sᵢ = κᵢ (xᵢ - xᵢ₋₁) + c (vᵢ - vᵢ₋₁),  x₀ = v₀ = 0
            /// ẍᵢ = f - sᵢ + sᵢ₊₁,  s_{m+1} = 0
            /// ```
            ///
            /// xᵢ is the displacement against the base and f the base's acceleration with the sign reversed, the same for every mass.
            ///
            /// Source: Chopra (2017), *Dynamics of Structures*, sections 9.1 and 9.4.
            pub const $chain: Self = Self(Source::BuiltIn(&built_in::ShearPlant::<$masses>::PLANT));
            )*

            /// Every plant of the registry.
            pub const ALL: [Self; MAX_MASSES + 3] = [$(Self::$other,)* $(Self::$chain,)*];
        }
    };
}

kinds! {
    [SDOF DUFFING BOUC_WEN BOUC_WEN_1]
    SHEAR_2 2 SHEAR_3 3 SHEAR_4 4 SHEAR_5 5 SHEAR_6 6 SHEAR_7 7 SHEAR_8 8 SHEAR_9 9 SHEAR_10 10 SHEAR_11 11 SHEAR_12 12 SHEAR_13 13
    SHEAR_14 14 SHEAR_15 15 SHEAR_16 16 SHEAR_17 17 SHEAR_18 18 SHEAR_19 19 SHEAR_20 20
}

fn motion(channels: &[Channel]) -> usize {
    channels.iter().take_while(|channel| !channel.is_parameter()).count()
}

impl PartialEq for PlantKind {
    /// Compares keys; your own plant differs from the registry's plant with the same key.
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Source::BuiltIn(_), Source::BuiltIn(_)) => self.key() == other.key(),
            (Source::Typed(own), Source::Typed(other)) => own.settings() == other.settings(),
            (Source::Own(own), Source::Own(other)) => own == other,
            _ => false,
        }
    }
}

impl Eq for PlantKind {}

impl Serialize for PlantKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.own_equation() {
            Some(equation) => equation.settings().serialize(serializer),
            None => serializer.serialize_str(self.key()),
        }
    }
}

impl<'de> Deserialize<'de> for PlantKind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct KindVisitor;

        impl<'de> Visitor<'de> for KindVisitor {
            type Value = PlantKind;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the key of a plant, or a table with an equation")
            }

            fn visit_str<E: de::Error>(self, key: &str) -> Result<PlantKind, E> {
                static ALL: LazyLock<Vec<PlantKind>> = LazyLock::new(|| PlantKind::ALL.into());
                static KEYS: LazyLock<Vec<&str>> = LazyLock::new(|| ALL.iter().map(PlantKind::key).collect());
                PlantKind::from_key(key).ok_or_else(|| de::Error::unknown_variant(key, &KEYS))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<PlantKind, A::Error> {
                let settings = EquationSettings::deserialize(MapAccessDeserializer::new(map))?;
                PlantKind::of_equation(&settings).map_err(de::Error::custom)
            }
        }

        deserializer.deserialize_any(KindVisitor)
    }
}

impl Default for PlantKind {
    fn default() -> Self {
        Self::SDOF
    }
}

impl fmt::Debug for PlantKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.key())
    }
}

#[cfg(test)]
mod tests;
