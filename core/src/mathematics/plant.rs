//! Plants: their equations of motion and parameters.

pub mod bouc_wen;
pub mod duffing;
pub mod sdof;
pub mod shear_chain;
mod structure;

use std::any::{Any, TypeId};
use std::fmt;

use crate::mathematics::channel::MAX_MASSES;
use crate::mathematics::quantity::Term;
use crate::{Channel, Quantity};

/// A plant's data other than its equation.
#[derive(Clone, Copy, Debug)]
pub struct PlantInfo {
    /// The key in scenario files.
    pub key: &'static str,
    /// The name in running text.
    pub name: &'static str,
    /// The equation of motion, per mass.
    pub equation: &'static str,
    /// The source of the equation.
    pub reference: &'static str,
    /// The components of the state: the motion, then the parameters.
    pub channels: &'static [Channel],
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

/// A plant with the state `y = [motion, parameters]` of N components. The first M move. Its parameters are constant or
/// decay at a rate η; the model of the plant adds that, not the plant's equation.
///
/// ```text
/// ẏ = g(y, f),  A = ∂g/∂y
/// ```
///
/// The force over mass f enters additively, and equally for every mass.
pub trait Plant: Any + Send + Sync {
    /// Names, keys and the components of the state.
    fn info(&self) -> &PlantInfo;

    /// The first M components of `g(y, f)`, each in its unit per second, from a state of N components and the force over
    /// mass \[m/s²\].
    fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]);

    /// The first M rows of A, row by row: `∂gᵢ/∂yⱼ` at `i N + j`. `jacobian` has M N numbers, which are zero.
    fn motion_jacobian(&self, state: &[f64], jacobian: &mut [f64]);
}

/// A plant by its data: one of the registry, or a user's own.
#[derive(Clone, Copy)]
pub struct PlantKind(&'static dyn Plant);

/// The registry: a constant for each plant, and the list of all.
macro_rules! registry {
    ($($(#[$doc:meta])* $name:ident = $plant:expr;)*) => {
        impl PlantKind {
            $($(#[$doc])* pub const $name: Self = Self(&$plant);)*

            /// Every plant of the registry.
            pub const ALL: [Self; [$(stringify!($name)),*].len()] = [$(Self::$name),*];
        }
    };
}
registry! {
    /// A linear oscillator with a single degree of freedom: [`sdof::Sdof`].
    SDOF = sdof::Sdof;
    /// An oscillator with a cubic part in its spring: [`duffing::Duffing`].
    DUFFING = duffing::Duffing;
    /// An oscillator with a spring that yields and remembers: [`bouc_wen::BoucWen`].
    BOUC_WEN = bouc_wen::BoucWen::TWO;
    /// The same with exponent 1.
    BOUC_WEN_1 = bouc_wen::BoucWen::ONE;
    /// A chain of two masses: [`shear_chain::ShearChain`].
    SHEAR_2 = shear_chain::ShearChain::<2>;
    /// A chain of three masses.
    SHEAR_3 = shear_chain::ShearChain::<3>;
    /// A chain of four masses.
    SHEAR_4 = shear_chain::ShearChain::<4>;
    /// A chain of five masses.
    SHEAR_5 = shear_chain::ShearChain::<5>;
    /// A chain of six masses.
    SHEAR_6 = shear_chain::ShearChain::<6>;
    /// A chain of seven masses.
    SHEAR_7 = shear_chain::ShearChain::<7>;
    /// A chain of eight masses.
    SHEAR_8 = shear_chain::ShearChain::<8>;
    /// A chain of nine masses.
    SHEAR_9 = shear_chain::ShearChain::<9>;
    /// A chain of ten masses.
    SHEAR_10 = shear_chain::ShearChain::<10>;
}

impl PlantKind {
    /// A user's own plant, for use in scenarios. Files can name plants of the registry only, and a scenario with a plant that has
    /// the key of one of these is refused.
    pub const fn new(plant: &'static dyn Plant) -> Self {
        Self(plant)
    }

    /// The plant of the registry with this key, if there is one.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.key() == key)
    }

    /// Whether it is a user's own plant with a key of the registry: a file with this key would mean the registry's.
    pub(crate) fn is_impostor(self) -> bool {
        Self::from_key(self.key()).is_some_and(|known| known.type_id() != self.type_id())
    }

    /// The type of the plant.
    pub(crate) fn type_id(self) -> TypeId {
        let plant: &dyn Any = self.0;
        plant.type_id()
    }

    /// The plant itself.
    pub fn plant(self) -> &'static dyn Plant {
        self.0
    }

    /// Names, keys and the components of the state.
    pub fn info(self) -> &'static PlantInfo {
        self.0.info()
    }

    /// The key in scenario files.
    pub fn key(self) -> &'static str {
        self.info().key
    }

    /// The name in running text.
    pub fn name(self) -> &'static str {
        self.info().name
    }

    /// The equation of motion, per mass.
    pub fn equation(self) -> &'static str {
        self.info().equation
    }

    /// The source of the equation.
    pub fn reference(self) -> &'static str {
        self.info().reference
    }

    /// The components of the state: the motion, then the parameters.
    pub fn channels(self) -> &'static [Channel] {
        self.info().channels
    }

    /// The number of components that move.
    pub fn motion(self) -> usize {
        self.channels().iter().take_while(|c| !c.is_parameter()).count()
    }

    /// The number of masses.
    pub fn masses(self) -> usize {
        (0..MAX_MASSES).take_while(|&mass| self.channels().contains(&Channel::displacement(mass))).count()
    }

    /// Whether it is a chain of masses of the registry.
    pub(crate) fn is_chain(self) -> bool {
        self.masses() > 1 && Self::ALL.contains(&self)
    }

    /// The plant's parameters.
    pub fn parameters(self) -> impl Iterator<Item = Channel> {
        self.channels().iter().copied().filter(|c| c.is_parameter())
    }

    /// The measurable quantities of the plant.
    pub fn quantities(self) -> impl Iterator<Item = Quantity> + Clone {
        Quantity::all().iter().copied().filter(move |&quantity| self.has(quantity))
    }

    /// Whether the plant has a quantity to measure.
    pub fn has(self, quantity: Quantity) -> bool {
        quantity.reads().iter().all(|(term, _)| match term {
            Term::State(channel) | Term::Rate(channel) => self.channels().contains(channel),
            Term::Ground => true,
        })
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
