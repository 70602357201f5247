//! The kinds of plant, and the one place where a kind becomes a model.

use serde::{Deserialize, Serialize};

use crate::model::Model;
use crate::models::bouc_wen::BoucWen;
use crate::models::duffing::Duffing;
use crate::models::log_parameters::LogParameters;
use crate::models::sdof::Sdof;
use crate::models::shear_chain::ShearChain;
use crate::{Channel, Quantity};

/// The kinds of plant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlantKind {
    /// A linear oscillator with a single degree of freedom: [`Sdof`].
    #[default]
    Sdof,
    /// An oscillator whose spring has a cubic part: [`Duffing`].
    Duffing,
    /// An oscillator whose spring yields and remembers: [`BoucWen`].
    BoucWen,
    /// A chain of two masses: [`ShearChain`].
    #[serde(rename = "shear_2")]
    Shear2,
    /// A chain of three masses: [`ShearChain`].
    #[serde(rename = "shear_3")]
    Shear3,
    /// A chain of four masses: [`ShearChain`].
    #[serde(rename = "shear_4")]
    Shear4,
}

/// Something to be done with a model, whatever its type and size.
pub(crate) trait Visitor {
    type Output;

    fn visit<P: Model<N>, const N: usize>(self, model: P) -> Self::Output;
}

impl PlantKind {
    /// Every kind.
    pub const ALL: [Self; 6] = [Self::Sdof, Self::Duffing, Self::BoucWen, Self::Shear2, Self::Shear3, Self::Shear4];

    /// The key in scenario files.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Sdof => "sdof",
            Self::Duffing => "duffing",
            Self::BoucWen => "bouc_wen",
            Self::Shear2 => "shear_2",
            Self::Shear3 => "shear_3",
            Self::Shear4 => "shear_4",
        }
    }

    /// The name in running text.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Sdof => "linear oscillator",
            Self::Duffing => "Duffing oscillator",
            Self::BoucWen => "Bouc-Wen oscillator",
            Self::Shear2 => "shear chain, 2 masses",
            Self::Shear3 => "shear chain, 3 masses",
            Self::Shear4 => "shear chain, 4 masses",
        }
    }

    /// The equation of motion, per mass.
    pub const fn equation(self) -> &'static str {
        match self {
            Self::Sdof => "ẍ + 2ζωₙẋ + ωₙ²x = f",
            Self::Duffing => "ẍ + 2ζωₙẋ + ωₙ²x + μx³ = f",
            Self::BoucWen => "ẍ + 2ζωₙẋ + ωₙ²(αx + (1 - α)z) = f, ż = ẋ - β|ẋ||z|z - γẋz²",
            Self::Shear2 | Self::Shear3 | Self::Shear4 => {
                "ẍ₁ = f - s₁ + s₂, ẍ₂ = f - s₂ + …; s₁ = κ₁x₁ + cẋ₁, s₂ = κ₂(x₂ - x₁) + c(ẋ₂ - ẋ₁), …"
            }
        }
    }

    /// Where it comes from.
    pub const fn reference(self) -> &'static str {
        match self {
            Self::Sdof => "Huang and Yuen (2023), Bayesian Real-Time System Identification",
            Self::Duffing => "Kovacic and Brennan, eds. (2011), The Duffing Equation",
            Self::BoucWen => "Wen (1976), Method for random vibration of hysteretic systems",
            Self::Shear2 | Self::Shear3 | Self::Shear4 => "Chopra (2017), Dynamics of Structures, section 9.1",
        }
    }

    /// Lets the visitor work with the model of this kind, whose parameters decay at the rate `eta` \[1/s\].
    pub(crate) fn visit<V: Visitor>(self, eta: f64, visitor: V) -> V::Output {
        match self {
            Self::Sdof => visitor.visit(Sdof { eta }),
            Self::Duffing => visitor.visit(Duffing { eta }),
            Self::BoucWen => visitor.visit(BoucWen { eta }),
            Self::Shear2 => visitor.visit(ShearChain::<2> { eta }),
            Self::Shear3 => visitor.visit(ShearChain::<3> { eta }),
            Self::Shear4 => visitor.visit(ShearChain::<4> { eta }),
        }
    }

    /// As [`Self::visit`], with the logarithms of the positive parameters in the state instead of themselves if so wished.
    pub(crate) fn visit_log<V: Visitor>(self, eta: f64, log_parameters: bool, visitor: V) -> V::Output {
        struct WithLogarithms<V>(V, bool);
        impl<V: Visitor> Visitor for WithLogarithms<V> {
            type Output = V::Output;

            fn visit<P: Model<N>, const N: usize>(self, plant: P) -> V::Output {
                self.0.visit(LogParameters { plant, on: self.1 })
            }
        }
        self.visit(eta, WithLogarithms(visitor, log_parameters))
    }

    /// The components of the plant's augmented state, those that move first.
    pub fn channels(self) -> &'static [Channel] {
        struct Channels;
        impl Visitor for Channels {
            type Output = &'static [Channel];

            fn visit<P: Model<N>, const N: usize>(self, _: P) -> &'static [Channel] {
                &P::CHANNELS
            }
        }
        self.visit(0.0, Channels)
    }

    /// The plant's parameters.
    pub fn parameters(self) -> impl Iterator<Item = Channel> {
        self.channels().iter().copied().filter(|c| c.is_parameter())
    }

    /// What can be measured of the plant.
    pub fn quantities(self) -> impl Iterator<Item = Quantity> {
        let has = move |channel: Option<Channel>| channel.is_some_and(|c| self.channels().contains(&c));
        Quantity::ALL.into_iter().filter(move |q| has(q.channel().or_else(|| q.integral()?.channel())))
    }
}
