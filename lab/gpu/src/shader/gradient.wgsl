// Readings that are linear, or linearised at the prediction.
fn expect(b: ptr<function, Belief>, sample: ptr<function, Sample>, cell: ptr<function, Cell>) -> Expected {
  let force = (*sample).force;
  var reading = readings((*b).mean, force);
  let by = readings_by((*b).mean, force);
  var rest = readings_of_rest(b, by);
  var e: Expected;
  e.through = readings_through(b, by);
  e.noise = (*cell).noise;
  for (var s = 0u; s < S; s++) {
    e.error[s] = (*sample).measured[s] - reading[s] - rest[s];
  }
  return e;
}
