//! The recent readings of a displacement sensor, as a cloud above the mass.

use egui::{Color32, Painter, Shape, pos2};

use super::stage::Stage;

const READINGS: usize = 40;

/// Fewer readings if the truth is unknown or hidden: they then stay in place while the mass moves.
const BARE_READINGS: usize = 8;

/// Draws the last readings up to sample `k`, older ones fainter. Each is as far from the mass at `x` \[m\] as it was
/// from the `truth` when it was read, so that the cloud shows the noise without the motion.
pub(super) fn cloud(
    stage: &Stage,
    painter: &Painter,
    mass: usize,
    readings: &[f64],
    truth: Option<&[f64]>,
    k: usize,
    color: Color32,
) {
    let now = truth.and_then(|truth| truth.get(k)).copied();
    let count = if now.is_some() { READINGS } else { BARE_READINGS };
    let (middle, height) = stage.cloud(stage.body(mass, now.unwrap_or(0.0)));
    let dot = |age: usize| {
        let reading = readings.get(k - age).filter(|reading| reading.is_finite())?;
        let then = truth.and_then(|truth| truth.get(k - age)).copied();
        let x = match (now, then) {
            (Some(now), Some(then)) => now + reading - then,
            _ => *reading,
        };
        // The golden ratio spreads them evenly; a reading keeps its height while it fades.
        let across = ((k - age) as f64 * 0.618_033_988_75).fract() as f32 - 0.5;
        let fresh = 1.0 - age as f32 / count as f32;
        let radius = stage.unit * if age == 0 { 2.4 } else { 1.5 };
        let at = pos2(stage.place(mass, x), middle.y + 0.86 * across * height);
        Some(Shape::circle_filled(at, radius, color.gamma_multiply(0.25 + 0.75 * fresh * fresh)))
    };
    painter.extend((0..count.min(k + 1)).rev().filter_map(dot));
}
