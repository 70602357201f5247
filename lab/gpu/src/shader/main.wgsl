// One thread a run, some samples a dispatch.

// The number of samples whose sums are taken before they are added to those of all samples.
const FEW = 64u;

fn begin(cell: ptr<function, Cell>) -> State {
  var state: State;
  state.belief.mean = (*cell).mean;
  for (var i = 0u; i < N; i++) {
    state.belief.root[at(i, i)] = (*cell).initial_std[i];
  }
  state.product = 1.0;
  return state;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
  // Threads without a run do the last one again: some compilers are slow, and wrong, where threads of a group do nothing.
  let run = min(id.x, settings.runs - 1u);
  var cell = cells[run];
  var state: State;
  if (settings.begin == 0u) {
    state = begin(&cell);
  } else {
    state = states[run];
  }
  var belief = state.belief;
  var k = settings.begin;
  if (k == 0u) {
    var sample = samples[cell.first];
    if (KNOWS_TRUTH) {
      compare(&state, &belief, &sample, 0u);
    }
    k = 1u;
  }
  for (; k < settings.end && state.stopped == 0u; k++) {
    let before = belief;
    var sample = samples[cell.first + k];
    predict(&belief, samples[cell.first + k - 1u].force, sample.force, &cell);
    let correction = update(&belief, &sample, &cell, Correction(0.0, state.product, state.exponent, 0u));
    if (correction.reason != 0u) {
      belief = before;
      state.stopped = k;
      state.reason = correction.reason;
      break;
    }
    state.product = correction.product;
    state.exponent = correction.exponent;
    state.few_nis += correction.nis;
    if (KNOWS_TRUTH) {
      compare(&state, &belief, &sample, k);
    }
    if (k % FEW == FEW - 1u) {
      gather(&state);
    }
  }
  state.belief = belief;
  if (id.x == run) {
    states[run] = state;
  }
}
