// The update by one sensor after the other, which is the same as by all at once, since their noise is independent.

// The innovations of all sensors, how their readings depend on the state through L, and the variance of their noise.
struct Expected {
  error: array<f32, S>,
  through: array<f32, READ>,
  noise: array<f32, S>,
}

struct Correction {
  nis: f32,
  // det S of all samples is this times two to the power of `exponent`.
  product: f32,
  exponent: i32,
  reason: u32,
}

fn is_present(present: u32, s: u32) -> bool {
  return (present & (1u << s)) != 0u;
}

// Takes an innovation of this variance, which is positive, into NIS and det S.
fn weigh(correction: ptr<function, Correction>, innovation: f32, variance: f32) {
  (*correction).nis += innovation * (innovation / variance);
  let bits = bitcast<u32>(variance);
  let product = (*correction).product * bitcast<f32>((bits & 0x007fffffu) | 0x3f800000u);
  let carries = product >= 2.0;
  (*correction).product = select(product, product * 0.5, carries);
  (*correction).exponent += i32(bits >> 23u) - 127 + select(0, 1, carries);
}

// Conditions the belief on the reading of a sensor, and the readings that are expected of the others. A reading that is missing
// is one that depends on nothing.
//
// Source: Carlson (1973), Fast triangular formulation of the square root filter, AIAA Journal 11.
fn correct(b: ptr<function, Belief>, e: ptr<function, Expected>, correction: ptr<function, Correction>, s: u32, is_there: bool) {
  let noise = select(1.0, (*e).noise[s], is_there);
  let innovation = select(0.0, (*e).error[s], is_there);
  // The factor of each column of L, and of what is taken from it.
  var scale: array<f32, N>;
  var share: array<f32, N>;
  var through: array<f32, N>;
  var variance = noise;
  for (var n = 0u; n < N; n++) {
    let j = N - 1u - n;
    through[j] = select(0.0, (*e).through[s * N + j], is_there);
    let more = variance + through[j] * through[j];
    scale[j] = sqrt(variance / more);
    share[j] = through[j] / variance;
    variance = more;
  }
  if ((*correction).reason == 0u && (!is_positive(noise) || !is_positive(variance))) {
    (*correction).reason = select(NOT_FINITE, SINGULAR, is_finite(variance));
  }
  weigh(correction, innovation, variance);
  let weighted = innovation / variance;
  for (var i = 0u; i < N; i++) {
    var sum = 0.0;
    for (var n = 0u; n <= i; n++) {
      let j = i - n;
      let entry = (*b).root[at(i, j)];
      (*b).root[at(i, j)] = scale[j] * (entry - share[j] * sum);
      sum += through[j] * entry;
    }
    move_by(b, i, sum * weighted);
  }
  for (var later = s + 1u; later < S; later++) {
    var sum = 0.0;
    for (var n = 0u; n < N; n++) {
      let j = N - 1u - n;
      let entry = (*e).through[later * N + j];
      (*e).through[later * N + j] = scale[j] * (entry - share[j] * sum);
      sum += through[j] * entry;
    }
    (*e).error[later] -= sum * weighted;
  }
}

fn update(b: ptr<function, Belief>, sample: ptr<function, Sample>, cell: ptr<function, Cell>, start: Correction) -> Correction {
  var correction = start;
  var e = expect(b, sample, cell);
  for (var s = 0u; s < S; s++) {
    correct(b, &e, &correction, s, is_present((*sample).present, s));
  }
  if (correction.reason == 0u && !(is_valid(b) && is_finite(correction.nis))) {
    correction.reason = NOT_FINITE;
  }
  return correction;
}
