//! The fast Fourier transform.

use crate::lists::mapped;
use std::f64::consts::TAU;

/// The power of real numbers, of zeros after them up to a length, at the frequencies below half their rate.
pub fn powers(numbers: impl Iterator<Item = f64>, length: usize) -> Vec<f64> {
    let mut buffer: Vec<(f64, f64)> = numbers.map(|number| (number, 0.0)).collect();
    buffer.resize(length, (0.0, 0.0));
    Transform::new(length).apply(&mut buffer);
    mapped(&buffer[..length / 2], &|(re, im)| re * re + im * im)
}

/// A fast Fourier transform of some length, a power of two. Source: Golub and Van Loan (2013), *Matrix Computations*, section
/// 1.4.
#[derive(Debug)]
pub struct Transform {
    turns: Vec<(f64, f64)>,
    places: Vec<u32>,
}

impl Transform {
    pub fn new(length: usize) -> Self {
        let bits = length.trailing_zeros();
        let turn = |k: usize| {
            let (sin, cos) = libm::sincos(-TAU * k as f64 / length as f64);
            (cos, sin)
        };
        let place = |k: u32| k.reverse_bits() >> (32 - bits);
        Self { turns: (0..length / 2).map(turn).collect(), places: (0..length as u32).map(place).collect() }
    }

    /// Transforms complex numbers in place: `Σ xₖ exp(-2πi jk/L)`.
    pub fn apply(&self, values: &mut [(f64, f64)]) {
        let length = values.len();
        for (k, &place) in self.places.iter().enumerate() {
            if k < place as usize {
                values.swap(k, place as usize);
            }
        }
        let mut half = 1;
        while half < length {
            let stride = length / (2 * half);
            for block in values.chunks_exact_mut(2 * half) {
                let (low, high) = block.split_at_mut(half);
                for ((a, b), &(cos, sin)) in low.iter_mut().zip(high).zip(self.turns.iter().step_by(stride)) {
                    let turned = (b.0 * cos - b.1 * sin, b.0 * sin + b.1 * cos);
                    *b = (a.0 - turned.0, a.1 - turned.1);
                    *a = (a.0 + turned.0, a.1 + turned.1);
                }
            }
            half *= 2;
        }
    }
}
