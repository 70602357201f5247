//! The modes of a printer's head in a slow sweep whose force is in no column, as Klipper's test of resonances makes it.

use std::f64::consts::{PI, TAU};

use kalmanscope_filters::least_squares::{NormalEquations, descend};
use kalmanscope_filters::lists::{mapped, median, numbers};

use super::modes::highest;
use super::{Along, Mode, in_order};

type Complex = nalgebra::Complex<f64>;

/// A sweep: the commanded acceleration grows with its frequency, which runs up along a line. Its fundamental wave u drives the head:
///
/// ```text
/// u = f exp(iφ),  f = f₀ + r t,  φ = 2π (f₀ t + r t²/2 - κ ln f/f₀)
/// y = c₀ u + Σ cₖ Tₖ u,  Tₖ = (2ζωₙ s + ωₙ²) / (s² + 2ζωₙ s + ωₙ²)
/// ```
///
/// The response of each T is that of the rising frequency, not the steady one: a mode of small ζ rings longer than the sweep takes to pass
/// it. The c are complex, and κ is 1/4 for pulses that keep the frequency with which they begin. The bands know of noise and
/// of the drive's pulses, not of friction that changes with the size of the motion.
///
/// Source: Golub and Pereyra (1973), The differentiation of pseudo-inverses and nonlinear least squares problems whose variables separate;
/// Hochbruck and Ostermann (2010), Exponential integrators.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// The frequencies at its beginning and its end \[Hz\].
    pub range: [f64; 2],
    /// The times of both \[s\].
    pub part: [f64; 2],
    /// f₀, r and κ.
    law: [f64; 3],
    windows: Vec<Complex>,
}

/// \[s\]
const WINDOW: f64 = 0.5;
const HOP: f64 = 0.25;
const STEP: f64 = 0.025;
/// Parts of a step where the pole is nearer than the next constant, in radians a step.
const PARTS: usize = 4;
const CLOSE: f64 = 2.0;
/// Distance of a window in the sweep from its line \[Hz\]; the least share of such windows in its part.
const NEAR: f64 = 1.5;
const LINED: f64 = 0.6;
/// Limits the windows, because all are compared, and from below the last frequency over the first one.
const FEWEST: usize = 40;
const MOST: usize = 1200;
const RISE: f64 = 2.0;
const DAMPING: [f64; 3] = [0.01, 0.04, 0.12];
const TRIES: usize = 30;
const ROUNDS: usize = 3;
/// Limits the first frequencies of modes \[Hz\], in this number of steps up to this factor above the sweep.
const LOWEST: f64 = 10.0;
const GRID: usize = 48;
const WIDER: f64 = 1.5;
const LAGS: usize = 12;
/// The pulses differ from the model's wave: bands of f and ζ are wider by these factors, set on 195 simulated sweeps.
const OF_DRIVE: [f64; 2] = [1.2, 1.5];
const FIRST: usize = 6;

/// The numbers of φ and of c₀, and ωₙ, ζ and c of each mode; a second mode may be absent.
type Numbers = [f64; FIRST + 8];
type Start = ([f64; 2], Vec<Complex>);
const SMALL: f64 = 1e-6;

impl Sweep {
    /// The sweep in readings of time \[s\] and three accelerations \[m/s²\]. `None` where no line runs up through the frequencies.
    pub fn of(readings: &[[f64; 4]]) -> Option<Self> {
        let Along { times, along, .. } = Along::of(&in_order(readings));
        let readings: Vec<[f64; 2]> = times.iter().zip(&along).map(|(time, x)| [*time, *x]).collect();
        let (begin, end) = (readings.first()?[0], readings.last()?[0]);
        let (mut points, mut slopes) = (Vec::<[f64; 2]>::new(), Vec::new());
        let windows = ((end - begin) / WINDOW) as usize;
        if windows > MOST {
            return None;
        }
        for k in 0..windows {
            let window = within(&readings, begin + WINDOW * k as f64);
            let values = numbers(window.len(), &|k| window[k][1]);
            if let Some(turn) = highest(window, &values, |_| true) {
                let point = [begin + WINDOW * (k as f64 + 0.5), turn / TAU];
                for before in &points {
                    slopes.push((point[1] - before[1]) / (point[0] - before[0]));
                }
                points.push(point);
            }
        }
        let rate = median(slopes)?;
        let offset = median(mapped(&points, &|[time, frequency]| frequency - rate * time))?;
        let is_near = |[time, frequency]: &[f64; 2]| (frequency - offset - rate * time).abs() < NEAR;
        let (first, last) = (points.iter().position(is_near)?, points.iter().rposition(is_near)?);
        let near = points[first..=last].iter().filter(|point| is_near(point)).count();
        let part = [points[first][0], points[last][0]];
        let range = [offset + rate * part[0], offset + rate * part[1]];
        let is_line = near >= FEWEST && near as f64 >= LINED * (last - first) as f64;
        if !is_line || range[0] <= 0.0 || range[1] < RISE * range[0] {
            return None;
        }
        let mut sweep = Self { range, part, law: [range[0], rate, 0.25], windows: Vec::new() };
        for _ in 0..ROUNDS {
            sweep.follow(&readings);
            sweep.straighten()?;
        }
        sweep.follow(&readings);
        // A pause leaves windows without a number.
        sweep.windows.iter().all(|seen| seen.norm_sqr().is_finite()).then_some(sweep)
    }

    fn frequency(&self, time: f64) -> f64 {
        self.law[0] + self.law[1] * time
    }

    fn phase(&self, time: f64) -> f64 {
        let [f, rate, share] = self.law;
        TAU * (time * (f + 0.5 * rate * time) - share * libm::log(self.frequency(time) / f))
    }

    fn times(&self) -> impl Iterator<Item = f64> + use<> {
        let count = ((self.part[1] - self.part[0] - WINDOW) / HOP) as usize;
        (0..count).map(|k| 0.5 * WINDOW + HOP * k as f64)
    }

    fn follow(&mut self, readings: &[[f64; 2]]) {
        self.windows.clear();
        for time in self.times() {
            let mut mean = WindowMean::default();
            for [at, x] in within(readings, self.part[0] + time - 0.5 * WINDOW) {
                let after = at - self.part[0];
                mean.add(after - time, turn(-self.phase(after)) * (2.0 * x));
            }
            self.windows.push(mean.of());
        }
    }

    fn straighten(&mut self) -> Option<()> {
        let (mut equations, mut before, mut phase) = (NormalEquations::<3>::zero(), Complex::ONE, 0.0);
        for (time, seen) in self.times().zip(&self.windows) {
            let turned = seen * before.conj();
            phase += libm::atan2(turned.im, turned.re);
            before = *seen;
            equations.add([1.0, TAU * time, PI * time * time], phase, 1.0);
        }
        let [_, frequency, rate] = equations.solution()?;
        self.law[0] += frequency;
        self.law[1] += rate;
        Some(())
    }

    /// Its one or two modes, the larger one first, with their shares of the motion as amplitudes; none where no fit is found.
    pub fn modes(&self) -> Vec<Mode> {
        self.fit().unwrap_or_default()
    }

    fn fit(&self) -> Option<Vec<Mode>> {
        let count = 2.0 * self.windows.len() as f64;
        let sizes = self.times().map(|time| self.frequency(time)).zip(&self.windows);
        let sizes = sizes.map(|(f, seen)| (f, seen.norm_sqr() / (f * f)));
        let (peak, _) = sizes.fold((0.0, 0.0), |peak, one| if one.1 > peak.1 { one } else { peak });
        let start = |of: [f64; 2]| {
            let mut numbers = [0.0; FIRST + 4];
            numbers[FIRST..FIRST + 2].copy_from_slice(&of);
            (of, self.column(&numbers, FIRST + 2))
        };
        let ratio = WIDER * self.range[1] / LOWEST;
        let grid = (0..GRID).map(|k| LOWEST * libm::pow(ratio, k as f64 / GRID as f64)).chain([peak]);
        let starts: Vec<Start> = grid.flat_map(|f| DAMPING.map(|zeta| start([TAU * f, zeta]))).collect();
        let alone: Vec<[&Start; 2]> = mapped(&starts, &|one| [one; 2]);
        let one = self.descend(1, self.likeliest(1, &alone)?);
        let first = start([one.1[FIRST], one.1[FIRST + 1]]);
        let (mut pairs, mut beside) = (Vec::new(), Vec::new());
        for (k, other) in starts.iter().enumerate() {
            pairs.extend(starts[..k].iter().map(|before| [other, before]));
            beside.push([&first, other]);
        }
        let [two, other] =
            [self.likeliest(2, &pairs)?, self.likeliest(2, &beside)?].map(|start| self.descend(2, start));
        let two = if other.0 < two.0 { other } else { two };
        let is_two = 0.5 * count * libm::log(one.0 / two.0) > 2.0 * libm::log(count);
        let mut modes = if is_two { self.with_bands(2, &two)? } else { self.with_bands(1, &one)? };
        modes.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        Some(modes)
    }

    fn column(&self, numbers: &[f64], place: usize) -> Vec<Complex> {
        let mut one = numbers.to_vec();
        one[place] = 1.0;
        self.windows.iter().zip(self.rests(&one)).map(|(seen, rest)| seen - rest).collect()
    }

    fn shares(&self, columns: [&[Complex]; 3]) -> Option<([f64; 6], f64)> {
        let at = |column: &[Complex], k: usize| column.get(k).copied().unwrap_or_default();
        let at = |k: usize| [at(columns[0], k), at(columns[1], k), at(columns[2], k)];
        let mut equations = NormalEquations::<6>::zero();
        for (k, seen) in self.windows.iter().enumerate() {
            let [a, b, c] = at(k);
            equations.add([a.re, -a.im, b.re, -b.im, c.re, -c.im], seen.re, 1.0);
            equations.add([a.im, a.re, b.im, b.re, c.im, c.re], seen.im, 1.0);
        }
        let c = equations.damped(0.0, 1e-12).solution()?;
        let mut left = 0.0;
        for (k, seen) in self.windows.iter().enumerate() {
            let [one, two, three] = at(k);
            let motion =
                one * Complex::new(c[0], c[1]) + two * Complex::new(c[2], c[3]) + three * Complex::new(c[4], c[5]);
            left += (seen - motion).norm_sqr();
        }
        Some((c, left))
    }

    fn likeliest(&self, modes: usize, all: &[[&Start; 2]]) -> Option<Numbers> {
        let force = self.column(&[0.0; FIRST], FIRST - 2);
        let mut best: Option<(f64, &[&Start; 2])> = None;
        for of in all {
            let second = if modes == 2 { &of[1].1[..] } else { &[] };
            let (_, left) = self.shares([&force, &of[0].1, second])?;
            if best.is_none_or(|(least, _)| left < least) {
                best = Some((left, of));
            }
        }
        let mut numbers = [0.0; FIRST + 8];
        for (of, numbers) in best?.1.iter().zip(numbers[FIRST..].chunks_exact_mut(4)).take(modes) {
            numbers[..2].copy_from_slice(&of.0);
        }
        self.tuned(modes, numbers)
    }

    /// With the c of the least residuals: steps that move numbers and c together are stuck in narrow valleys.
    fn tuned(&self, modes: usize, mut at: Numbers) -> Option<Numbers> {
        let places = || (FIRST - 2..FIRST + 4 * modes).step_by(4);
        places().for_each(|place| at[place..place + 2].fill(0.0));
        let mut columns = [const { Vec::new() }; 3];
        places().zip(&mut columns).for_each(|(place, column)| *column = self.column(&at, place));
        let (shares, _) = self.shares([&columns[0], &columns[1], &columns[2]])?;
        places().zip(shares.chunks_exact(2)).for_each(|(place, share)| at[place..place + 2].copy_from_slice(share));
        Some(at)
    }

    fn cost(&self, at: &[f64]) -> f64 {
        self.rests(at).iter().map(Complex::norm_sqr).sum()
    }

    fn descend(&self, modes: usize, start: Numbers) -> (f64, Numbers) {
        let step = |at: &Numbers, by: Numbers| {
            let mut next = *at;
            next.iter_mut().zip(by).for_each(|(next, by)| *next += by);
            for place in (FIRST..FIRST + 4 * modes).step_by(4) {
                let highest = 2.0 * TAU * self.range[1];
                next[place] = next[place].clamp(0.9 * at[place], (1.1 * at[place]).min(highest));
                next[place + 1] = next[place + 1].clamp(0.3 * at[place + 1], (3.0 * at[place + 1]).min(0.5)).max(1e-4);
            }
            self.tuned(modes, next)
        };
        let descend = |start, is_free| {
            let equations = |at: &Numbers, (): &()| self.normal(modes, at, is_free);
            descend(start, (TRIES, 1e-12), |cost| 1e-9 * cost, |at| (self.cost(at), ()), equations, step)
        };
        // The bend and the logarithm of the law change little: they are fitted last.
        descend(descend(start, false).1, true)
    }

    fn normal(&self, modes: usize, at: &Numbers, is_free: bool) -> NormalEquations<{ FIRST + 8 }> {
        let rests = self.rests(at);
        let is_still = |i: usize| i >= FIRST + 4 * modes || !is_free && (2..4).contains(&i);
        let by: [Vec<Complex>; FIRST + 8] = std::array::from_fn(|i| {
            if is_still(i) {
                return vec![Complex::ZERO; rests.len()];
            }
            let (mut moved, step) = (*at, SMALL * at[i].abs().max(1e-3));
            moved[i] += step;
            rests.iter().zip(self.rests(&moved)).map(|(rest, moved)| (rest - moved) / step).collect()
        });
        let mut equations = NormalEquations::zero();
        for still in (0..FIRST + 8).filter(|i| is_still(*i)) {
            equations.add(std::array::from_fn(|i| f64::from(u8::from(i == still))), 0.0, 1.0);
        }
        for (k, rest) in rests.iter().enumerate() {
            equations.add(std::array::from_fn(|i| by[i][k].re), rest.re, 1.0);
            equations.add(std::array::from_fn(|i| by[i][k].im), rest.im, 1.0);
        }
        equations
    }

    fn with_bands(&self, modes: usize, (cost, at): &(f64, Numbers)) -> Option<Vec<Mode>> {
        // Residuals of neighbouring windows are correlated, which widens the bands.
        let rests = self.rests(at);
        let alike = |lag: usize| rests.iter().zip(&rests[lag..]).map(|(a, b)| (a * b.conj()).re).sum::<f64>() / cost;
        let waves: f64 = (1..LAGS).map(|lag| 2.0 * (1.0 - lag as f64 / LAGS as f64) * alike(lag)).sum();
        let noise =
            cost / (2 * self.windows.len()).saturating_sub(FIRST + 4 * modes).max(1) as f64 * (1.0 + waves.max(0.0));
        let variances = self.normal(modes, at, true).variances()?;
        let numbers = at[FIRST..].chunks_exact(4).zip(variances[FIRST..].chunks_exact(4));
        let modes = numbers.take(modes).map(|(of, variances)| {
            let band = |i: usize| OF_DRIVE[i] * (noise * variances[i]).sqrt();
            let amplitude = libm::hypot(of[2], of[3]);
            Mode { frequency: of[0] / TAU, damping_ratio: of[1], std: [band(0) / TAU, band(1)], amplitude }
        });
        Some(modes.collect())
    }

    fn rests(&self, numbers: &[f64]) -> Vec<Complex> {
        let [shift, bend, log, late, re, im] = numbers[..FIRST] else { return Vec::new() };
        let count = ((self.part[1] - self.part[0]) / STEP) as usize + 1;
        let (mut law, mut motion) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for k in 0..count {
            let line = self.frequency(STEP * k as f64) + shift + bend * STEP * k as f64;
            let f = line - (self.law[2] + log) * self.law[1] / line;
            law.push(f);
            motion.push(Complex::new(re, im) * f);
        }
        for of in numbers[FIRST..].chunks_exact(4).filter(|of| of[2..] != [0.0; 2]) {
            let (wn, zeta, c) = (of[0], of[1], Complex::new(of[2], of[3]));
            let pole = Complex::new(-zeta, (1.0 - zeta * zeta).sqrt()) * wn;
            for pole in [pole, pole.conj()] {
                let share = c * (pole * (2.0 * zeta * wn) + wn * wn) / Complex::new(0.0, 2.0 * pole.im);
                respond(&law, pole, |k, response| motion[k] += share * response);
            }
        }
        for (k, value) in motion.iter_mut().enumerate() {
            let time = STEP * k as f64;
            let phase = time * (shift + 0.5 * bend * time) - log * libm::log(self.frequency(time) / self.law[0]);
            *value *= turn(TAU * phase + late / (law[k] * law[k]));
        }
        let side = (0.5 * WINDOW / STEP) as usize;
        let mut rests = Vec::with_capacity(self.windows.len());
        for (time, seen) in self.times().zip(&self.windows) {
            let first = ((time / STEP + 0.5) as usize).saturating_sub(side);
            let mut mean = WindowMean::default();
            for (k, value) in (first..).zip(&motion[first..(first + 2 * side + 1).min(count)]) {
                mean.add(STEP * k as f64 - time, *value);
            }
            rests.push(seen - mean.of());
        }
        rests
    }
}

/// The response of `q' = p q + u` beside φ, from where it is steady; exact where the steady one is linear over a step.
fn respond(law: &[f64], pole: Complex, mut each: impl FnMut(usize, Complex)) {
    let steady = |f: f64| Complex::from(f) / Complex::new(-pole.re, TAU * f - pole.im);
    let (mut off, mut before) = (Complex::ZERO, steady(law[0]));
    each(0, before);
    for (k, pair) in law.windows(2).enumerate() {
        // Near the pole, the steady one turns fast.
        let parts = if ((TAU * pair[0] - pole.im) * STEP).abs() < CLOSE { PARTS } else { 1 };
        let part = (pair[1] - pair[0]) / parts as f64;
        for n in 0..parts {
            let z = Complex::new(pole.re, pole.im - TAU * (pair[0] + part * (n as f64 + 0.5))) * (STEP / parts as f64);
            let (kept, next) = (turn(z.im) * libm::exp(z.re), steady(pair[0] + part * (n + 1) as f64));
            off = kept * off - (kept - 1.0) / z * (next - before);
            before = next;
        }
        each(k + 1, before + off);
    }
}

fn within(readings: &[[f64; 2]], from: f64) -> &[[f64; 2]] {
    let place = |time: f64| readings.partition_point(|reading| reading[0] < time);
    &readings[place(from)..place(from + WINDOW)]
}

/// A mean under cos⁴, in which harmonics and backward motion leave next to nothing.
#[derive(Default)]
struct WindowMean {
    sum: Complex,
    weights: f64,
}

impl WindowMean {
    fn add(&mut self, time: f64, value: Complex) {
        let weight = libm::cos(PI * time.clamp(-0.5 * WINDOW, 0.5 * WINDOW) / WINDOW).powi(4);
        self.sum += value * weight;
        self.weights += weight;
    }

    fn of(&self) -> Complex {
        self.sum / self.weights
    }
}

fn turn(phase: f64) -> Complex {
    let (sin, cos) = libm::sincos(phase);
    Complex::new(cos, sin)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rising(seconds: f64, is_turned: bool) -> Vec<[f64; 4]> {
        let wave = |t: f64| (5.0 + t) * libm::sin(TAU * t * (5.0 + 0.5 * t));
        let all = (0..(200.0 * seconds) as usize).map(|k| k as f64 / 200.0).map(|t| [t, wave(t), 0.1 * wave(t), 9.81]);
        if is_turned { all.rev().collect() } else { all.collect() }
    }

    #[test]
    fn a_rising_line_is_a_sweep_in_any_order_and_nothing_else_is() {
        let found = [false, true].map(|is_turned| Sweep::of(&rising(60.0, is_turned)).unwrap());
        assert_eq!(found[0].range, found[1].range);
        assert!((found[0].range[1] - found[0].range[0] - 59.5).abs() < 1.0, "{:?}", found[0].range);
        let mut others = vec![Vec::new(), vec![[f64::NAN; 4]; 50], rising(10.0, false), rising(60.0, false)];
        others[3].iter_mut().for_each(|reading| reading[0] *= 1e15);
        others.push(rising(60.0, false).into_iter().filter(|reading| !(30.0..31.0).contains(&reading[0])).collect());
        others.push((0..40_000).map(|k| [f64::from(k), 1.0, 0.0, 9.81]).collect());
        for readings in others {
            assert!(
                Sweep::of(&readings).is_none_or(|sweep| sweep.modes().iter().all(|mode| mode.frequency.is_finite()))
            );
        }
    }
}
