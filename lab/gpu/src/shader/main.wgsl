// One thread a run, some samples a dispatch.

// The number of samples whose sums are taken before they are added to those of all samples.
const FEW = 64u;

fn begin(run: u32) -> State {
  var state: State;
  state.belief.mean = cells[run].mean;
  for (var i = 0u; i < N; i++) {
    state.belief.root[at(i, i)] = cells[run].initial_std[i];
  }
  state.product = 1.0;
  return state;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
  let run = id.x;
  if (run >= settings.runs) {
    return;
  }
  var state: State;
  if (settings.begin == 0u) {
    state = begin(run);
  } else {
    state = states[run];
  }
  if (state.stopped != 0u) {
    return;
  }
  let first = cells[run].first;
  var belief = state.belief;
  var k = settings.begin;
  if (k == 0u) {
    if (KNOWS_TRUTH) {
      compare(&state, &belief, first, 0u);
    }
    k = 1u;
  }
  for (; k < settings.end; k++) {
    let before = belief;
    predict(&belief, samples[first + k - 1u].force, samples[first + k].force, run);
    let correction = update(&belief, first + k, run, Correction(0.0, state.product, state.exponent, 0u));
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
      compare(&state, &belief, first + k, k);
    }
    if (k % FEW == FEW - 1u) {
      gather(&state);
    }
  }
  state.belief = belief;
  states[run] = state;
}
