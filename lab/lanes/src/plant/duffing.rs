//! The oscillator with a cubic spring.

use kalmanscope_core::internals::kernel::Duffing;

use super::Plant;
use crate::lane::Lane;

impl Plant<5> for Duffing {
    #[inline(always)]
    fn acceleration<T: Lane>(&[x, v, wn, zeta, mu]: &[T; 5], force: T) -> T {
        force - x.of(2.0) * zeta * wn * v - wn * wn * x - mu * x * x * x
    }

    #[inline(always)]
    fn slopes<T: Lane>(&[x, v, wn, zeta, mu]: &[T; 5]) -> [T; 5] {
        let two = x.of(-2.0);
        [-wn * wn - x.of(3.0) * mu * x * x, two * zeta * wn, two * (wn * x + zeta * v), two * wn * v, -x * x * x]
    }
}
