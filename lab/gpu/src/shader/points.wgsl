// Readings by sigma points that are drawn afresh. What is not linear in their distance is noise, which is the same for several
// sensors in part: each sensor is rid of what it has of those before.
fn expect(b: ptr<function, Belief>, sample: ptr<function, Sample>, cell: ptr<function, Cell>) -> Expected {
  let force = (*sample).force;
  var reading = readings((*b).mean, force);
  var e: Expected;
  var noise: array<f32, S * S>;
  var shift: array<f32, S>;
  var columns = columns_of(b);
  for (var j = 0u; j < N; j++) {
    let high = readings_apart((*b).mean, along(&columns, j, DISTANCE), force);
    let low = readings_apart((*b).mean, along(&columns, j, -DISTANCE), force);
    var both: array<f32, S>;
    for (var s = 0u; s < S; s++) {
      e.through[s * N + j] = (high[s] - low[s]) * (0.5 / DISTANCE);
      both[s] = (high[s] + low[s]) * (0.5 / DISTANCE);
      shift[s] += both[s] / DISTANCE;
      for (var other = 0u; other <= s; other++) {
        noise[s * S + other] += both[s] * both[other];
      }
    }
  }
  for (var s = 0u; s < S; s++) {
    e.error[s] = (*sample).measured[s] - reading[s] - shift[s];
    for (var other = 0u; other <= s; other++) {
      noise[s * S + other] += OFFSET * shift[s] * shift[other];
    }
    noise[s * S + s] += (*cell).noise[s];
  }
  for (var s = 0u; s < S; s++) {
    e.noise[s] = noise[s * S + s];
    for (var later = s + 1u; later < S; later++) {
      let share = select(0.0, noise[later * S + s] / noise[s * S + s], is_present((*sample).present, s));
      e.error[later] -= share * e.error[s];
      for (var j = 0u; j < N; j++) {
        e.through[later * N + j] -= share * e.through[s * N + j];
      }
      for (var other = s + 1u; other <= later; other++) {
        noise[later * S + other] -= share * noise[other * S + s];
      }
    }
  }
  return e;
}
