// Readings that are linear, or linearised at the prediction.
fn expect(b: ptr<function, Belief>, k: u32, run: u32) -> Expected {
  let force = samples[k].force;
  var reading = readings((*b).mean, force);
  var by = readings_by((*b).mean, force);
  var e: Expected;
  e.noise = cells[run].noise;
  for (var s = 0u; s < S; s++) {
    e.error[s] = samples[k].measured[s] - reading[s];
    for (var j = 0u; j < N; j++) {
      e.error[s] -= by[s * N + j] * (*b).rest[j];
      var sum = 0.0;
      for (var i = j; i < N; i++) {
        sum += by[s * N + i] * (*b).root[at(i, j)];
      }
      e.through[s * N + j] = sum;
    }
  }
  return e;
}
