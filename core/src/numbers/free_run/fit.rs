//! The agreement of predictions with measurements.

use std::ops::Range;

use crate::{Estimates, Record};

/// The agreement of predictions with measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Root of the mean square error, in the sensor's unit; infinite where the model has run away.
    pub rms: f64,
    /// `100 (1 - |z - ẑ| / |z - mean z|)` \[%\]: 100 for no error, 0 for a model that is no better than the mean.
    ///
    /// Source: Ljung (1999), *System Identification: Theory for the User*, section 16.4.
    pub percent: f64,
    /// The number of measurements that were compared.
    pub readings: usize,
}

/// The agreement of predictions with measurements. Missing measurements do not count.
pub fn fit(measured: &[f64], predicted: &[f64]) -> Option<Fit> {
    let pairs = || measured.iter().zip(predicted).filter(|(measured, _)| !measured.is_nan());
    let readings = pairs().count();
    if readings == 0 {
        return None;
    }
    let mean = pairs().map(|(measured, _)| measured).sum::<f64>() / readings as f64;
    let (mut error, mut spread) = (0.0, 0.0);
    for (measured, predicted) in pairs() {
        error += (measured - predicted) * (measured - predicted);
        spread += (measured - mean) * (measured - mean);
    }
    if error.is_nan() {
        error = f64::INFINITY;
    }
    let percent = if spread > 0.0 { 100.0 * (1.0 - libm::sqrt(error / spread)) } else { f64::NAN };
    Some(Fit { rms: libm::sqrt(error / readings as f64), percent, readings })
}

/// The errors of a filter's predictions one step ahead over a part: its innovations against the measurements. `None` if
/// there is nothing to compare, for example because the filter has stopped before the part.
pub fn one_step(estimates: &Estimates, record: &Record, sensor: usize, part: Range<usize>) -> Option<Fit> {
    let quantity = *record.sensors().get(sensor)?;
    let place = estimates.sensors().iter().position(|&own| own == quantity)?;
    let end = part.end.min(estimates.len()).min(record.len());
    let part = part.start.min(end)..end;
    let all = estimates.measured(record, place)?;
    let measured: Vec<f64> = part.clone().map(all).collect();
    let predicted: Vec<f64> = part.clone().map(|k| all(k) - estimates.innovation(k)[place]).collect();
    // The first sample has no prediction.
    let skip = predicted.iter().zip(&measured).take_while(|(p, m)| p.is_nan() && !m.is_nan()).count();
    fit(&measured[skip..], &predicted[skip..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fits_are_shares_of_the_spread() {
        let measured = [1.0, -1.0, f64::NAN, 1.0, -1.0];
        let exact = fit(&measured, &[1.0, -1.0, 5.0, 1.0, -1.0]).unwrap();
        assert_eq!((exact.rms, exact.percent, exact.readings), (0.0, 100.0, 4));
        assert_eq!(fit(&measured, &[0.0; 5]).unwrap().percent, 0.0);
        assert_eq!(fit(&measured, &[f64::NAN; 5]).unwrap().rms, f64::INFINITY);
        assert_eq!(fit(&[f64::NAN], &[0.0]), None);
    }
}
