// KF and EKF. The rows of the derivative of a step, of which the others are those of an identity, and how the mean moves.
struct Flow {
  rows: array<f32, BY>,
  shift: array<f32, M>,
}

fn advance(
  b: ptr<function, Belief>,
  forces: vec2<f32>,
  dt: f32,
  fading: f32,
  a: ptr<function, array<f32, SQUARE>>,
  noise: ptr<function, array<f32, TRIANGLE>>,
) {
  var flow = flow_of((*b).mean, forces, dt);
  for (var i = 0u; i < M; i++) {
    move_by(b, i, flow.shift[i]);
    for (var j = 0u; j < N; j++) {
      var sum = 0.0;
      for (var k = j; k < N; k++) {
        sum += flow.rows[i * N + k] * (*b).root[at(k, j)];
      }
      (*a)[i * N + j] = sum * fading;
    }
  }
}

// The effect of a slope of the recorded force on what moves, and on its derivative by the input gain.
fn feel(flow: ptr<function, Flow>, y: array<f32, N>, effect: array<f32, M>) {
  var own = effect;
  var state = y;
  for (var i = 0u; i < M; i++) {
    (*flow).shift[i] += own[i] * select(1.0, state[min(GAIN, N - 1u)], GAIN < N);
    (*flow).rows[i * N + min(GAIN, N - 1u)] += select(0.0, own[i], GAIN < N);
  }
}
