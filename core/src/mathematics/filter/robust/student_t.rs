//! Noise with Student's distribution.

use super::RobustInfo;

/// ν, the degrees of freedom: the fewer, the heavier the tails.
const DEGREES: f64 = 4.0;

/// Each reading has a precision of its own, whose expectation given the state is the weight.
///
/// ```text
/// w = (ν + 1) / (ν + (ε² + H P⁺ Hᵀ) / R)
/// ```
pub(super) static STUDENT_T: RobustInfo = RobustInfo {
    key: "student_t",
    name: "Student-t",
    description: "takes each sensor's noise for Student's with 4 degrees of freedom",
    reference: "Agamennoni, Nieto and Nebot (2012), Approximate inference in state-space models with heavy-tailed noise",
    passes: 10,
    is_probable: false,
    weight: |misfit| (DEGREES + 1.0) / (DEGREES + misfit.residual + misfit.uncertainty),
};
