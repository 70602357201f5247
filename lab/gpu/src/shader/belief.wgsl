const NOT_FINITE = 1u;
const SINGULAR = 2u;

// The place of an entry of a lower triangle, row by row.
fn at(row: u32, column: u32) -> u32 {
  return row * (row + 1u) / 2u + column;
}

fn variance(b: ptr<function, Belief>, row: u32) -> f32 {
  var sum = 0.0;
  for (var k = 0u; k <= row; k++) {
    let entry = (*b).root[at(row, k)];
    sum += entry * entry;
  }
  return sum;
}

// Adds to a component of the mean, with the rounding of earlier additions.
fn move_by(b: ptr<function, Belief>, i: u32, step: f32) {
  let whole = step + (*b).rest[i];
  let mean = rounded((*b).mean[i] + whole);
  (*b).rest[i] = whole - (mean - (*b).mean[i]);
  (*b).mean[i] = mean;
}

fn is_valid(b: ptr<function, Belief>) -> bool {
  var valid = true;
  for (var i = 0u; i < N; i++) {
    valid = valid && is_finite((*b).mean[i]);
  }
  for (var i = 0u; i < TRIANGLE; i++) {
    valid = valid && is_finite((*b).root[i]);
  }
  return valid;
}

// Makes L of the rows of an array [A, B] with A A' + B B' = P, by reflections. Row i of B has no entry after the i-th, so that a
// reflection needs no more than N + 1 entries of each row.
//
// Source: Golub and Van Loan (2013), section 5.1.2.
fn set_root(b: ptr<function, Belief>, a: ptr<function, array<f32, SQUARE>>, noise: ptr<function, array<f32, TRIANGLE>>) {
  for (var j = 0u; j < N; j++) {
    let pivot = (*a)[j * N + j];
    var square = pivot * pivot;
    for (var k = j + 1u; k < N; k++) {
      square += (*a)[j * N + k] * (*a)[j * N + k];
    }
    for (var k = 0u; k <= j; k++) {
      square += (*noise)[at(j, k)] * (*noise)[at(j, k)];
    }
    // A row of zeros is that of a component that is known for certain.
    let is_there = is_positive(square);
    let far = select(-sqrt(square), sqrt(square), pivot < 0.0);
    let length = select(select(square, pivot, is_finite(square)), far, is_there);
    let head = select(0.0, pivot - far, is_there);
    let inverse = select(0.0, 1.0 / abs(far * head), is_there);
    for (var i = j + 1u; i < N; i++) {
      var share = head * (*a)[i * N + j];
      for (var k = j + 1u; k < N; k++) {
        share += (*a)[j * N + k] * (*a)[i * N + k];
      }
      for (var k = 0u; k <= j; k++) {
        share += (*noise)[at(j, k)] * (*noise)[at(i, k)];
      }
      share *= inverse;
      (*a)[i * N + j] -= head * share;
      for (var k = j + 1u; k < N; k++) {
        (*a)[i * N + k] -= (*a)[j * N + k] * share;
      }
      for (var k = 0u; k <= j; k++) {
        (*noise)[at(i, k)] -= (*noise)[at(j, k)] * share;
      }
    }
    (*b).root[at(j, j)] = length;
    for (var i = j + 1u; i < N; i++) {
      (*b).root[at(i, j)] = (*a)[i * N + j];
    }
  }
}

// Replaces a component by a new one of mean zero that knows nothing of the others, in the rows from which L will be made.
fn renew(
  b: ptr<function, Belief>,
  a: ptr<function, array<f32, SQUARE>>,
  noise: ptr<function, array<f32, TRIANGLE>>,
  i: u32,
  deviation: f32,
) {
  (*b).mean[i] = 0.0;
  (*b).rest[i] = 0.0;
  for (var k = 0u; k < N; k++) {
    (*a)[i * N + k] = 0.0;
  }
  for (var k = 0u; k < i; k++) {
    (*noise)[at(i, k)] = 0.0;
  }
  (*noise)[at(i, i)] = deviation;
}
