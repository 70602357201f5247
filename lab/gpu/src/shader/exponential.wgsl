// Local linearisation of any plant: F is the block of A that moves, C the rest, and b the effect of the force.
//
//   Phi = exp(F dt),  G = the integral of exp(F t) from 0 to dt,  rows of the derivative = [Phi, G C],  shift = G g + H b slope

const TERMS = 9u;

fn times(a: ptr<function, array<f32, BLOCK>>, b: ptr<function, array<f32, BLOCK>>) -> array<f32, BLOCK> {
  var product: array<f32, BLOCK>;
  for (var i = 0u; i < M; i++) {
    for (var j = 0u; j < M; j++) {
      var sum = 0.0;
      for (var k = 0u; k < M; k++) {
        sum += (*a)[i * M + k] * (*b)[k * M + j];
      }
      product[i * M + j] = sum;
    }
  }
  return product;
}

fn apply(a: ptr<function, array<f32, BLOCK>>, x: array<f32, M>) -> array<f32, M> {
  var own = x;
  var product: array<f32, M>;
  for (var i = 0u; i < M; i++) {
    for (var k = 0u; k < M; k++) {
      product[i] += (*a)[i * M + k] * own[k];
    }
  }
  return product;
}

// The size of a step: the root of the norm of (F dt)^2, which different units of its rows do not make large.
fn size_of(f: ptr<function, array<f32, BLOCK>>, dt: f32) -> f32 {
  var square = times(f, f);
  var norm = 0.0;
  for (var j = 0u; j < M; j++) {
    var sum = 0.0;
    for (var i = 0u; i < M; i++) {
      sum += abs(square[i * M + j]);
    }
    norm = max(norm, sum);
  }
  return sqrt(norm) * dt;
}

fn flow_of(y: array<f32, N>, forces: vec2<f32>, dt: f32) -> Flow {
  let rate = rates(y, forces.x);
  var by = rates_by(y, forces.x);
  var f: array<f32, BLOCK>;
  for (var i = 0u; i < M; i++) {
    for (var j = 0u; j < M; j++) {
      f[i * M + j] = by[i * N + j];
    }
  }
  let size = size_of(&f, dt);
  var doublings = 0u;
  if (size > 0.5) {
    doublings = u32(clamp(ceil(log2(2.0 * size)), 0.0, 64.0));
  }
  var t = dt * exp2(-f32(doublings));
  // Horner's scheme of G / t, and of H b / t^2.
  var g: array<f32, BLOCK>;
  let by_force = rates_by_force();
  var effect = by_force;
  var b = by_force;
  for (var i = 0u; i < M; i++) {
    g[i * M + i] = 1.0;
  }
  for (var k = TERMS; k > 1u; k--) {
    g = times(&f, &g);
    for (var i = 0u; i < BLOCK; i++) {
      g[i] *= t / f32(k);
    }
    for (var i = 0u; i < M; i++) {
      g[i * M + i] += 1.0;
    }
    if (HAS_SLOPE) {
      effect = apply(&f, effect);
      for (var i = 0u; i < M; i++) {
        effect[i] = b[i] + effect[i] * (t / f32(k + 1u));
      }
    }
  }
  for (var i = 0u; i < BLOCK; i++) {
    g[i] *= t;
  }
  for (var i = 0u; i < M; i++) {
    effect[i] *= 0.5 * t * t;
  }
  var phi = times(&f, &g);
  for (var i = 0u; i < M; i++) {
    phi[i * M + i] += 1.0;
  }
  for (var n = 0u; n < doublings; n += 1u) {
    if (HAS_SLOPE) {
      var held = apply(&g, by_force);
      var moved = apply(&phi, effect);
      for (var i = 0u; i < M; i++) {
        effect[i] += t * held[i] + moved[i];
      }
    }
    var later = times(&phi, &g);
    for (var i = 0u; i < BLOCK; i++) {
      g[i] += later[i];
    }
    phi = times(&phi, &phi);
    t = 2.0 * t;
  }
  var flow: Flow;
  flow.shift = apply(&g, rate);
  for (var i = 0u; i < M; i++) {
    for (var j = 0u; j < M; j++) {
      flow.rows[i * N + j] = phi[i * M + j];
    }
    for (var j = M; j < N; j++) {
      var sum = 0.0;
      for (var k = 0u; k < M; k++) {
        sum += g[i * M + k] * by[k * N + j];
      }
      flow.rows[i * N + j] = sum;
    }
  }
  if (HAS_SLOPE) {
    let slope = (forces.y - forces.x) / dt;
    for (var i = 0u; i < M; i++) {
      effect[i] *= slope;
    }
    feel(&flow, y, effect);
  }
  return flow;
}
