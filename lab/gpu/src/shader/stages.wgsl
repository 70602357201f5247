// Steps of Euler, or of Runge and Kutta, with their derivative by the state that they start from: the chain rule, stage by stage.
fn flow_of(y: array<f32, N>, forces: vec2<f32>, dt: f32) -> Flow {
  var flow: Flow;
  for (var i = 0u; i < M; i++) {
    flow.rows[i * N + i] = 1.0;
  }
  var rate: array<f32, M>;
  var slope: array<f32, BY>;
  for (var s = 0u; s < STAGES; s += 1u) {
    let after = dt * select(select(0.5, 1.0, s == 3u), 0.0, s == 0u);
    let counts = dt * select(select(1.0 / 3.0, 1.0 / 6.0, s == 0u || s == 3u), 1.0, STAGES == 1u);
    var stage = y;
    for (var i = 0u; i < M; i++) {
      stage[i] += after * rate[i];
    }
    let force = mix(forces.x, forces.y, after / dt);
    rate = rates(stage, force);
    var by = rates_by(stage, force);
    var next = by;
    for (var i = 0u; i < M; i++) {
      for (var j = 0u; j < N; j++) {
        var sum = 0.0;
        for (var k = 0u; k < M; k++) {
          sum += by[i * N + k] * slope[k * N + j];
        }
        next[i * N + j] += after * sum;
      }
    }
    slope = next;
    for (var i = 0u; i < M; i++) {
      flow.shift[i] += counts * rate[i];
    }
    for (var i = 0u; i < BY; i++) {
      flow.rows[i] += counts * slope[i];
    }
  }
  return flow;
}
