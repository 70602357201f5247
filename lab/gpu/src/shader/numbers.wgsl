// Compilers may take it for granted that there is no NaN and no infinity. So bits are looked at, not numbers.

fn is_finite(v: f32) -> bool {
  return (bitcast<u32>(v) & 0x7f800000u) != 0x7f800000u;
}

// Whether a number is positive, and neither subnormal nor infinite.
fn is_positive(v: f32) -> bool {
  let bits = bitcast<u32>(v);
  return bits >= 0x00800000u && bits < 0x7f800000u;
}

// Whether a number is negative; -0 is not.
fn is_negative(v: f32) -> bool {
  return bitcast<u32>(v) > 0x80000000u;
}

// The same number, which compilers cannot know: they take (a + b) - a for b, and what b has lost to rounding is gone.
fn rounded(v: f32) -> f32 {
  return bitcast<f32>(bitcast<u32>(v) | settings.zero);
}

fn not_a_number() -> f32 {
  return bitcast<f32>(0x7fc00000u | settings.zero);
}
