// The buffers, as in `layout.rs`. A filter has N components and S sensors. The first M components move; the truth of the first K
// is known.

struct Settings {
  // This dispatch does the samples from `begin` to before `end`.
  begin: u32,
  end: u32,
  runs: u32,
  // The first sample of the record's last fifth.
  recent: u32,
  // The time between samples.
  dt: f32,
  // 0
  zero: u32,
}

struct Sample {
  // Force over mass.
  force: f32,
  // A bit for each sensor with a measurement.
  present: u32,
  measured: array<f32, S>,
  truth: array<f32, K>,
}

struct Cell {
  mean: array<f32, N>,
  initial_std: array<f32, N>,
  // The root of Q's diagonal.
  process: array<f32, N>,
  // R's diagonal.
  noise: array<f32, S>,
  // The root of the fading factor.
  fading: f32,
  // The standard deviation of the white force.
  white: f32,
  // The place of the record's first sample.
  first: u32,
}

// A belief: mean, and the rows of the lower triangular root L of the covariance P = L L'. In single precision a root keeps what
// a covariance loses to rounding: P cannot become indefinite, and small variances beside large ones stay.
struct Belief {
  mean: array<f32, N>,
  // Rounding of the mean that has not been added yet.
  rest: array<f32, N>,
  root: array<f32, TRIANGLE>,
}

// The sums of a channel whose truth is known. Those of squares are in two parts: of all but the last few samples, and of these.
struct Tracked {
  squares: f32,
  few_squares: f32,
  recent: f32,
  few_recent: f32,
  inside: u32,
  settled: u32,
}

struct State {
  belief: Belief,
  tracked: array<Tracked, K>,
  nis: f32,
  few_nis: f32,
  nees: f32,
  few_nees: f32,
  nees_degrees: u32,
  nees_samples: u32,
  // det S is `product` times two to the power of `exponent`.
  product: f32,
  exponent: i32,
  // The sample at which the filter stopped, 0 if it has not; and why.
  stopped: u32,
  reason: u32,
}

@group(0) @binding(0) var<uniform> settings: Settings;
@group(0) @binding(1) var<storage, read> samples: array<Sample>;
@group(0) @binding(2) var<storage, read> cells: array<Cell>;
@group(0) @binding(3) var<storage, read_write> states: array<State>;
