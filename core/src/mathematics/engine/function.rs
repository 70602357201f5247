//! Functions of one number that an equation may have.

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Function {
    /// sin x
    Sin,
    /// cos x
    Cos,
    /// tan x
    Tan,
    /// eˣ
    Exp,
    /// The natural logarithm.
    Log,
    /// √x
    Sqrt,
    /// |x|
    Abs,
    /// -1, 0 or 1.
    Sign,
    /// tanh x
    Tanh,
    /// A power with the bits of its exponent.
    Power(u64),
}

impl Function {
    /// The functions that have names.
    pub const NAMED: [(Self, &'static str); 9] = [
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
    pub fn from_key(key: &str) -> Option<Self> {
        let key = if key == "ln" { "log" } else { key };
        Self::NAMED.iter().find(|(_, name)| *name == key).map(|(function, _)| *function)
    }

    /// The value at x.
    pub fn of(self, x: f64) -> f64 {
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
            Self::Power(exponent) => libm::pow(x, f64::from_bits(exponent)),
        }
    }
}
