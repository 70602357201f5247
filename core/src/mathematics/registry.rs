//! Types whose values are the rows of a registry, each with its key.

/// A constant for each row, by a constructor, and the list of all of them.
macro_rules! registry {
    ($type:ident by $new:path, $(#[$all:meta])* ALL; $($(#[$doc:meta])* $name:ident = $info:expr;)*) => {
        impl $type {
            $($(#[$doc])* pub const $name: Self = $new(&$info);)*

            $(#[$all])*
            pub const ALL: [Self; [$(stringify!($name)),*].len()] = [$(Self::$name),*];
        }
    };
}

/// In debug output and in files these stand as their keys.
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
}

pub(crate) use {keyed, registry};
