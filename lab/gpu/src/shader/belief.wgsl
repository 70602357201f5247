// A belief in [x, v, wn, zeta]: mean, and the lower triangular root L of the covariance P = L L', column by column. In single
// precision a root keeps what a covariance loses to rounding: P cannot become indefinite, and small variances beside large
// ones stay.
struct Belief {
  mean: vec4<f32>,
  // Rounding of the mean that has not been added yet.
  rest: vec4<f32>,
  l0: vec4<f32>,
  l1: vec3<f32>,
  l2: vec2<f32>,
  l3: f32,
}

const NOT_FINITE = 1u;
const SINGULAR = 2u;

// The variances.
fn variances(b: Belief) -> vec4<f32> {
  let first = b.l0 * b.l0;
  let second = b.l1 * b.l1;
  let third = b.l2 * b.l2;
  return first + vec4(0.0, second) + vec4(0.0, 0.0, third) + vec4(0.0, 0.0, 0.0, b.l3 * b.l3);
}

// L' h
fn through_root(b: Belief, h: vec4<f32>) -> vec4<f32> {
  return vec4(dot(b.l0, h), dot(b.l1, h.yzw), dot(b.l2, h.zw), b.l3 * h.w);
}

// Adds to the mean, with the rounding of earlier additions.
fn move_by(b: ptr<function, Belief>, step: vec4<f32>) {
  let whole = step + (*b).rest;
  let mean = rounded((*b).mean + whole);
  (*b).rest = whole - (mean - (*b).mean);
  (*b).mean = mean;
}

fn is_valid(b: Belief) -> bool {
  return is_finite4(b.mean) && is_finite4(b.l0) && is_finite4(vec4(b.l1, b.l3)) && is_finite(b.l2.x) && is_finite(b.l2.y);
}

// Five entries of a row.
struct Row {
  pivot: f32,
  rest: vec4<f32>,
}

// The reflection of a row to (length, 0): its vector, one over half its square, and the length with a sign.
struct Reflection {
  own: Row,
  inverse: f32,
  length: f32,
}

// Source: Golub and Van Loan (2013), section 5.1.2.
fn reflection(row: Row) -> Reflection {
  let square = row.pivot * row.pivot + dot(row.rest, row.rest);
  // A row of zeros is that of a component that is known for certain.
  if (!is_positive(square)) {
    return Reflection(Row(0.0, vec4(0.0)), 0.0, select(square, row.pivot, is_finite(square)));
  }
  let length = select(-sqrt(square), sqrt(square), row.pivot < 0.0);
  let pivot = row.pivot - length;
  return Reflection(Row(pivot, row.rest), 1.0 / abs(length * pivot), length);
}

// Another row, reflected.
fn reflected(row: Row, r: Reflection) -> Row {
  let share = (r.own.pivot * row.pivot + dot(r.own.rest, row.rest)) * r.inverse;
  return Row(row.pivot - r.own.pivot * share, row.rest - r.own.rest * share);
}

// The next five entries of a row.
fn next(row: Row, more: f32) -> Row {
  return Row(row.rest.x, vec4(row.rest.yzw, more));
}

// Rows of 4.
struct Rows {
  x: vec4<f32>,
  v: vec4<f32>,
  wn: vec4<f32>,
  zeta: vec4<f32>,
}

// Makes L of the rows of an array [A, B] with A A' + B B' = P. Row i has no entry of B after the i-th, so that a reflection
// needs no more than five entries of each row.
fn set_root(b: ptr<function, Belief>, a: Rows, noise: Rows) {
  let r0 = reflection(Row(a.x.x, vec4(a.x.yzw, noise.x.x)));
  let v0 = reflected(Row(a.v.x, vec4(a.v.yzw, noise.v.x)), r0);
  let w0 = reflected(Row(a.wn.x, vec4(a.wn.yzw, noise.wn.x)), r0);
  let z0 = reflected(Row(a.zeta.x, vec4(a.zeta.yzw, noise.zeta.x)), r0);
  let r1 = reflection(next(v0, noise.v.y));
  let w1 = reflected(next(w0, noise.wn.y), r1);
  let z1 = reflected(next(z0, noise.zeta.y), r1);
  let r2 = reflection(next(w1, noise.wn.z));
  let z2 = reflected(next(z1, noise.zeta.z), r2);
  let r3 = reflection(next(z2, noise.zeta.w));
  (*b).l0 = vec4(r0.length, v0.pivot, w0.pivot, z0.pivot);
  (*b).l1 = vec3(r1.length, w1.pivot, z1.pivot);
  (*b).l2 = vec2(r2.length, z2.pivot);
  (*b).l3 = r3.length;
}
