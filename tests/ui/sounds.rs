//! The sound of something that rings.

use std::f64::consts::TAU;

/// White noise from -1/2 to 1/2. Source: Steele, Lea and Flood (2014), Fast splittable pseudorandom number generators (its mix).
fn noise(k: u32) -> f64 {
    let mut bits = (u64::from(k) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    for factor in [0xbf58_476d_1ce4_e5b9, 0x94d0_49bb_1331_11eb] {
        bits = (bits ^ (bits >> 29)).wrapping_mul(factor);
    }
    (bits >> 40) as f64 / f64::from(1 << 24) - 0.5
}

/// The size, the frequency \[Hz\] and the damping ratio of a mode.
pub(crate) type Mode = [f64; 3];

/// Modes that ring after a second of silence, in noise of some size, for this many samples at 48,000 per second.
pub(crate) fn ring(modes: [Mode; 2], loudness: f64, samples: u32) -> Vec<f32> {
    let sample = |k: u32| {
        let since = f64::from(k) / 48_000.0 - 1.0;
        let mode = |[size, hertz, damping]: Mode| {
            let w = TAU * hertz;
            size * (-damping * w * since).exp() * (w * since).sin()
        };
        let rings = if since < 0.0 { 0.0 } else { modes.map(mode).iter().sum() };
        (rings + loudness * noise(k)) as f32
    };
    (0..samples).map(sample).collect()
}
