// The buffers. `layout.rs` has the same structures.

struct Settings {
  // This dispatch does the samples from `begin` to before `end`.
  begin: u32,
  end: u32,
  runs: u32,
  // The first sample of the record's last fifth.
  recent: u32,
  // Whether the truth is known: 0 or 1.
  knows_truth: u32,
  dt: f32,
  // 0
  zero: u32,
}

struct Sample {
  truth: vec4<f32>,
  // Displacement, velocity, acceleration.
  measured: vec3<f32>,
  // Force over mass.
  force: f32,
  // A bit for each sensor with a measurement.
  present: u32,
}

struct Cell {
  mean: vec4<f32>,
  initial_std: vec4<f32>,
  // The root of Q's diagonal.
  process: vec4<f32>,
  // R of displacement, velocity, acceleration.
  noise: vec3<f32>,
  // The root of the fading factor.
  fading: f32,
  // The place of the record's first sample.
  first: u32,
}

// Sums are in two parts: of the last few samples, and of all before.
struct State {
  mean: vec4<f32>,
  // Rounding of the mean that has not been added yet.
  rest: vec4<f32>,
  // Columns of L: 00 10 20 30, 11 21 31 22, 32 33.
  root: array<vec4<f32>, 3>,
  squares: array<vec4<f32>, 2>,
  recent: array<vec4<f32>, 2>,
  inside: vec4<u32>,
  settled: vec4<u32>,
  // NIS, NEES, and both of the last few samples.
  sums: vec4<f32>,
  // det S is `product` times two to the power of `exponent`.
  product: f32,
  exponent: i32,
  nees_degrees: u32,
  nees_samples: u32,
  // The sample at which the filter stopped, 0 if it has not; and why.
  stopped: u32,
  reason: u32,
}

@group(0) @binding(0) var<uniform> settings: Settings;
@group(0) @binding(1) var<storage, read> samples: array<Sample>;
@group(0) @binding(2) var<storage, read> cells: array<Cell>;
@group(0) @binding(3) var<storage, read_write> states: array<State>;
