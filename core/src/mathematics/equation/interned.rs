//! Equations that have been read: each is kept once, for as long as the program runs.

use std::sync::{Mutex, PoisonError, RwLock};

use super::error::EquationError;
use super::own::Equation;
use super::settings::EquationSettings;
use crate::{Channel, PlantKind};

/// Limits the equations of one program, each of which takes some kilobytes.
const MOST: usize = 4096;

static EQUATIONS: Mutex<Vec<&'static Equation>> = Mutex::new(Vec::new());

/// The channels that equations have and built-in plants lack; of one key, the latest.
static CHANNELS: RwLock<&'static [Channel]> = RwLock::new(&[]);

/// The channels of all equations that have been read.
pub(crate) fn channels() -> &'static [Channel] {
    *CHANNELS.read().unwrap_or_else(PoisonError::into_inner)
}

/// Whether an equation with this text has been read, so that the keys of its parameters are known.
pub(crate) fn is_read(text: &str) -> bool {
    let known = EQUATIONS.lock().unwrap_or_else(PoisonError::into_inner);
    known.iter().any(|one| one.settings().equation == text)
}

impl PlantKind {
    /// The plant of an equation that a user typed.
    ///
    /// # Errors
    /// [`EquationError`] if it is not an equation, with the character and what is allowed there.
    pub fn of_equation(settings: &EquationSettings) -> Result<Self, EquationError> {
        let mut known = EQUATIONS.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(equation) = known.iter().find(|one| one.settings() == settings) {
            register(Self::new(*equation));
            return Ok(Self::new(*equation));
        }
        if known.len() >= MOST {
            return Err(EquationError::new(format!("{MOST} equations have been read: start the program anew")));
        }
        let equation: &'static Equation = Box::leak(Box::new(Equation::new(settings)?));
        known.push(equation);
        let kind = Self::new(equation);
        register(kind);
        Ok(kind)
    }

    /// The equation of a plant that a user typed. `None` for a built-in plant.
    pub fn own_equation(self) -> Option<&'static Equation> {
        let plant: &'static dyn std::any::Any = self.plant();
        plant.downcast_ref()
    }
}

/// Makes the channels of an equation those that their keys mean.
fn register(kind: PlantKind) {
    let of_plants = |channel: Channel| PlantKind::ALL.iter().any(|kind| kind.channels().contains(&channel));
    let own = || kind.channels().iter().copied().filter(|channel| !of_plants(*channel));
    let mut channels = CHANNELS.write().unwrap_or_else(PoisonError::into_inner);
    let is_known = |channel: Channel| channels.iter().any(|other| std::ptr::eq(other.info(), channel.info()));
    if !own().all(is_known) {
        let others = channels.iter().copied().filter(|one| !kind.channels().contains(one));
        *channels = others.chain(own()).collect::<Vec<_>>().leak();
    }
}
