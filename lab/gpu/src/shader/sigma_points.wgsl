// UKF: sigma points, each moved by one Runge-Kutta step. Points are held as deviations from the mean, and moved by what the
// step makes of deviations: the difference of two steps would lose most of its digits.

// The square of the points' distance in standard deviations.
const SPREAD = 3.0;
const DISTANCE = 1.7320508;

struct Root {
  l0: vec4<f32>,
  l1: vec4<f32>,
  l2: vec4<f32>,
  l3: vec4<f32>,
  reason: u32,
}

// The scale of a column: one over the root of its pivot, 0 where the pivot is zero to rounding.
fn scale_of(pivot: f32, variance: f32, reason: ptr<function, u32>) -> f32 {
  let rounding = 16.0 * EPSILON * variance;
  if (is_positive(pivot) && pivot > rounding) {
    return 1.0 / sqrt(pivot);
  }
  if (!is_finite(pivot)) {
    *reason = NOT_FINITE;
  } else if (pivot < -1e4 * rounding) {
    *reason = INDEFINITE;
  }
  return 0.0;
}

// The lower triangular root of the covariance, column by column.
fn lower_root(b: Belief) -> Root {
  var reason = 0u;
  let l0 = b.p0 * scale_of(b.p0.x, b.p0.x, &reason);
  let d1 = b.p1 - l0.yzw * l0.y;
  let l1 = d1 * scale_of(d1.x, b.p1.x, &reason);
  let d2 = b.p2 - l0.zw * l0.z - l1.yz * l1.y;
  let l2 = d2 * scale_of(d2.x, b.p2.x, &reason);
  let d3 = b.p3 - l0.w * l0.w - l1.z * l1.z - l2.y * l2.y;
  let l3 = d3 * scale_of(d3, b.p3, &reason);
  return Root(l0, vec4(0.0, l1), vec4(0.0, 0.0, l2), vec4(0.0, 0.0, 0.0, l3), reason);
}

// The Runge-Kutta step of the mean and what it is made of.
struct Step {
  y: vec4<f32>,
  force: f32,
  a: f32,
  b: f32,
  rate: f32,
  h: f32,
  q: f32,
  // alpha, beta, and the sums of second and third order
  terms: vec4<f32>,
}

fn step_of(y: vec4<f32>, force: f32, dt: f32) -> Step {
  let a = -y.z * y.z;
  let b = -2.0 * y.w * y.z;
  let alpha = a * dt * dt;
  let beta = b * dt;
  let second = alpha + beta * beta;
  let third = beta * (second + alpha);
  let h = dt * (1.0 + (beta / 2.0 + (second / 6.0 + third / 24.0)));
  let q = dt * dt * (0.5 + (beta / 6.0 + second / 24.0));
  return Step(y, force, a, b, acceleration(y, force), h, q, vec4(alpha, beta, second, third));
}

// The difference of the acceleration's coefficients a and b, and of the acceleration, of a state that deviates.
fn rate_apart(y: vec4<f32>, d: vec4<f32>) -> vec3<f32> {
  let da = -d.z * (2.0 * y.z + d.z);
  let db = -2.0 * (y.w * d.z + d.w * (y.z + d.z));
  let rate = -2.0 * y.w * y.z * d.y + db * (y.y + d.y) - y.z * y.z * d.x + da * (y.x + d.x);
  return vec3(da, db, rate);
}

// The deviation of displacement and velocity after the step.
fn apart(s: Step, d: vec4<f32>, dt: f32) -> vec2<f32> {
  let apart = rate_apart(s.y, d);
  let da = apart.x;
  let db = apart.y;
  let alpha = da * dt * dt;
  let beta = db * dt;
  let new_beta = s.terms.y + beta;
  let second = alpha + beta * (s.terms.y + new_beta);
  let third = beta * (s.terms.z + s.terms.x) + new_beta * (second + alpha);
  let h = dt * (beta / 2.0 + (second / 6.0 + third / 24.0));
  let q = dt * dt * (beta / 6.0 + second / 24.0);
  let new_q = s.q + q;
  let v = s.y.y + d.y;
  let rate = s.rate + apart.z;
  let gain = h - (db * new_q + s.b * q);
  return vec2(
    d.x + gain * v + (s.h - s.b * s.q) * d.y + q * rate + s.q * apart.z,
    d.y + (da * new_q + s.a * q) * v + s.a * s.q * d.y + h * rate + s.h * apart.z,
  );
}

fn predict(belief: ptr<function, Belief>, force: f32, cell: Cell) -> u32 {
  let dt = settings.dt;
  let y = (*belief).mean;
  let root = lower_root(*belief);
  var columns = array(root.l0, root.l1, root.l2, root.l3);
  let s = step_of(y, force, dt);
  var sum = vec2(0.0);
  var moving = vec3(0.0); // covariance of displacement and velocity: 00, 10, 11
  var cross0 = vec2(0.0); // of displacement with the parameters
  var cross1 = vec2(0.0);
  for (var i = 0u; i < 4u; i++) {
    let column = columns[i];
    let far = column * DISTANCE;
    let high = apart(s, far, dt);
    let low = apart(s, -far, dt);
    let straight = (high - low) * (0.5 / DISTANCE);
    let curved = (high + low) * (0.5 / DISTANCE);
    sum += curved;
    moving += vec3(
      straight.x * straight.x + curved.x * curved.x,
      straight.y * straight.x + curved.y * curved.x,
      straight.y * straight.y + curved.y * curved.y,
    );
    cross0 += column.zw * straight.x;
    cross1 += column.zw * straight.y;
  }
  let shift = sum / DISTANCE;
  moving += vec3(shift.x * shift.x, shift.x * shift.y, shift.y * shift.y);
  (*belief).p0 = vec4(moving.x, moving.y, cross0);
  (*belief).p1 = vec3(moving.z, cross1);
  let forward = vec2((s.h - s.b * s.q) * y.y + s.q * s.rate, s.a * s.q * y.y + s.h * s.rate);
  move_by(belief, vec4(forward + shift, 0.0, 0.0));
  spread(belief, cell);
  return root.reason;
}

// The reading of the acceleration: its covariance with the state, its mean and its variance without noise.
struct Reading {
  cross: vec4<f32>,
  mean: f32,
  variance: f32,
  reason: u32,
}

fn look(belief: Belief, force: f32) -> Reading {
  let weight = 1.0 / (2.0 * SPREAD);
  let root = lower_root(belief);
  var columns = array(root.l0, root.l1, root.l2, root.l3);
  var cross = vec4(0.0);
  var sum = 0.0;
  var square = 0.0;
  for (var i = 0u; i < 4u; i++) {
    let far = columns[i] * DISTANCE;
    let high = rate_apart(belief.mean, far).z;
    let low = rate_apart(belief.mean, -far).z;
    sum += high + low;
    square += high * high + low * low;
    cross += far * (high - low);
  }
  let shift = sum * weight;
  let mean = acceleration(belief.mean, force) + shift;
  return Reading(cross * weight, mean, square * weight + shift * shift, root.reason);
}

// The reading when other sensors have changed the covariance: it has been changed with them.
fn look_again(reading: Reading, belief: Belief) -> Reading {
  return reading;
}

// What the sensor sees is not linear, so that there is no H for Joseph's form.
fn finish_reading(belief: ptr<function, Belief>, reading: Reading, gain: vec4<f32>, noise: f32) {}
