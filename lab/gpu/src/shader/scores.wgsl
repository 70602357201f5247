// The sums of the scores.

// An estimate has settled when its error is at most this share of the truth.
const SETTLED = 0.05;

// Limits a pivot, as a share of the standard deviation: a smaller one is zero to rounding.
const SMALLEST = 1e-7;

// Takes in the belief at sample k.
fn compare(state: ptr<function, State>, b: ptr<function, Belief>, sample: ptr<function, Sample>, k: u32) {
  // A negative natural frequency is the same oscillator as its mirror image.
  let is_mirrored = MIRRORED != 0u && is_negative((*b).mean[FREQUENCY]);
  var error: array<f32, K>;
  for (var i = 0u; i < K; i++) {
    let truth = (*sample).truth[i];
    let own = select(truth, -truth, is_mirrored && ((MIRRORED >> i) & 1u) != 0u);
    error[i] = ((*b).mean[i] - own) + (*b).rest[i];
    let square = error[i] * error[i];
    let tracked = &(*state).tracked[i];
    (*tracked).few_squares += square;
    (*tracked).inside += u32(square <= 4.0 * variance(b, i));
    (*tracked).settled = select(k + 1u, (*tracked).settled, abs(error[i]) <= SETTLED * abs(truth));
    (*tracked).few_recent += select(0.0, square, k >= settings.recent);
  }
  add_nees(state, b, error);
}

// Adds e' P^-1 e over the components of positive variance, where P is positive definite.
fn add_nees(state: ptr<function, State>, b: ptr<function, Belief>, all: array<f32, K>) {
  var error = all;
  var sum = 0.0;
  var degrees = 0u;
  var is_whole = true;
  // L^-1 e
  var white: array<f32, K>;
  for (var i = 0u; i < K; i++) {
    let size = variance(b, i);
    let pivot = (*b).root[at(i, i)];
    let counts = is_positive(size);
    let is_own_whole = abs(pivot) > SMALLEST * sqrt(size);
    for (var j = 0u; j < i; j++) {
      error[i] -= (*b).root[at(i, j)] * white[j];
    }
    white[i] = select(0.0, error[i] / pivot, counts && is_own_whole);
    sum += white[i] * white[i];
    is_whole = is_whole && (is_own_whole || !counts);
    degrees += select(0u, 1u, counts);
  }
  if (is_whole && degrees > 0u && is_finite(sum)) {
    (*state).few_nees += sum;
    (*state).nees_degrees += degrees;
    (*state).nees_samples += 1u;
  }
}

// Adds the sums of the last few samples to those before.
fn gather(state: ptr<function, State>) {
  for (var i = 0u; i < K; i++) {
    let tracked = &(*state).tracked[i];
    (*tracked).squares += (*tracked).few_squares;
    (*tracked).few_squares = 0.0;
    (*tracked).recent += (*tracked).few_recent;
    (*tracked).few_recent = 0.0;
  }
  (*state).nis += (*state).few_nis;
  (*state).few_nis = 0.0;
  (*state).nees += (*state).few_nees;
  (*state).few_nees = 0.0;
}
