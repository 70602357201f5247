//! The motion of a state over one step: exact for linear rates, Runge-Kutta for others.

mod exponential;
mod impulse_response;
mod runge_kutta;

#[cfg(test)]
pub(crate) use exponential::Integrals;
pub(crate) use exponential::exponential_integrals;
pub(crate) use impulse_response::ImpulseResponse;
pub(crate) use runge_kutta::RungeKutta;

/// 1/n! for n = 0..=17.
#[doc(hidden)]
pub const INVERSE_FACTORIAL: [f64; 18] = {
    let mut table = [1.0; 18];
    let mut n = 1;
    while n < table.len() {
        table[n] = table[n - 1] / n as f64;
        n += 1;
    }
    table
};

/// The number of times that a step must be halved until `size`, a norm of `A dt`, is at most one half; zero for one that is
/// NaN or has [no number](LARGEST).
#[doc(hidden)]
pub fn doublings(size: f64) -> u32 {
    if size > 0.5 && size < LARGEST { libm::ceil(libm::log2(2.0 * size)) as u32 } else { 0 }
}

/// Limits the size of a step that is halved. Rounding has left no digit of a longer one, and without halving six of its terms
/// overflow, which callers detect.
pub(crate) const LARGEST: f64 = 1e60;
