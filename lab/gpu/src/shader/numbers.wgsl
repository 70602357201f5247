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

fn is_finite4(v: vec4<f32>) -> bool {
  return is_finite(v.x) && is_finite(v.y) && is_finite(v.z) && is_finite(v.w);
}

// The same number, which compilers cannot know: they take (a + b) - a for b, and what b has lost to rounding is gone.
fn rounded(v: vec4<f32>) -> vec4<f32> {
  return bitcast<vec4<f32>>(bitcast<vec4<u32>>(v) | vec4(settings.zero));
}
