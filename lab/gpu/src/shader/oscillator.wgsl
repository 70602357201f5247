// Local linearisation of an oscillator x'' = F + a x + b v + ..., in closed form.

// h'' = a h + b h', h(0) = 0, h'(0) = 1, q, its integral, and p, that of q: as the core has it, with fewer terms.
fn response(a: f32, b: f32, dt: f32) -> vec3<f32> {
  let size = max(sqrt(abs(a)), abs(b)) * dt;
  var doublings = 0u;
  if (size > 0.25) {
    // A step that is too long to halve gives no finite number anyway.
    doublings = u32(clamp(ceil(log2(4.0 * size)), 0.0, 64.0));
  }
  var t = dt * exp2(-f32(doublings));
  let alpha = a * t * t;
  let beta = b * t;
  let c2 = beta * beta + alpha;
  let c3 = beta * c2 + alpha * beta;
  let c4 = beta * c3 + alpha * c2;
  let c5 = beta * c4 + alpha * c3;
  let c6 = beta * c5 + alpha * c4;
  let c7 = beta * c6 + alpha * c5;
  var h = t * (1.0 + (beta / 2.0 + (c2 / 6.0 + (c3 / 24.0 + (c4 / 120.0 + (c5 / 720.0 + (c6 / 5040.0 + c7 / 40320.0)))))));
  var q = t * t * (0.5 + (beta / 6.0 + (c2 / 24.0 + (c3 / 120.0 + (c4 / 720.0 + (c5 / 5040.0 + (c6 / 40320.0 + c7 / 362880.0)))))));
  var p = t * t * t * (1.0 / 6.0 + (beta / 24.0 + (c2 / 120.0 + (c3 / 720.0 + (c4 / 5040.0 + (c5 / 40320.0 + c6 / 362880.0))))));
  for (var i = 0u; i < doublings; i++) {
    p = p + q * t + (1.0 + a * q) * p + h * q;
    let doubled = vec2(h * (2.0 + 2.0 * a * q + b * h), q * (2.0 + a * q) + h * h);
    h = doubled.x;
    q = doubled.y;
    t = 2.0 * t;
  }
  return vec3(h, q, p);
}

fn flow_of(y: array<f32, N>, forces: vec2<f32>, dt: f32) -> Flow {
  let rate = rates(y, forces.x);
  var by = rates_by(y, forces.x);
  let a = by[N];
  let b = by[N + 1u];
  let hqp = response(a, b, dt);
  let h = hqp.x;
  let q = hqp.y;
  let p = hqp.z;
  var flow: Flow;
  for (var j = 0u; j < N; j++) {
    flow.rows[j] = q * by[N + j];
    flow.rows[N + j] = h * by[N + j];
  }
  flow.rows[0] = 1.0 + a * q;
  flow.rows[1] = h;
  flow.rows[N] = a * h;
  flow.rows[N + 1u] = 1.0 + a * q + b * h;
  flow.shift[0] = (h - b * q) * rate[0] + q * rate[1];
  flow.shift[1] = a * q * rate[0] + h * rate[1];
  if (HAS_SLOPE) {
    let push = rates_by_force()[1] * ((forces.y - forces.x) / dt);
    feel(&flow, y, array(p * push, q * push));
  }
  return flow;
}
