// One thread a run, some samples a dispatch.

// The number of samples whose sums are taken before they are added to those of all samples.
const FEW = 64u;

fn begin(cell: Cell) -> State {
  var state: State;
  state.mean = cell.mean;
  state.root[0].x = cell.initial_std.x;
  state.root[1].x = cell.initial_std.y;
  state.root[1].w = cell.initial_std.z;
  state.root[2].y = cell.initial_std.w;
  state.product = 1.0;
  return state;
}

fn belief_of(state: State) -> Belief {
  let second = state.root[1];
  let third = state.root[2];
  return Belief(state.mean, state.rest, state.root[0], second.xyz, vec2(second.w, third.x), third.y);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
  let run = id.x;
  if (run >= settings.runs) {
    return;
  }
  let cell = cells[run];
  var state: State;
  if (settings.begin == 0u) {
    state = begin(cell);
  } else {
    state = states[run];
  }
  if (state.stopped != 0u) {
    return;
  }
  var belief = belief_of(state);
  var k = settings.begin;
  if (k == 0u) {
    if (settings.knows_truth != 0u) {
      compare(&state, belief, samples[cell.first].truth, 0u);
    }
    k = 1u;
  }
  for (; k < settings.end; k++) {
    let sample = samples[cell.first + k];
    let before = belief;
    predict(&belief, samples[cell.first + k - 1u].force, cell);
    let correction = update(&belief, sample, cell, Correction(0.0, state.product, state.exponent, 0u));
    if (correction.reason != 0u) {
      belief = before;
      state.stopped = k;
      state.reason = correction.reason;
      break;
    }
    state.product = correction.product;
    state.exponent = correction.exponent;
    state.sums.z += correction.nis;
    if (settings.knows_truth != 0u) {
      compare(&state, belief, sample.truth, k);
    }
    if (k % FEW == FEW - 1u) {
      gather(&state);
    }
  }
  state.mean = belief.mean;
  state.rest = belief.rest;
  state.root[0] = belief.l0;
  state.root[1] = vec4(belief.l1, belief.l2.x);
  state.root[2] = vec4(belief.l2.y, belief.l3, 0.0, 0.0);
  states[run] = state;
}
