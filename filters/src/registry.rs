//! Types whose values are the rows of a registry, each with its key.

macro_rules! registry {
    ($type:ident by $new:path, $(#[$all:meta])* ALL; $($(#[$doc:meta])* $name:ident = $info:expr;)*) => {
        impl $type {
            $($(#[$doc])* pub const $name: Self = $new(&$info);)*

            $(#[$all])*
            pub const ALL: [Self; [$(stringify!($name)),*].len()] = [$(Self::$name),*];
        }
    };
}

/// These stand as their keys in debug output and in files; those of a registry are also read.
macro_rules! keyed {
    ($type:ty) => {
        impl std::fmt::Debug for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(self.key())
            }
        }

        impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.key())
            }
        }
    };
    ($type:ty, also read) => {
        $crate::registry::keyed!($type);

        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                static KEYS: std::sync::LazyLock<Vec<&'static str>> =
                    std::sync::LazyLock::new(|| $crate::lists::mapped(&<$type>::ALL, &|row| row.key()));
                let key = String::deserialize(deserializer)?;
                let row = Self::ALL.into_iter().find(|row| row.key() == key);
                row.ok_or_else(|| serde::de::Error::unknown_variant(&key, &KEYS))
            }
        }
    };
}

macro_rules! hashed {
    ($type:ty) => {
        impl std::hash::Hash for $type {
            fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
                std::hash::Hash::hash(self.key(), state);
            }
        }

        impl PartialOrd for $type {
            fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
                Some(self.cmp(other))
            }
        }
    };
}

pub(crate) use {hashed, keyed, registry};
