// The update by one sensor after the other, which is the same as by all at once: their noise is independent, and the
// acceleration's reading is linearised, or sampled, before the first of them.

struct Correction {
  nis: f32,
  product: f32,
  exponent: i32,
  reason: u32,
}

// Takes an innovation of this variance into NIS and det S. The variance must be positive.
fn weigh(correction: ptr<function, Correction>, innovation: f32, variance: f32) {
  (*correction).nis += innovation * (innovation / variance);
  let bits = bitcast<u32>(variance);
  let product = (*correction).product * bitcast<f32>((bits & 0x007fffffu) | 0x3f800000u);
  let carries = product >= 2.0;
  (*correction).product = select(product, product * 0.5, carries);
  (*correction).exponent += i32(bits >> 23u) - 127 + select(0, 1, carries);
}

// By a sensor of displacement (0) or velocity (1), in Joseph's form.
fn correct(
  belief: ptr<function, Belief>,
  reading: ptr<function, Reading>,
  correction: ptr<function, Correction>,
  component: u32,
  measured: f32,
  noise: f32,
) {
  let is_first = component == 0u;
  let cross = select(vec4((*belief).p0.y, (*belief).p1), (*belief).p0, is_first);
  let variance = select((*belief).p1.x, (*belief).p0.x, is_first) + noise;
  if (!is_positive(variance)) {
    (*correction).reason = SINGULAR;
    return;
  }
  let gain = cross / variance;
  let innovation = measured - select((*belief).mean.y, (*belief).mean.x, is_first);
  weigh(correction, innovation, variance);
  let seen = select((*reading).cross.y, (*reading).cross.x, is_first);
  (*reading).mean += seen / variance * innovation;
  (*reading).variance -= seen / variance * seen;
  (*reading).cross -= gain * seen;
  move_by(belief, gain * innovation);
  subtract(belief, cross, gain);
  let kept = select(vec4((*belief).p0.y, (*belief).p1), (*belief).p0, is_first);
  subtract(belief, kept - gain * noise, gain);
}

fn correct_by_acceleration(
  belief: ptr<function, Belief>,
  before: Reading,
  correction: ptr<function, Correction>,
  measured: f32,
  noise: f32,
) {
  let reading = look_again(before, *belief);
  let variance = reading.variance + noise;
  if (!is_positive(variance)) {
    (*correction).reason = SINGULAR;
    return;
  }
  let gain = reading.cross / variance;
  let innovation = measured - reading.mean;
  weigh(correction, innovation, variance);
  move_by(belief, gain * innovation);
  subtract(belief, reading.cross, gain);
  finish_reading(belief, reading, gain, noise);
}

fn update(belief: ptr<function, Belief>, sample: Sample, cell: Cell, start: Correction) -> Correction {
  var correction = start;
  var reading: Reading;
  if ((sample.present & 4u) != 0u && correction.reason == 0u) {
    reading = look(*belief, sample.force);
    correction.reason = reading.reason;
  }
  if ((sample.present & 1u) != 0u && correction.reason == 0u) {
    correct(belief, &reading, &correction, 0u, sample.measured.x, cell.noise.x);
  }
  if ((sample.present & 2u) != 0u && correction.reason == 0u) {
    correct(belief, &reading, &correction, 1u, sample.measured.y, cell.noise.y);
  }
  if ((sample.present & 4u) != 0u && correction.reason == 0u) {
    correct_by_acceleration(belief, reading, &correction, sample.measured.z, cell.noise.z);
  }
  if (correction.reason == 0u) {
    correction.reason = select(fault(*belief), NOT_FINITE, !is_finite(correction.nis));
  }
  return correction;
}
