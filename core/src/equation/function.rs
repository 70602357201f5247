//! Functions of one number.

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Function {
    Sin,
    Cos,
    Tan,
    Exp,
    Log,
    Sqrt,
    Abs,
    Sign,
    Tanh,
}

impl Function {
    pub(super) const ALL: [(Self, &'static str); 9] = [
        (Self::Sin, "sin"),
        (Self::Cos, "cos"),
        (Self::Tan, "tan"),
        (Self::Exp, "exp"),
        (Self::Log, "log"),
        (Self::Sqrt, "sqrt"),
        (Self::Abs, "abs"),
        (Self::Sign, "sign"),
        (Self::Tanh, "tanh"),
    ];

    /// The function with this name.
    pub(super) fn from_key(key: &str) -> Option<Self> {
        let key = if key == "ln" { "log" } else { key };
        Self::ALL.iter().find(|(_, name)| *name == key).map(|(function, _)| *function)
    }

    pub(super) fn of(self, x: f64) -> f64 {
        match self {
            Self::Sin => libm::sin(x),
            Self::Cos => libm::cos(x),
            Self::Tan => libm::tan(x),
            Self::Exp => libm::exp(x),
            Self::Log => libm::log(x),
            Self::Sqrt => x.sqrt(),
            Self::Abs => x.abs(),
            Self::Sign if x > 0.0 => 1.0,
            Self::Sign if x < 0.0 => -1.0,
            Self::Sign => 0.0,
            Self::Tanh => libm::tanh(x),
        }
    }
}
