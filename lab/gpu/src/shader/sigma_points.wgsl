// UKF and CKF: sigma points, each moved by one Runge-Kutta step. Points are held as deviations from the mean, and moved by what
// the step makes of deviations: the difference of two steps would lose most of its digits.

// The columns of L as deviations, one after the other. Loops over them are not written out, so that a program has a step once.
fn columns_of(b: ptr<function, Belief>) -> array<f32, SQUARE> {
  var columns: array<f32, SQUARE>;
  for (var i = 0u; i < N; i++) {
    for (var j = 0u; j <= i; j++) {
      columns[j * N + i] = (*b).root[at(i, j)];
    }
  }
  return columns;
}

// A deviation along a column.
fn along(columns: ptr<function, array<f32, SQUARE>>, j: u32, length: f32) -> array<f32, N> {
  var deviation: array<f32, N>;
  for (var i = 0u; i < N; i++) {
    deviation[i] = (*columns)[j * N + i] * length;
  }
  return deviation;
}

// The share of a step after which a stage is.
fn after(stage: u32) -> f32 {
  return select(select(0.5, 1.0, stage == 3u), 0.0, stage == 0u);
}

fn weight(stage: u32) -> f32 {
  return select(1.0 / 3.0, 1.0 / 6.0, stage == 0u || stage == 3u);
}

// How a deviation of what moves changes over the step with these stages.
fn moved(stages: ptr<function, array<array<f32, N>, 4>>, deviation: array<f32, N>, forces: vec2<f32>, dt: f32) -> array<f32, M> {
  var rate: array<f32, M>;
  var change: array<f32, M>;
  for (var s = 0u; s < 4u; s += 1u) {
    var d = deviation;
    for (var i = 0u; i < M; i++) {
      d[i] += after(s) * dt * rate[i];
    }
    rate = rates_apart((*stages)[s], d, mix(forces.x, forces.y, after(s)));
    for (var i = 0u; i < M; i++) {
      change[i] += weight(s) * dt * rate[i];
    }
  }
  return change;
}

// The points' images are held as a root of their covariance: half the differences of opposite points, and, of what is not linear
// in the distance, sums and shift.
fn advance(
  b: ptr<function, Belief>,
  forces: vec2<f32>,
  dt: f32,
  fading: f32,
  a: ptr<function, array<f32, SQUARE>>,
  noise: ptr<function, array<f32, TRIANGLE>>,
) {
  var stages: array<array<f32, N>, 4>;
  var forward: array<f32, M>;
  var rate: array<f32, M>;
  for (var s = 0u; s < 4u; s += 1u) {
    var y = (*b).mean;
    for (var i = 0u; i < M; i++) {
      y[i] += after(s) * dt * rate[i];
    }
    rate = rates(y, mix(forces.x, forces.y, after(s)));
    for (var i = 0u; i < M; i++) {
      forward[i] += weight(s) * dt * rate[i];
    }
    stages[s] = y;
  }
  // Half the differences of opposite points, and of their sums, column by column.
  var columns = columns_of(b);
  var odd: array<f32, BY>;
  var even: array<f32, BY>;
  for (var j = 0u; j < N; j += 1u) {
    for (var side = 0u; side < 2u; side += 1u) {
      let sign = 1.0 - 2.0 * f32(side);
      let change = moved(&stages, along(&columns, j, sign * DISTANCE), forces, dt);
      for (var i = 0u; i < M; i++) {
        odd[j * M + i] += sign * change[i] * (0.5 / DISTANCE);
        even[j * M + i] += change[i] * (0.5 / DISTANCE);
      }
    }
  }
  // Rows of what is added to P: what points make that is not linear in their distance, its sum, and the process noise.
  var curved: array<f32, M * WIDTH>;
  var shift: array<f32, M>;
  for (var i = 0u; i < M; i++) {
    for (var j = 0u; j < N; j++) {
      (*a)[i * N + j] = (columns[j * N + i] + odd[j * M + i]) * fading;
      curved[i * WIDTH + j] = even[j * M + i] * fading;
      shift[i] += even[j * M + i] / DISTANCE;
    }
  }
  for (var i = 0u; i < M; i++) {
    move_by(b, i, forward[i] + shift[i]);
    if (OFFSET < 0.0) {
      for (var j = 0u; j < N; j++) {
        curved[i * WIDTH + j] -= shift[i] / DISTANCE * fading;
      }
    } else {
      curved[i * WIDTH + N] = shift[i] * fading;
    }
    curved[i * WIDTH + N + 1u + i] = (*noise)[at(i, i)];
  }
  // The rows are made lower triangular.
  for (var i = 0u; i < M; i++) {
    var square = 0.0;
    for (var k = 0u; k < WIDTH; k++) {
      square += curved[i * WIDTH + k] * curved[i * WIDTH + k];
    }
    let is_there = is_positive(square);
    let length = select(select(square, 0.0, is_finite(square)), sqrt(square), is_there);
    (*noise)[at(i, i)] = length;
    for (var other = i + 1u; other < M; other++) {
      var share = 0.0;
      for (var k = 0u; k < WIDTH; k++) {
        share += curved[i * WIDTH + k] * curved[other * WIDTH + k];
      }
      share = select(0.0, share / square, is_there);
      (*noise)[at(other, i)] = length * share;
      for (var k = 0u; k < WIDTH; k++) {
        curved[other * WIDTH + k] -= curved[i * WIDTH + k] * share;
      }
    }
  }
}
