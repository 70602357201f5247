// UKF: sigma points, each moved by one Runge-Kutta step. Points are held as deviations from the mean, and moved by what the
// step makes of deviations: the difference of two steps would lose most of its digits.

// The square of the points' distance in standard deviations.
const SPREAD = 3.0;
const DISTANCE = 1.7320508;

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

fn columns_of(b: Belief) -> array<vec4<f32>, 4> {
  return array(b.l0, vec4(0.0, b.l1), vec4(0.0, 0.0, b.l2), vec4(0.0, 0.0, 0.0, b.l3));
}

// The points' images are held as a root of their covariance: half the differences of opposite points, and, of what is not
// linear in the distance, displacement's and velocity's sums and shift.
fn predict(belief: ptr<function, Belief>, force: f32, cell: Cell) {
  let dt = settings.dt;
  let y = (*belief).mean;
  var columns = columns_of(*belief);
  let s = step_of(y, force, dt);
  var straight: array<vec2<f32>, 4>;
  var curved: array<vec2<f32>, 4>;
  for (var i = 0u; i < 4u; i++) {
    let far = columns[i] * DISTANCE;
    let high = apart(s, far, dt);
    let low = apart(s, -far, dt);
    straight[i] = (high - low) * (0.5 / DISTANCE);
    curved[i] = (high + low) * (0.5 / DISTANCE);
  }
  let shift = (curved[0] + curved[1] + curved[2] + curved[3]) / DISTANCE;
  let forward = vec2((s.h - s.b * s.q) * y.y + s.q * s.rate, s.a * s.q * y.y + s.h * s.rate);
  move_by(belief, vec4(forward + shift, 0.0, 0.0));
  let fading = cell.fading;
  let rows = Rows(
    vec4(straight[0].x, straight[1].x, straight[2].x, straight[3].x) * fading,
    vec4(straight[0].y, straight[1].y, straight[2].y, straight[3].y) * fading,
    vec4(columns[0].z, columns[1].z, columns[2].z, 0.0) * fading,
    vec4(columns[0].w, columns[1].w, columns[2].w, columns[3].w) * fading,
  );
  // Two rows of seven, made lower triangular.
  let x = vec4(curved[0].x, curved[1].x, curved[2].x, curved[3].x) * fading;
  let v = vec4(curved[0].y, curved[1].y, curved[2].y, curved[3].y) * fading;
  let more_x = vec3(shift.x * fading, cell.process.x, 0.0);
  let more_v = vec3(shift.y * fading, 0.0, cell.process.y);
  let square = dot(x, x) + dot(more_x, more_x);
  let is_there = is_positive(square);
  let share = select(0.0, (dot(x, v) + dot(more_x, more_v)) / square, is_there);
  let own_v = v - x * share;
  let own_more = more_v - more_x * share;
  let length = select(0.0, sqrt(square), is_there);
  set_root(belief, rows, Rows(
    vec4(length, 0.0, 0.0, 0.0),
    vec4(length * share, sqrt(dot(own_v, own_v) + dot(own_more, own_more)), 0.0, 0.0),
    vec4(0.0, 0.0, cell.process.z, 0.0),
    vec4(0.0, 0.0, 0.0, cell.process.w),
  ));
}

// The expected acceleration, its dependence on the state through L, and the variance that it has besides: that of what is not
// linear.
struct Reading {
  mean: f32,
  through: vec4<f32>,
  variance: f32,
}

fn look(belief: Belief, force: f32) -> Reading {
  var columns = columns_of(belief);
  var through: vec4<f32>;
  var sum = 0.0;
  var square = 0.0;
  for (var i = 0u; i < 4u; i++) {
    let far = columns[i] * DISTANCE;
    let high = rate_apart(belief.mean, far).z;
    let low = rate_apart(belief.mean, -far).z;
    through[i] = (high - low) * (0.5 / DISTANCE);
    sum += high + low;
    square += (high + low) * (high + low);
  }
  let shift = sum / (2.0 * SPREAD);
  return Reading(acceleration(belief.mean, force) + shift, through, square / (4.0 * SPREAD) + shift * shift);
}
