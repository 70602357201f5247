// The update by one sensor after the other, which is the same as by all at once, since their noise is independent: first the
// acceleration, whose reading is linearised, or sampled, at the prediction.

struct Correction {
  nis: f32,
  // det S of all samples is this times two to the power of `exponent`.
  product: f32,
  exponent: i32,
  reason: u32,
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

// Conditions the belief on a reading that is `through` the root and has noise of a positive variance.
//
// Source: Carlson (1973), Fast triangular formulation of the square root filter, AIAA Journal 11.
fn correct(
  belief: ptr<function, Belief>,
  correction: ptr<function, Correction>,
  through: vec4<f32>,
  noise: f32,
  innovation: f32,
) {
  let squares = through * through;
  let a3 = noise + squares.w;
  let a2 = a3 + squares.z;
  let a1 = a2 + squares.y;
  let variance = a1 + squares.x;
  if (!is_positive(noise) || !is_positive(variance)) {
    (*correction).reason = select(NOT_FINITE, SINGULAR, is_finite(variance));
    return;
  }
  weigh(correction, innovation, variance);
  let l0 = (*belief).l0;
  let l1 = (*belief).l1;
  let l2 = (*belief).l2;
  let l3 = (*belief).l3;
  let c3 = through.w * l3;
  let c2 = through.z * l2 + vec2(0.0, c3);
  let c1 = through.y * l1 + vec3(0.0, c2);
  let c0 = through.x * l0 + vec4(0.0, c1);
  (*belief).l3 = sqrt(noise / a3) * l3;
  (*belief).l2 = sqrt(a3 / a2) * (l2 - through.z / a3 * vec2(0.0, c3));
  (*belief).l1 = sqrt(a2 / a1) * (l1 - through.y / a2 * vec3(0.0, c2));
  (*belief).l0 = sqrt(a1 / variance) * (l0 - through.x / a1 * vec4(0.0, c1));
  move_by(belief, c0 * (innovation / variance));
}

fn update(belief: ptr<function, Belief>, sample: Sample, cell: Cell, start: Correction) -> Correction {
  var correction = start;
  if ((sample.present & 4u) != 0u) {
    let reading = look(*belief, sample.force);
    let noise = reading.variance + cell.noise.z;
    correct(belief, &correction, reading.through, noise, sample.measured.z - reading.mean);
  }
  if ((sample.present & 1u) != 0u && correction.reason == 0u) {
    let through = vec4((*belief).l0.x, 0.0, 0.0, 0.0);
    correct(belief, &correction, through, cell.noise.x, sample.measured.x - (*belief).mean.x - (*belief).rest.x);
  }
  if ((sample.present & 2u) != 0u && correction.reason == 0u) {
    let through = vec4((*belief).l0.y, (*belief).l1.x, 0.0, 0.0);
    correct(belief, &correction, through, cell.noise.y, sample.measured.y - (*belief).mean.y - (*belief).rest.y);
  }
  if (correction.reason == 0u && !(is_valid(*belief) && is_finite(correction.nis))) {
    correction.reason = NOT_FINITE;
  }
  return correction;
}
