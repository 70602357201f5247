//! Plants of equations: each that has been read is kept once, for as long as the program runs. Plants in files, and when two are
//! equal: the key of a built-in plant, or a table with an equation.

use std::fmt;
use std::sync::{LazyLock, Mutex, PoisonError, RwLock};

use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use super::EquationError;
use super::own::Equation;
use super::settings::EquationSettings;
use crate::mathematics::lists::mapped;
use crate::{Channel, PlantKind};

/// Limits the equations of one program, each of which takes some kilobytes.
const MOST: usize = 4096;

static EQUATIONS: Mutex<Vec<&'static Equation>> = Mutex::new(Vec::new());

/// The channels that equations have and built-in plants lack; of one key, the latest.
static CHANNELS: RwLock<&'static [Channel]> = RwLock::new(&[]);

pub(crate) fn channels() -> &'static [Channel] {
    *CHANNELS.read().unwrap_or_else(PoisonError::into_inner)
}

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

impl PartialEq for PlantKind {
    /// Compares key and type: your own plant differs from the registry's plant with the same key.
    fn eq(&self, other: &Self) -> bool {
        let equations = [self.own_equation(), other.own_equation()].map(|one| one.map(Equation::settings));
        self.key() == other.key() && self.type_id() == other.type_id() && equations[0] == equations[1]
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
        struct Kind;

        impl<'de> Visitor<'de> for Kind {
            type Value = PlantKind;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the key of a plant, or a table with an equation")
            }

            fn visit_str<E: de::Error>(self, key: &str) -> Result<PlantKind, E> {
                static KEYS: LazyLock<Vec<&'static str>> =
                    LazyLock::new(|| mapped(&PlantKind::ALL, &|kind| kind.key()));
                PlantKind::from_key(key).ok_or_else(|| de::Error::unknown_variant(key, &KEYS))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<PlantKind, A::Error> {
                let settings = EquationSettings::deserialize(MapAccessDeserializer::new(map))?;
                PlantKind::of_equation(&settings).map_err(de::Error::custom)
            }
        }

        deserializer.deserialize_any(Kind)
    }
}
