//! Natural frequency and damping ratio of a 3-D printer's axis from Klipper's raw accelerometer files: bias, and coverage of ±2σ, over
//! simulated ones. The numbers are the count of records of each kind and the first seed.
//!
//! ```text
//! cargo run --release -p kalmanscope-core --example printer -- 200 1
//! ```

use std::f64::consts::TAU;
use std::fmt::Write as _;

use kalmanscope_core::free_decay::{Decay, Mode, Sweep};
use kalmanscope_core::import::{ThreeAxes, read};

/// Readings a second, and the standard deviation of their noise, a sum of twelve even numbers \[mm/s²\].
const RATE: f64 = 3200.0;
const NOISE: f64 = 60.0;

/// The motion of the head. A second mode has a sixth to a half of the first one's size; a sweep has one too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    One,
    Two,
    Stops,
    Sweep,
}

/// The acceleration that a mode of ωₙ \[rad/s\] and ζ adds to that of its base, and the exact step of its state.
fn step([x, v]: &mut [f64; 2], wn: f64, zeta: f64, base: f64, dt: f64) -> f64 {
    let felt = -base - 2.0 * zeta * wn * *v - wn * wn * *x;
    let (damped, rest) = (wn * (1.0 - zeta * zeta).sqrt(), -base / (wn * wn));
    let (from, (sin, cos)) = (*x - rest, (damped * dt).sin_cos());
    let (size, slope) = ((-zeta * wn * dt).exp(), (*v + zeta * wn * from) / damped);
    let moved = size * (from * cos + slope * sin);
    (*x, *v) = (rest + moved, size * damped * (slope * cos - from * sin) - zeta * wn * moved);
    felt
}

/// The pulses of a sweep of Klipper's as their ends \[s\] and accelerations \[mm/s²\]: two quarters of a period have one frequency and
/// opposite signs, then the frequency rises by 1 Hz/s, from 5 Hz to 133 Hz.
fn pulses(begin: f64) -> Vec<(f64, f64)> {
    let (mut frequency, mut sign, mut time, mut pulses) = (5.0, 1.0, begin, vec![(begin, 0.0)]);
    while frequency <= 10_000.0 / 75.0 {
        for sign in [sign, -sign] {
            time += 0.25 / frequency;
            pulses.push((time, sign * 75.0 * frequency));
        }
        (frequency, sign) = (frequency + 0.5 / frequency, -sign);
    }
    pulses
}

/// A file of Klipper's, with fₙ \[Hz\] and ζ of the mode that is larger.
fn file(kind: Kind, seed: u64) -> (String, [f64; 2]) {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut between = |low: f64, high: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((state >> 11) as f64 / (1_u64 << 53) as f64)
    };
    let (frequency, damping, second) = (between(25.0, 90.0), between(0.01, 0.12), between(1.0 / 6.0, 0.5));
    let (ratio, own_damping) = (between(1.4, 2.6), between(0.01, 0.08));
    let second = if kind == Kind::One { 0.0 } else { second / (1.0 + second) };
    let mut modes = [(frequency, damping, 1.0 - second), (ratio * frequency, own_damping, second)]
        .map(|(frequency, zeta, share)| (TAU * frequency, zeta, share, [0.0; 2]));
    let [size, begin, length] = [between(3000.0, 8000.0), between(0.01, 0.04), between(0.008, 0.025)];
    let pulses = match kind {
        Kind::Sweep => pulses(50.0 * begin),
        _ => (0..9)
            .map(|k| (0.5 * f64::from(k / 3) + begin + f64::from(k % 3) * length, [0.0, size, -size][k as usize % 3]))
            .collect(),
    };
    let mut pulses = pulses.into_iter().peekable();
    let mut text = "#time,accel_x,accel_y,accel_z\n".to_owned();
    for k in 0..(RATE * [0.5, 0.5, 1.5, 132.0][kind as usize]) as usize {
        let (mut time, mut felt) = (k as f64 / RATE, None);
        while time < (k + 1) as f64 / RATE {
            while pulses.next_if(|pulse| pulse.0 <= time).is_some() {}
            let (end, base) = pulses.peek().copied().unwrap_or((f64::INFINITY, 0.0));
            let dt = end.min((k + 1) as f64 / RATE) - time;
            let moved =
                modes.iter_mut().map(|(wn, zeta, share, x)| *share * step(x, *wn, *zeta, base, dt)).sum::<f64>();
            felt = felt.or(Some(base + moved));
            time += dt;
        }
        let felt = felt.unwrap_or_default();
        let mut noise = || (0..12).map(|_| between(-0.5, 0.5)).sum::<f64>();
        let [x, y, z] = [felt, 0.05 * felt, 9806.65].map(|value| value + NOISE * noise());
        let _ = writeln!(text, "{:.6},{x:.2},{y:.2},{z:.2}", 12.8 + k as f64 / RATE);
    }
    (text, [frequency, damping])
}

/// fₙ \[Hz\] and ζ, each with its standard deviation, of the mode that is nearest to a frequency.
fn identify(kind: Kind, text: String, near: f64) -> Option<[[f64; 2]; 2]> {
    let table = read(text.into_bytes(), None).ok()?;
    let readings = ThreeAxes::of(&table)?.readings(&table);
    let modes = match kind {
        Kind::Sweep => Sweep::of(&readings)?.modes(),
        _ => Decay::modes_of(&Decay::alike(&readings).ok()?),
    };
    let apart = |mode: &Mode| (mode.frequency / near - 1.0).abs();
    let mode = modes.into_iter().min_by(|a, b| apart(a).total_cmp(&apart(b)))?;
    Some([[mode.frequency, mode.std[0]], [mode.damping_ratio, mode.std[1]]])
}

/// Counts the records with a result over some seeds; of f and of ζ the mean and the median of their errors \[%\], and the share within ±2σ \[%\].
pub(crate) fn study(kind: Kind, seeds: std::ops::Range<u64>) -> (usize, [[f64; 3]; 2]) {
    let records = seeds.map(|seed| file(kind, seed));
    let found: Vec<_> = records.filter_map(|(text, truth)| Some((identify(kind, text, truth[0])?, truth))).collect();
    let of = |place: usize| {
        let all = || found.iter().map(|(found, truth)| (found[place], truth[place]));
        let mut errors: Vec<f64> = all().map(|([mean, _], truth)| 100.0 * (mean / truth - 1.0)).collect();
        errors.sort_by(f64::total_cmp);
        let inside = all().filter(|([mean, std], truth)| (mean - truth).abs() <= 2.0 * std).count();
        let count = found.len() as f64;
        let middle = errors.get(errors.len() / 2).copied().unwrap_or(0.0);
        [errors.iter().sum::<f64>() / count, middle, 100.0 * inside as f64 / count]
    };
    (found.len(), [of(0), of(1)])
}

fn main() {
    let mut numbers = std::env::args().skip(1).filter_map(|number| number.parse::<u64>().ok());
    let (count, first) = (numbers.next().unwrap_or(200), numbers.next().unwrap_or(1));
    for kind in [Kind::One, Kind::Two, Kind::Stops, Kind::Sweep] {
        let count = if kind == Kind::Sweep { count.div_ceil(3) } else { count };
        let (found, [f, zeta]) = study(kind, first..first + count);
        let words =
            |[mean, middle, inside]: [f64; 3]| format!("bias {mean:.2} % (median {middle:.2} %), ±2σ {inside:.1} %");
        println!("{kind:?}: {found} of {count} found; f: {}; zeta: {}", words(f), words(zeta));
    }
}
