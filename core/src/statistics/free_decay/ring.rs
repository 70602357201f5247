//! The ring of a thing that was struck, in the samples of a sound: its pitch, where it rings, and what stands beside it.

use kalmanscope_filters::fourier::powers;
use kalmanscope_filters::lists::median;
use kalmanscope_records::import::{Mapping, Table};

/// The ring of one mode in a sound: a glass, a tuning fork, a ruler on the edge of a table.
///
/// The pitch is the strongest line after the loudest block that was not there before; the band leaves others out.
///
/// Source: Ewins (2000), *Modal Testing*, section 4.3 (one mode in a band); Harris (1978), On the use of windows for harmonic
/// analysis with the discrete Fourier transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// The pitch \[Hz\].
    pub pitch: f64,
    /// The part in which it rings \[s\].
    pub part: [f64; 2],
    /// The limits of a band-pass \[Hz\].
    pub band: [f64; 2],
    /// One of this many samples is kept.
    pub every: usize,
}

/// The lowest pitch \[Hz\], and the highest one as a share of the samples a second.
const LOWEST: f64 = 12.0;
const HIGHEST: f64 = 0.4;

/// The length of a block \[s\], and at least this many swings.
const BLOCK: f64 = 0.01;
const SWINGS: f64 = 8.0;

const SPECTRUM: usize = 1 << 16;

/// Limits the pitch's power over the surroundings; another line stands out more clearly, and has this share of the pitch's power.
const ABOVE: f64 = 8.0;
const CLEAR: f64 = 40.0;
const BESIDE: f64 = 1e-4;

/// Shares of the pitch, where no other line is nearer; and the nearest line that is another mode.
const BAND: [f64; 2] = [0.3, 2.2];
const OWN: f64 = 1.05;

const FINENESS: f64 = 5.5;
const MOST_SAMPLES: usize = 20_000;

/// The ring begins and ends at these multiples of the noise, or ends where it grows by this factor; its fewest swings.
const QUIET: f64 = 2.5;
const LOUD: f64 = 6.0;
const GROWTH: f64 = 1.5;
const FEWEST: f64 = 20.0;

impl Ring {
    /// Sets part, band and samples of a sound's mapping to those of its ring. Returns a sentence; `None` for another table.
    pub fn choose(table: &Table, mapping: &mut Mapping) -> Option<String> {
        let (rate, values) = table.sound()?;
        let Some(Self { pitch, part, band, every }) = Self::in_samples(rate, values) else {
            return Some("nothing rings in this sound: a line that is louder than the room and fades".to_owned());
        };
        let round = |x: f64, digits: f64| libm::round(x * digits) / digits;
        let [from, to] = part.map(|time| round(time, 1e4));
        (mapping.from, mapping.to, mapping.every) = (Some(from), Some(to), every);
        mapping.band = Some(band.map(|limit| round(limit, 1e2)));
        let ([from, to], [low, high]) = (part, band);
        let kept = if every == 1 { "every sample".to_owned() } else { format!("one of {every} samples") };
        Some(format!(
            "a sound that rings at {pitch:.1} Hz: {from:.2} s to {to:.2} s of it are taken, between {low:.0} Hz and {high:.0} Hz, {kept}"
        ))
    }

    /// Finds the ring in samples that are 1 / `rate` \[s\] apart.
    pub fn in_samples(rate: f64, values: &[f64]) -> Option<Self> {
        let block = ((BLOCK * rate) as usize).max(1);
        let loudness = |block: &[f64]| {
            let middle = block.iter().sum::<f64>() / block.len() as f64;
            block.iter().map(|x| (x - middle) * (x - middle)).sum::<f64>()
        };
        let blocks: Vec<f64> = values.chunks_exact(block).map(loudness).collect();
        let blow = (0..blocks.len()).max_by(|&a, &b| blocks[a].total_cmp(&blocks[b]))? * block;
        let after = values.get(blow + 2 * block..)?;
        // The blow may begin in the block before the loudest one.
        let before = &values[..blow.saturating_sub(2 * block)];
        let spectrum = RingSpectrum::of(rate, after)?;
        let silence = RingSpectrum::of(rate, &before[before.len().saturating_sub(SPECTRUM)..]);
        let lines = spectrum.lines(silence.as_ref());
        let &Line { frequency: pitch, power, .. } = lines.iter().max_by(|a, b| a.power.total_cmp(&b.power))?;
        let is_own = |line: &&Line| line.frequency > OWN * pitch || line.frequency < pitch / OWN;
        let mut band = BAND.map(|share| share * pitch);
        for line in lines.iter().filter(|line| line.above > CLEAR && line.power > BESIDE * power).filter(is_own) {
            let between = (line.frequency * pitch).sqrt();
            if line.frequency < pitch { band[0] = band[0].max(between) } else { band[1] = band[1].min(between) }
        }
        let every = ((rate / (FINENESS * pitch)) as usize).max(1);
        let length = (BLOCK.max(SWINGS / pitch) * rate) as usize;
        if !(1..=values.len()).contains(&length) {
            return None;
        }
        let sizes = sizes_of_line(values, length, pitch / rate);
        let [begin, end] = ring(&sizes, blow / length)?;
        let begin = begin * length;
        let end = (end * length).min(begin + MOST_SAMPLES * every).min(values.len());
        let part = [begin, end].map(|place| place as f64 / rate);
        ((part[1] - part[0]) * pitch >= FEWEST).then_some(Self { pitch, part, band, every })
    }
}

fn ring(sizes: &[f64], blow: usize) -> Option<[usize; 2]> {
    let begin = blow + 2;
    let largest = *sizes.get(begin)?;
    // The noise is measured in the silence before the blow, or at the end if there is none.
    let silence = if blow > 5 { &sizes[..blow - 1] } else { &sizes[sizes.len() - (sizes.len() / 5).max(1)..] };
    let noise = median(silence.to_vec())?;
    if largest < LOUD * noise {
        return None;
    }
    let mut least = largest;
    let mut end = begin;
    for (place, &size) in sizes.iter().enumerate().skip(begin) {
        if size < QUIET * noise && place > begin + 1 || size > GROWTH * least + QUIET * noise {
            break;
        }
        least = least.min(size);
        end = place + 1;
    }
    (end > begin).then_some([begin, end])
}

fn sizes_of_line(values: &[f64], length: usize, frequency: f64) -> Vec<f64> {
    let turn = std::f64::consts::TAU;
    let waves: Vec<(f64, f64)> = (0..length)
        .map(|k| {
            let weight = 1.0 - libm::cos(turn * (k as f64 + 0.5) / length as f64);
            let (sin, cos) = libm::sincos(turn * frequency * k as f64);
            (2.0 * weight * cos / length as f64, 2.0 * weight * sin / length as f64)
        })
        .collect();
    let size = |block: &[f64]| {
        let sum = |(a, b): (f64, f64), (x, (re, im)): (&f64, &(f64, f64))| (a + x * re, b + x * im);
        let (re, im) = block.iter().zip(&waves).fold((0.0, 0.0), sum);
        libm::hypot(re, im)
    };
    values.chunks_exact(length).map(size).collect()
}

struct Line {
    /// \[Hz\]
    frequency: f64,
    power: f64,
    above: f64,
}

/// A line of amplitude a has the power a² / 4.
struct RingSpectrum {
    /// \[Hz\]
    step: f64,
    rate: f64,
    powers: Vec<f64>,
}

impl RingSpectrum {
    /// Of the first 65,536 samples. `None` if there are fewer than 256.
    fn of(rate: f64, values: &[f64]) -> Option<Self> {
        let values = &values[..values.len().min(SPECTRUM)];
        if values.len() < 256 {
            return None;
        }
        let length = values.len().next_power_of_two();
        let (n, middle) = (values.len() as f64, values.iter().sum::<f64>() / values.len() as f64);
        // The falling half of a Hann window: a ring is strongest where it begins.
        let weight = |k: usize| 1.0 + libm::cos(std::f64::consts::PI * (k as f64 + 0.5) / n);
        let numbers = values.iter().enumerate().map(|(k, x)| weight(k) * (x - middle) / n);
        Some(Self { step: rate / length as f64, rate, powers: powers(numbers, length) })
    }

    fn at(&self, frequency: f64) -> usize {
        ((frequency / self.step) as usize).min(self.powers.len() - 1)
    }

    fn lines(&self, before: Option<&Self>) -> Vec<Line> {
        let mut found = Vec::new();
        let (low, high) = (self.at(LOWEST).max(2), self.at(HIGHEST * self.rate));
        let (mut usual, mut until) = (0.0, 0);
        for k in low..high.min(self.powers.len() - 1) {
            if k >= until {
                until = (k + k / 4).max(k + 16);
                usual = median(self.powers[k..until.min(self.powers.len())].to_vec()).unwrap_or(0.0);
            }
            let [left, here, right] = [self.powers[k - 1], self.powers[k], self.powers[k + 1]];
            if !(here >= left && here > right) {
                continue;
            }
            let [a, b, c] = [left, here, right].map(|power| libm::log(power.max(f64::MIN_POSITIVE)));
            let bend = a - 2.0 * b + c;
            let shift = if bend < 0.0 { 0.5 * (a - c) / bend } else { 0.0 };
            let frequency = (k as f64 + shift.clamp(-0.5, 0.5)) * self.step;
            let width = before.map_or(0.0, |before| 2.0 * before.step.max(self.step));
            let there = before.map_or(0.0, |before| {
                let range = before.at(frequency - width)..=before.at(frequency + width);
                before.powers[range].iter().fold(0.0, |a: f64, b| a.max(*b))
            });
            let power = here - 4.0 * there;
            if here > ABOVE * usual && power > 0.0 {
                found.push(Line { frequency, power, above: here / usual });
            }
        }
        found
    }
}
