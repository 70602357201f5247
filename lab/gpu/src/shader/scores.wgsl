// The sums of the scores.

// An estimate has settled when its error is at most this share of the truth.
const SETTLED = 0.05;

// Takes in the belief at sample k, of which the truth is known.
fn compare(state: ptr<function, State>, belief: Belief, truth: vec4<f32>, k: u32) {
  // A negative natural frequency is the same oscillator as its mirror image.
  let own = select(truth, vec4(truth.xy, -truth.zw), is_negative(belief.mean.z));
  let error = (belief.mean - own) + belief.rest;
  let square = error * error;
  (*state).squares[1] += square;
  (*state).inside += vec4<u32>(square <= 4.0 * diagonal(belief));
  (*state).settled = select(vec4(k + 1u), (*state).settled, abs(error) <= SETTLED * abs(truth));
  if (k >= settings.recent) {
    (*state).recent[1] += square;
  }
  add_nees(state, belief, error);
}

// Adds e' P^-1 e over the components of positive variance, where P is positive definite.
fn add_nees(state: ptr<function, State>, belief: Belief, error: vec4<f32>) {
  let variance = diagonal(belief);
  let smallest = 16.0 * EPSILON * variance;
  let counts = vec4(is_positive(variance.x), is_positive(variance.y), is_positive(variance.z), is_positive(variance.w));
  let i0 = select(0.0, 1.0 / variance.x, counts.x);
  let l0 = belief.p0.yzw * i0;
  let p1 = belief.p1 - l0 * belief.p0.y;
  let i1 = select(0.0, 1.0 / p1.x, counts.y);
  let l1 = p1.yz * i1;
  let p2 = belief.p2 - l0.yz * belief.p0.z - l1 * p1.y;
  let i2 = select(0.0, 1.0 / p2.x, counts.z);
  let l2 = p2.y * i2;
  let p3 = belief.p3 - l0.z * belief.p0.w - l1.y * p1.z - l2 * p2.y;
  let i3 = select(0.0, 1.0 / p3, counts.w);
  let e1 = error.y - l0.x * error.x;
  let e2 = error.z - l0.y * error.x - l1.x * e1;
  let e3 = error.w - l0.z * error.x - l1.y * e1 - l2 * e2;
  let whole = vec4(variance.x, p1.x, p2.x, p3) > smallest;
  let sum = error.x * error.x * i0 + e1 * e1 * i1 + e2 * e2 * i2 + e3 * e3 * i3;
  if (all(whole | !counts) && any(counts) && is_finite(sum)) {
    (*state).sums.w += sum;
    (*state).nees_degrees += countOneBits(dot(vec4<u32>(counts), vec4(1u, 2u, 4u, 8u)));
    (*state).nees_samples += 1u;
  }
}

// Adds the sums of the last few samples to those before.
fn gather(state: ptr<function, State>) {
  (*state).squares[0] += (*state).squares[1];
  (*state).squares[1] = vec4(0.0);
  (*state).recent[0] += (*state).recent[1];
  (*state).recent[1] = vec4(0.0);
  (*state).sums = vec4((*state).sums.xy + (*state).sums.zw, 0.0, 0.0);
}
