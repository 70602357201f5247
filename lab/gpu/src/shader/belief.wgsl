// A belief in [x, v, wn, zeta]: mean, and the lower triangle of the covariance, column by column.
struct Belief {
  mean: vec4<f32>,
  rest: vec4<f32>,
  p0: vec4<f32>,
  p1: vec3<f32>,
  p2: vec2<f32>,
  p3: f32,
}

fn diagonal(b: Belief) -> vec4<f32> {
  return vec4(b.p0.x, b.p1.x, b.p2.x, b.p3);
}

// P h
fn times(b: Belief, h: vec4<f32>) -> vec4<f32> {
  return vec4(
    dot(b.p0, h),
    b.p0.y * h.x + dot(b.p1, h.yzw),
    b.p0.z * h.x + b.p1.y * h.y + dot(b.p2, h.zw),
    b.p0.w * h.x + b.p1.z * h.y + b.p2.y * h.z + b.p3 * h.w,
  );
}

// Adds to the mean, with the rounding of earlier additions.
fn move_by(b: ptr<function, Belief>, step: vec4<f32>) {
  let whole = step + (*b).rest;
  let mean = (*b).mean + whole;
  (*b).rest = whole - (mean - (*b).mean);
  (*b).mean = mean;
}

// P - u v', which must be symmetric but for rounding: its lower triangle counts.
fn subtract(b: ptr<function, Belief>, u: vec4<f32>, v: vec4<f32>) {
  (*b).p0 -= u * v.x;
  (*b).p1 -= u.yzw * v.y;
  (*b).p2 -= u.zw * v.z;
  (*b).p3 -= u.w * v.w;
}

// lambda P + Q. A variance that is zero but for rounding may have come out on the wrong side.
fn spread(b: ptr<function, Belief>, cell: Cell) {
  (*b).p0 *= cell.fading;
  (*b).p1 *= cell.fading;
  (*b).p2 *= cell.fading;
  (*b).p3 *= cell.fading;
  (*b).p0.x = select((*b).p0.x + cell.process.x, 0.0, is_negative((*b).p0.x + cell.process.x));
  (*b).p1.x = select((*b).p1.x + cell.process.y, 0.0, is_negative((*b).p1.x + cell.process.y));
  (*b).p2.x = select((*b).p2.x + cell.process.z, 0.0, is_negative((*b).p2.x + cell.process.z));
  (*b).p3 = select((*b).p3 + cell.process.w, 0.0, is_negative((*b).p3 + cell.process.w));
}

// Why the belief cannot be one, 0 if it can.
fn fault(b: Belief) -> u32 {
  if (!(is_finite4(b.mean) && is_finite4(b.p0) && is_finite4(vec4(b.p1, b.p3)) && is_finite(b.p2.x) && is_finite(b.p2.y))) {
    return NOT_FINITE;
  }
  if (is_negative(b.p0.x) || is_negative(b.p1.x) || is_negative(b.p2.x) || is_negative(b.p3)) {
    return INDEFINITE;
  }
  return 0u;
}

const NOT_FINITE = 1u;
const INDEFINITE = 2u;
const SINGULAR = 3u;
