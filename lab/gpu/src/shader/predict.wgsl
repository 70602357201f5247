// From a sample to the next, in one part or several. Noise is added in the last one, and a white force is another one after some
// of them.
fn predict(b: ptr<function, Belief>, before: f32, after: f32, cell: ptr<function, Cell>) {
  let change = select(0.0, after - before, HAS_SLOPE);
  for (var part = 0u; part < PARTS; part += 1u) {
    let is_last = part + 1u == PARTS;
    let begin = before + change * (f32(part) / f32(PARTS));
    let end = before + change * (f32(part + 1u) / f32(PARTS));
    // [A, B] with A A' + B B' = P
    var a: array<f32, SQUARE>;
    var noise: array<f32, TRIANGLE>;
    var fading = 1.0;
    if (is_last) {
      fading = (*cell).fading;
      for (var i = 0u; i < N; i++) {
        noise[at(i, i)] = (*cell).process[i];
      }
    }
    advance(b, vec2(begin, end), settings.dt / f32(PARTS), fading, &a, &noise);
    for (var i = M; i < N; i++) {
      for (var k = 0u; k <= i; k++) {
        a[i * N + k] = (*b).root[at(i, k)] * fading;
      }
    }
    if (part + 1u == RENEWED) {
      renew(b, &a, &noise, WHITE, (*cell).white);
    }
    set_root(b, &a, &noise);
  }
}
