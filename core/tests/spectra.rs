//! Power over frequency: densities against their definition, for white noise, lines and blows; spectrograms of tones.

use std::f64::consts::PI;

use kalmanscope_core::{Hold, Quantity, Record, Spectrogram, Spectrum, Task as _};
use kalmanscope_filters::random::{Normal, Purpose};

use crate::numbers::mean;
use crate::run::forced;

const DT: f64 = 0.01;

fn spaced(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| from + (to - from) * i as f64 / (count - 1) as f64).collect()
}

fn density(samples: &[f64], frequencies: &[f64], longest: f64) -> Vec<f64> {
    let mut spectrum = Spectrum::new(frequencies.to_vec(), DT, longest);
    spectrum.extend(samples);
    spectrum.density()
}

fn white(samples: usize) -> Vec<f64> {
    let mut normal = Normal::new(3, Purpose::Force);
    (0..samples).map(|_| 4.0 * normal.sample()).collect()
}

#[test]
fn white_noise_is_flat() {
    let frequencies = spaced(2.0, 300.0, 150);
    let level = 16.0 * DT / PI;
    let found = density(&white(200_000), &frequencies, 20.0);
    assert!((mean(&found) / level - 1.0).abs() < 0.01, "{} instead of {level}", mean(&found));
    assert!(found.iter().all(|s| (s / level - 1.0).abs() < 0.4));
    for samples in [1, 40, 700] {
        let records = white(400 * samples);
        let sum: f64 = records.chunks(samples).map(|record| mean(&density(record, &frequencies, 20.0))).sum();
        assert!((sum / 400.0 / level - 1.0).abs() < 0.1, "{samples}: {} instead of {level}", sum / 400.0);
    }
}

#[test]
fn all_of_the_power_is_found_again() {
    // With short windows for all frequencies, the sum over the density is exact.
    let frequencies = spaced(0.0, PI / DT, 65);
    let step = frequencies[1];
    for samples in [1, 7, 1000, 1234] {
        let noise = white(samples);
        let found = density(&noise, &frequencies, 0.1);
        let power = step * (found.iter().sum::<f64>() - 0.5 * (found[0] + found[64]));
        let expected = noise.iter().map(|f| f * f).sum::<f64>() / samples as f64;
        assert!((power / expected - 1.0).abs() < 1e-11, "{power} instead of {expected}");
    }
}

#[test]
fn a_sine_is_a_line_with_its_power() {
    let frequencies = spaced(0.05, 60.0, 4000);
    let step = frequencies[1] - frequencies[0];
    for frequency in [2.0, 6.0, 25.0] {
        let sine: Vec<f64> = (0..20_000).map(|k| 3.0 * libm::sin(frequency * f64::from(k) * DT + 0.3)).collect();
        let found = density(&sine, &frequencies, 8.0);
        let power: f64 = found.iter().sum::<f64>() * step;
        assert!((power / 4.5 - 1.0).abs() < 0.03, "{power} instead of 4.5 at {frequency} rad/s");
        let peak = (0..frequencies.len()).max_by(|&i, &j| found[i].total_cmp(&found[j])).unwrap();
        assert!((frequencies[peak] / frequency - 1.0).abs() < 0.02, "{} instead of {frequency}", frequencies[peak]);
    }
}

#[test]
fn it_is_the_sum_as_it_is_written() {
    let frequencies = [0.7, 3.0, 11.0];
    let (samples, half) = (white(1234), 150);
    let found = density(&samples, &frequencies, 3.0);
    for (w, found) in frequencies.into_iter().zip(found) {
        let mut squares = 0.0;
        let mut peak = 0;
        while peak < samples.len() + half {
            let (mut re, mut im) = (0.0, 0.0);
            let first = peak.saturating_sub(half);
            for (k, sample) in (first..peak + half).zip(&samples[first..]) {
                let from_peak = k as f64 + 0.5 - peak as f64;
                let weight = libm::cos(0.5 * PI * from_peak / half as f64);
                let (sin, cos) = libm::sincos(w * k as f64 * DT);
                re += weight * sample * cos;
                im += weight * sample * sin;
            }
            squares += re * re + im * im;
            peak += half;
        }
        let expected = squares / samples.len() as f64 * DT / PI;
        assert!((found / expected - 1.0).abs() < 1e-11, "{found} instead of {expected} at {w} rad/s");
    }
}

#[test]
fn a_blow_has_every_frequency_alike_whenever_it_falls() {
    let frequencies = spaced(1.0, 100.0, 64);
    for (at, samples) in [(0, 1), (0, 10), (0, 1000), (77, 400), (999, 1000)] {
        let mut blow = vec![0.0; samples];
        blow[at] = 100.0;
        let level = 1e4 / samples as f64 * DT / PI;
        let found = density(&blow, &frequencies, 4.0);
        assert!(found.iter().all(|s| (s / level - 1.0).abs() < 1e-12), "{at} of {samples}");
    }
}

#[test]
fn nothing_has_no_power() {
    let frequencies = spaced(1.0, 50.0, 20);
    assert_eq!(density(&[], &frequencies, 20.0), [0.0; 20]);
    assert_eq!(density(&[0.0; 3000], &frequencies, 20.0), [0.0; 20]);
    assert!(density(&[1.0], &[], 20.0).is_empty());
}

#[test]
fn portions_do_not_matter() {
    let samples = white(3000);
    let frequencies = spaced(1.0, 200.0, 43);
    let mut portions = Spectrum::new(frequencies.clone(), DT, 10.0);
    for portion in samples.chunks(7) {
        portions.extend(portion);
        portions.density();
    }
    assert_eq!(portions.density(), density(&samples, &frequencies, 10.0));
    assert_eq!(portions.frequencies, frequencies);
}

fn displacement(dt: f64, measured: Vec<f64>) -> Record {
    forced(dt, Hold::Zero, vec![0.0; measured.len()], vec![(Quantity::DISPLACEMENT, measured)])
}

#[test]
fn a_tone_that_jumps_is_found_before_and_after() {
    let tone = |k: usize| if k < 4000 { 0.5 } else { 1.5 };
    let measured: Vec<f64> = (0..8000).map(|k| libm::sin(tone(k) * k as f64)).collect();
    let record = displacement(0.01, measured);
    let spectrogram = Spectrogram::windows(&record, 0, 8000).unwrap().run();
    let peak = |time: f64| {
        let column = &spectrogram.decibels[((time - spectrogram.start) / spectrogram.step) as usize];
        let place = (0..column.len()).max_by(|&a, &b| column[a].total_cmp(&column[b])).unwrap();
        place as f64 * spectrogram.resolution * 0.01
    };
    assert!((peak(20.0) - 0.5).abs() < 0.02 && (peak(60.0) - 1.5).abs() < 0.02, "{} {}", peak(20.0), peak(60.0));
    assert!(Spectrogram::windows(&record, 0, 100).is_none());
}

#[test]
fn windows_come_one_by_one() {
    let measured: Vec<f64> = (0..30_000).map(|k| 3.0 * libm::sin(0.7 * f64::from(k))).collect();
    let record = displacement(0.02, measured);
    let mut windows = Spectrogram::windows(&record, 0, 30_000).unwrap();
    let mut pieces = 1;
    while !windows.advance(&mut || false) {
        pieces += 1;
    }
    assert_eq!(pieces, 1 + (30_000 - 1024) / 256);
}
