//! The information that a record has on the settings that were tuned: how far each may be off; and remarks on the result.

use kalmanscope_core::filter::Matrix;
use kalmanscope_core::{Axis, Spacing};
use kalmanscope_diagnosis::VerdictKind;
use kalmanscope_records::task::pause;
use thiserror::Error;

use super::{Cost, FORBIDDEN, Goal, Try};

/// The first step: a share of the value, or of a linear axis.
const FIRST: f64 = 0.05;

/// A good step lowers the log likelihood by this, in the mean of both sides: less is rounding, more no parabola.
const FALL: std::ops::RangeInclusive<f64> = 0.1..=1.0;

const WANTED: f64 = 0.4;

const TRIES: usize = 8;

/// If the maximum is further away than this, in its own σ, the curvature here is not that at the maximum.
const NEAR: f64 = 0.5;

/// The values two standard deviations below and above each setting, where all of them have a maximum here. Settings on a logarithmic axis
/// count by their logarithms. The inverse of the matrix of second derivatives, the observed information, is the covariance of the
/// error of a maximum-likelihood estimate over a long record.
///
/// Source: Efron and Hinkley (1978), Assessing the accuracy of the maximum likelihood estimator: observed versus expected Fisher
/// information; Åström (1980), Maximum likelihood and prediction error methods (for the likelihood of innovations).
pub(super) async fn bands(cost: &Cost, Try { values, score }: Try, runs: &mut u64) -> Option<Vec<[f64; 2]>> {
    let (n, best) = (values.len(), -score);
    let step = |axis: &Axis| match axis.spacing {
        Spacing::Logarithmic => FIRST,
        Spacing::Linear => FIRST * (axis.to - axis.from),
    };
    let mut steps: Vec<f64> = cost.axes.iter().map(step).collect();
    let mut cost_at = |steps: &[f64], axes: &[usize], sign: f64| {
        let mut values = values.clone();
        for &axis in axes {
            values[axis] = moved(cost.axes[axis].spacing, values[axis], sign * steps[axis]);
        }
        *runs += 1;
        cost.of_scenario(&cost.with_values(&values))
    };
    let mut beside: Vec<[f64; 2]> = Vec::new();
    for axis in 0..n {
        for tries in 1.. {
            pause().await;
            let sides = [-1.0, 1.0].map(|sign| cost_at(&steps, &[axis], sign));
            let fall = 0.5 * (sides[0] + sides[1]) - best;
            if FALL.contains(&fall) || tries > TRIES {
                beside.push(sides);
                break;
            }
            steps[axis] *= match fall {
                fall if fall > 0.0 && fall < FORBIDDEN / 4.0 => (WANTED / fall).sqrt().clamp(0.1, 10.0),
                fall if fall > 0.0 => 0.2,
                _ => 3.0,
            };
        }
    }
    let mut second = Matrix::zeros(n, n);
    for i in 0..n {
        second[(i, i)] = (beside[i][1] + beside[i][0] - 2.0 * best) / (steps[i] * steps[i]);
        for j in i + 1..n {
            pause().await;
            // Two corners and the sides say as much as all four corners, by half as many runs.
            let both: f64 = [-1.0, 1.0].iter().map(|sign| cost_at(&steps, &[i, j], *sign)).sum();
            let alone: f64 = [i, j].iter().map(|&axis| beside[axis].iter().sum::<f64>()).sum();
            second[(i, j)] = (both - alone + 2.0 * best) / (2.0 * steps[i] * steps[j]);
            second[(j, i)] = second[(i, j)];
        }
    }
    let slope: Vec<f64> =
        beside.iter().zip(&steps).map(|([below, above], step)| (above - below) / (2.0 * step)).collect();
    let is_known = beside.iter().flatten().all(|cost| *cost < FORBIDDEN);
    let cov = second.cholesky().filter(|_| is_known)?.inverse();
    let away: Vec<f64> = (0..n).map(|i| (0..n).map(|j| cov[(i, j)] * slope[j]).sum::<f64>()).collect();
    let square: f64 = away.iter().zip(&slope).map(|(a, b)| a * b).sum();
    let band = |axis: usize| {
        let spread = 2.0 * cov[(axis, axis)].sqrt();
        [-spread, spread].map(|by| moved(cost.axes[axis].spacing, values[axis], by))
    };
    (square <= NEAR * NEAR * n as f64).then(|| (0..n).map(band).collect())
}

fn moved(spacing: Spacing, value: f64, by: f64) -> f64 {
    match spacing {
        Spacing::Logarithmic => value * libm::exp(by),
        Spacing::Linear => value + by,
    }
}

const EDGE: f64 = 0.01;

/// A setting is flat if the score allows multiplying it by this factor.
const TURN: f64 = 2.0;

/// A warning about a result.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TuneRemark {
    /// No values are better than the scenario's own.
    #[error("No values are better than the present ones.")]
    NoBetter,
    /// The record has little information on this setting: half and twice the value are as good.
    #[error("The record hardly determines {0}: half and twice the value are as good.")]
    Flat(String),
    /// The best value of this setting is at an end of its axis.
    #[error("The best value of {0} is at an end of its range: widen the range, or doubt the model.")]
    Edge(String),
    /// The goal prefers a filter with a bad verdict.
    #[error(
        "{} is best for a filter whose verdict is “{}”: no Q or R replaces what the model lacks.", .0.subject(), .1.name()
    )]
    Inconsistent(Goal, VerdictKind),
}

pub(super) fn remarks(cost: &Cost, path: &[Try], verdict: Option<VerdictKind>) -> Vec<TuneRemark> {
    let mut remarks = Vec::new();
    let [_, .., best] = path else { return vec![TuneRemark::NoBetter] };
    for (place, axis) in cost.axes.iter().enumerate() {
        let share = axis.share_of(best.values[place]);
        if !(EDGE..=1.0 - EDGE).contains(&share) {
            remarks.push(TuneRemark::Edge(axis.key.clone()));
            continue;
        }
        let turned = |factor: f64| {
            let mut values = best.values.clone();
            values[place] = match axis.spacing {
                Spacing::Logarithmic => values[place] * factor,
                Spacing::Linear => values[place] + (factor - 1.0) * 0.1 * (axis.to - axis.from),
            };
            best.score + cost.of_scenario(&cost.with_values(&values))
        };
        if turned(TURN).max(turned(1.0 / TURN)) < cost.goal.indifferent() {
            remarks.push(TuneRemark::Flat(axis.key.clone()));
        }
    }
    let is_bad = |kind: &VerdictKind| {
        !matches!(kind, VerdictKind::Consistent | VerdictKind::Recovered | VerdictKind::NotIdentifiable)
    };
    remarks.extend(verdict.filter(is_bad).map(|kind| TuneRemark::Inconsistent(cost.goal, kind)));
    remarks
}
