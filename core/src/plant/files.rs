//! Plants in files: the key of a built-in one, or a table with an equation.

use std::fmt;
use std::sync::{Arc, LazyLock};

use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use super::{PlantKind, Source};
use crate::equation::{Equation, EquationError, EquationSettings};

impl PlantKind {
    /// The plant of an equation that a user typed.
    ///
    /// # Errors
    /// [`EquationError`] if it is not an equation, with the character and what is allowed there.
    pub fn of_equation(settings: &EquationSettings) -> Result<Self, EquationError> {
        Ok(Self(Source::Typed(Arc::new(Equation::new(settings)?))))
    }
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
