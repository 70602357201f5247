// KF and EKF: the state and its covariance by the solution that is exact where the oscillator is linear.

// h'' = a h + b h', h(0) = 0, h'(0) = 1, and q, its integral: as the core has it, with fewer terms.
fn response(a: f32, b: f32, dt: f32) -> vec2<f32> {
  let size = max(sqrt(abs(a)), abs(b)) * dt;
  var doublings = 0u;
  if (size > 0.25) {
    // A step that is too long to halve gives no finite number anyway.
    doublings = u32(clamp(ceil(log2(4.0 * size)), 0.0, 64.0));
  }
  let t = dt * exp2(-f32(doublings));
  let alpha = a * t * t;
  let beta = b * t;
  let c2 = beta * beta + alpha;
  let c3 = beta * c2 + alpha * beta;
  let c4 = beta * c3 + alpha * c2;
  let c5 = beta * c4 + alpha * c3;
  let c6 = beta * c5 + alpha * c4;
  let c7 = beta * c6 + alpha * c5;
  var h = t * (1.0 + (beta / 2.0 + (c2 / 6.0 + (c3 / 24.0 + (c4 / 120.0 + (c5 / 720.0 + (c6 / 5040.0 + c7 / 40320.0)))))));
  var q = t * t * (0.5 + (beta / 6.0 + (c2 / 24.0 + (c3 / 120.0 + (c4 / 720.0 + (c5 / 5040.0 + (c6 / 40320.0 + c7 / 362880.0)))))));
  for (var i = 0u; i < doublings; i++) {
    let doubled = vec2(h * (2.0 + 2.0 * a * q + b * h), q * (2.0 + a * q) + h * h);
    h = doubled.x;
    q = doubled.y;
  }
  return vec2(h, q);
}

fn predict(belief: ptr<function, Belief>, force: f32, cell: Cell) {
  let y = (*belief).mean;
  let by = acceleration_by(y);
  let a = by.x;
  let b = by.y;
  let rate = acceleration(y, force);
  let hq = response(a, b, settings.dt);
  let h = hq.x;
  let q = hq.y;
  // The first two rows of the transition matrix; the others are those of the identity.
  let row0 = vec4(1.0 + a * q, h, q * by.z, q * by.w);
  let row1 = vec4(a * h, 1.0 + a * q + b * h, h * by.z, h * by.w);
  move_by(belief, vec4((h - b * q) * y.y + q * rate, a * q * y.y + h * rate, 0.0, 0.0));
  let fading = cell.fading;
  let rows = Rows(
    through_root(*belief, row0) * fading,
    through_root(*belief, row1) * fading,
    vec4((*belief).l0.z, (*belief).l1.y, (*belief).l2.x, 0.0) * fading,
    vec4((*belief).l0.w, (*belief).l1.z, (*belief).l2.y, (*belief).l3) * fading,
  );
  let noise = cell.process;
  set_root(belief, rows, Rows(
    vec4(noise.x, 0.0, 0.0, 0.0),
    vec4(0.0, noise.y, 0.0, 0.0),
    vec4(0.0, 0.0, noise.z, 0.0),
    vec4(0.0, 0.0, 0.0, noise.w),
  ));
}

// The expected acceleration, its dependence on the state through L, and the variance that it has besides.
struct Reading {
  mean: f32,
  through: vec4<f32>,
  variance: f32,
}

fn look(belief: Belief, force: f32) -> Reading {
  let row = acceleration_by(belief.mean);
  return Reading(acceleration(belief.mean, force), through_root(belief, row), 0.0);
}
