//! Whether the innovations have a line in their spectrum, which a mode that the model lacks would leave.

use crate::judgement::diagnosis::case::Case;
use crate::judgement::diagnosis::evidence::{Evidence, Subject, Test};
use crate::judgement::diagnosis::words::short;
use crate::numbers::diagnostics::chi_squared;

/// Limits a peak that does no harm, relative to the mean power.
const TOLERANCE: f64 = 5.0;

pub(super) static TEST: Test = Test {
    name: "lines in the spectrum of the innovations",
    statistic: "the largest power of a Welch periodogram over the mean power",
    distribution: "the largest of L/2 sums of squares, χ² with two degrees of freedom a window",
    source: "Welch (1967), The use of fast Fourier transform for the estimation of power spectra",
    reading: "a peak at the frequency of a mode: the model lacks it, or has it elsewhere",
    run,
};

fn run(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    for one in &case.sensors {
        let Some((power, turn)) = one.periodogram.peak() else { continue };
        let statistic = power / one.periodogram.mean();
        if !statistic.is_finite() {
            continue;
        }
        let degrees = 2 * one.periodogram.windows as u32;
        let one_p = chi_squared::upper_tail(statistic * f64::from(degrees), degrees).unwrap_or(1.0);
        found.push(Evidence {
            statistic,
            p_value: (one_p * one.periodogram.power.len() as f64).min(1.0),
            effect: statistic / TOLERANCE,
            speaks_for: case.pattern(one),
            sentence: format!(
                "the innovations of the {} have a line of {} times the mean power at {} rad/s",
                one.sensor.key(),
                short(statistic),
                short(turn / case.record.dt())
            ),
            ..Evidence::new(test, Subject::Sensor(one.sensor), case)
        });
    }
}
