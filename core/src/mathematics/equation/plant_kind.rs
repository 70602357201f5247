//! Plants in files, and when two are equal: the key of a built-in plant, or a table with an equation.

use std::fmt;
use std::sync::LazyLock;

use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use super::own::Equation;
use super::settings::EquationSettings;
use crate::PlantKind;

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
                    LazyLock::new(|| PlantKind::ALL.iter().map(|kind| kind.key()).collect());
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
