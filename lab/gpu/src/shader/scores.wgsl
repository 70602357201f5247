// The sums of the scores.

// An estimate has settled when its error is at most this share of the truth.
const SETTLED = 0.05;

// Limits a pivot, as a share of the standard deviation: a smaller one is zero to rounding.
const SMALLEST = 1e-7;

// Takes in the belief at sample k, of which the truth is known.
fn compare(state: ptr<function, State>, belief: Belief, truth: vec4<f32>, k: u32) {
  // A negative natural frequency is the same oscillator as its mirror image.
  let own = select(truth, vec4(truth.xy, -truth.zw), is_negative(belief.mean.z));
  let error = (belief.mean - own) + belief.rest;
  let square = error * error;
  (*state).squares[1] += square;
  let variance = variances(belief);
  (*state).inside += vec4<u32>(square <= 4.0 * variance);
  (*state).settled = select(vec4(k + 1u), (*state).settled, abs(error) <= SETTLED * abs(truth));
  if (k >= settings.recent) {
    (*state).recent[1] += square;
  }
  add_nees(state, belief, variance, error);
}

// Adds e' P^-1 e over the components of positive variance, where P is positive definite.
fn add_nees(state: ptr<function, State>, belief: Belief, variance: vec4<f32>, error: vec4<f32>) {
  let pivot = vec4(belief.l0.x, belief.l1.x, belief.l2.x, belief.l3);
  let counts = vec4(is_positive(variance.x), is_positive(variance.y), is_positive(variance.z), is_positive(variance.w));
  let is_whole = abs(pivot) > SMALLEST * sqrt(variance);
  let i = select(vec4(0.0), 1.0 / pivot, counts & is_whole);
  // L^-1 e
  let w0 = error.x * i.x;
  let w1 = (error.y - belief.l0.y * w0) * i.y;
  let w2 = (error.z - belief.l0.z * w0 - belief.l1.y * w1) * i.z;
  let w3 = (error.w - belief.l0.w * w0 - belief.l1.z * w1 - belief.l2.y * w2) * i.w;
  let sum = w0 * w0 + w1 * w1 + w2 * w2 + w3 * w3;
  if (all(is_whole | !counts) && any(counts) && is_finite(sum)) {
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
