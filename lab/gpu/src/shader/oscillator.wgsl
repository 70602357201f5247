// The oscillator x'' = f + a x + b v with a = -wn^2, b = -2 zeta wn.

fn acceleration(y: vec4<f32>, force: f32) -> f32 {
  return force - 2.0 * y.w * y.z * y.y - y.z * y.z * y.x;
}

// The derivatives of the acceleration by the state.
fn acceleration_by(y: vec4<f32>) -> vec4<f32> {
  return vec4(-y.z * y.z, -2.0 * y.w * y.z, -2.0 * (y.z * y.x + y.w * y.y), -2.0 * y.z * y.y);
}
