// Functions that equations have, and their differences: of(a + d) - of(a) without the digits that a subtraction loses.

fn root_of(a: f32) -> f32 {
  return select(sqrt(a), not_a_number(), is_negative(a));
}

fn log_of(a: f32) -> f32 {
  return select(log(a), not_a_number(), is_negative(a));
}

// The hyperbolic tangent, which overflows on some processors, is one to rounding from ten on.
fn tanh_of(a: f32) -> f32 {
  return tanh(clamp(a, -10.0, 10.0));
}

// A power, by the absolute value: `parity` is 0 where the exponent is even, 1 where it is odd, 2 where it is not whole.
fn power_of(a: f32, exponent: f32, parity: u32) -> f32 {
  let power = pow(abs(a), exponent);
  if (!is_negative(a) || parity == 0u) {
    return power;
  }
  return select(not_a_number(), -power, parity == 1u);
}

// exp(d) - 1
fn exp_less_one(d: f32) -> f32 {
  if (abs(d) > 0.5) {
    return exp(d) - 1.0;
  }
  return d * (1.0 + d / 2.0 * (1.0 + d / 3.0 * (1.0 + d / 4.0 * (1.0 + d / 5.0 * (1.0 + d / 6.0 * (1.0 + d / 7.0 * (1.0 + d / 8.0)))))));
}

// log(1 + u), u > -1
fn log_one_more(u: f32) -> f32 {
  if (abs(u) > 0.5) {
    return log(1.0 + u);
  }
  let s = u / (2.0 + u);
  let q = s * s;
  return 2.0 * s * (1.0 + q * (1.0 / 3.0 + q * (1.0 / 5.0 + q * (1.0 / 7.0 + q * (1.0 / 9.0 + q / 11.0)))));
}

fn sin_apart(a: f32, d: f32) -> f32 {
  return 2.0 * cos(a + 0.5 * d) * sin(0.5 * d);
}

fn cos_apart(a: f32, d: f32) -> f32 {
  return -2.0 * sin(a + 0.5 * d) * sin(0.5 * d);
}

fn tan_apart(a: f32, d: f32) -> f32 {
  return sin(d) / (cos(a) * cos(a + d));
}

fn exp_apart(a: f32, d: f32) -> f32 {
  return exp(a) * exp_less_one(d);
}

fn log_apart(a: f32, d: f32) -> f32 {
  if (is_negative(a) || is_negative(a + d)) {
    return not_a_number();
  }
  return log_one_more(d / a);
}

fn sqrt_apart(a: f32, d: f32) -> f32 {
  let sum = root_of(a + d) + root_of(a);
  return select(d / sum, 0.0, bitcast<u32>(sum) == 0u);
}

fn abs_apart(a: f32, d: f32) -> f32 {
  if (is_negative(a) == is_negative(a + d)) {
    return select(d, -d, is_negative(a));
  }
  return abs(a + d) - abs(a);
}

fn sign_apart(a: f32, d: f32) -> f32 {
  return sign(a + d) - sign(a);
}

fn tanh_apart(a: f32, d: f32) -> f32 {
  return tanh_of(d) * (1.0 - tanh_of(a) * tanh_of(a + d));
}

fn power_apart(a: f32, d: f32, exponent: f32, parity: u32) -> f32 {
  let u = d / a;
  if (abs(u) < 0.5) {
    return power_of(a, exponent, parity) * exp_less_one(exponent * log_one_more(u));
  }
  return power_of(a + d, exponent, parity) - power_of(a, exponent, parity);
}
