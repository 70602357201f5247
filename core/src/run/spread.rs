//! The prediction of a step once more, for a picture of it.

use kalmanscope_filters::engine::design::{Method, Rule};
use kalmanscope_filters::filter::{Algorithm, States, Step, System as _};
use kalmanscope_filters::linalg::{Matrix, Vector, lower_root};
use kalmanscope_filters::{Channel, Hold};

use crate::run::Run;
use crate::run::estimator::FilterContext;
use crate::{FilterSettings, Model};

/// The way of one channel through the prediction of a sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// The derivative of the predicted channel with respect to its own value before.
    pub slope: f64,
    /// The number of parts of the step.
    pub parts: usize,
    /// The sigma points in the channel's unit: those of the first part before it, and those of the last part after it. Empty for a filter
    /// that draws none.
    pub points: [Vec<f64>; 2],
}

impl Spread {
    /// The prediction of sample `k`, counted from the first one that is kept, by the filter at `place` of a run. `None` where that is not
    /// one step of a mean and a covariance, or where the sample before is not kept.
    ///
    /// Source: as [`FilterKind::reference`](crate::FilterKind::reference) says of the filter.
    pub fn of(run: &Run, place: usize, channel: Channel, k: usize) -> Option<Self> {
        let (scenario, record, estimates) = (run.scenario(), run.record(), run.estimates().get(place)?);
        let settings = scenario.filters.get(place)?;
        let context = FilterContext::over(record, scenario, settings);
        let (model, at, before) = (context.model(settings), estimates.place(channel)?, k.checked_sub(1)?);
        let Algorithm::Gaussian(method) = settings.kind.info().algorithm else { return None };
        let (n, cov) = (model.size(), estimates.cov(before));
        if context.is_timed || !is_one_step(settings, &model) || cov.len() != n * n {
            return None;
        }
        let delays = settings.delays(record.dt());
        let force = |k: usize| record.delayed_force(k, delays.input);
        let ends = [before, if context.hold == Hold::First { k } else { before }].map(force);
        let mut forces = context.forces(settings);
        forces.take(record, k, delays.input);
        let whole = Step { inputs: forces.over(ends), hold: context.hold, dt: record.dt() };
        let mut system = States::new(model.state.clone());
        let parts = context.steps(settings);
        let mut move_part = |state: &mut Vector, part: usize| {
            system.advance(state.as_mut_slice(), whole.part(part, parts));
        };
        let (mut mean, unit) = model.to_state(estimates.mean(before));
        let step = 1e-6 * (1e-3 + mean[at].abs());
        let [high, low] = [step, -step].map(|step| {
            let mut state = mean.clone();
            state[at] += step;
            (0..parts).for_each(|part| move_part(&mut state, part));
            state[at]
        });
        let in_unit =
            |state: &Vector| if model.state.logarithms.contains(&at) { libm::exp(state[at]) } else { state[at] };
        let mut spread = Self { slope: (high - low) / (2.0 * step), parts, points: [Vec::new(), Vec::new()] };
        if let Method::SigmaPoints(rule) | Method::SquareRoot(rule) = method(&settings.method(&context.plant), n) {
            let mut cov = Matrix::from_fn(n, n, |i, j| cov[i * n + j] * unit[i] * unit[j]);
            for part in 0..parts {
                let before = points(rule, &mean, &cov)?;
                let mut after = before.clone();
                after.iter_mut().for_each(|point| move_part(point, part));
                (mean, cov) = moments(rule, &after);
                if part == 0 {
                    spread.points[0] = before.iter().map(in_unit).collect();
                }
                spread.points[1] = after.iter().map(in_unit).collect();
            }
        }
        Some(spread)
    }
}

/// Whether a filter predicts by moving one mean and one covariance, which it reports as they are.
fn is_one_step(settings: &FilterSettings, model: &Model) -> bool {
    let is_alone = settings.guesses <= 1 && settings.process_scales <= 1 && settings.walk == 0.0;
    let is_reported = settings.bounds.is_empty() && settings.plucks.is_empty();
    is_alone && is_reported && model.state.forgotten.is_empty() && model.place(Channel::WHITE_FORCE).is_none()
}

fn points(Rule { spread, .. }: Rule, mean: &Vector, cov: &Matrix) -> Option<Vec<Vector>> {
    let root = lower_root(cov).ok()? * libm::sqrt(spread);
    let pairs = root.column_iter().flat_map(|column| [mean + column, mean - column]);
    Some(std::iter::once(mean.clone()).chain(pairs).collect())
}

/// Mean and covariance by a rule, about the centre's image.
fn moments(Rule { spread, offset }: Rule, points: &[Vector]) -> (Vector, Matrix) {
    let n = points[0].len();
    let (mut shift, mut cov) = (Vector::zeros(n), Matrix::zeros(n, n));
    for point in &points[1..] {
        let from_centre = (point - &points[0]) / libm::sqrt(2.0 * spread);
        shift += &from_centre / libm::sqrt(2.0 * spread);
        cov += &from_centre * from_centre.transpose();
    }
    cov += &shift * shift.transpose() * offset;
    (&points[0] + shift, cov)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FilterKind, Scenario};

    fn run(kind: FilterKind, text: &str) -> Run {
        let mut scenario = Scenario::from_toml(&format!("duration = 2.0\n{text}")).unwrap();
        scenario.filters.truncate(1);
        scenario.filters[0].kind = kind;
        let mut run = Run::new(&scenario).unwrap();
        run.finish();
        run
    }

    #[test]
    fn the_points_of_a_step_have_the_moments_that_the_filter_predicts() {
        for (kind, count) in [(FilterKind::UKF, 9), (FilterKind::SR_UKF, 9), (FilterKind::CKF, 9), (FilterKind::EKF, 0)]
        {
            let run = run(kind, "");
            let estimates = &run.estimates()[0];
            for channel in [Channel::DISPLACEMENT, Channel::NATURAL_FREQUENCY] {
                let (k, at) = (80, estimates.place(channel).unwrap());
                let Spread { slope, points: [before, after], .. } = Spread::of(&run, 0, channel, k).unwrap();
                assert!(slope > 0.9 && slope < 1.0 + 1e-9, "{slope}");
                assert_eq!([before.len(), after.len()], [count; 2]);
                if count == 0 {
                    continue;
                }
                let (n, m) = (estimates.channels().len(), estimates.sensors().len());
                let (gain, e, s) = (estimates.gain(k), estimates.innovation(k), estimates.innovation_cov(k));
                let shift: f64 = (0..m).map(|a| gain[a * n + at] * e[a]).sum();
                let known = |a: usize| (0..m).map(move |b| gain[a * n + at] * s[a * m + b] * gain[b * n + at]);
                let known: f64 = (0..m).flat_map(known).sum();
                let q = run.scenario().filters[0].process_std[channel].powi(2);
                let lambda = run.scenario().filters[0].fading;
                let rule = if kind == FilterKind::CKF { Rule::cubature(n) } else { Rule::UNSCENTED };
                let all: Vec<Vector> = after.iter().map(|x| Vector::from_vec(vec![*x])).collect();
                let (mean, cov) = moments(rule, &all);
                let (predicted, variance) = (estimates.mean(k)[at] - shift, estimates.variances(at)[k] + known);
                assert!((mean[0] - predicted).abs() < 1e-12 * predicted.abs().max(1.0), "{kind:?} {channel:?}");
                assert!((lambda * cov[(0, 0)] + q - variance).abs() < 1e-9 * variance, "{kind:?} {channel:?}");
            }
        }
    }

    #[test]
    fn a_filter_without_one_step_has_no_points() {
        let run = run(FilterKind::ENKF, "");
        assert_eq!(Spread::of(&run, 0, Channel::DISPLACEMENT, 5), None);
        assert_eq!(Spread::of(&run, 0, Channel::DISPLACEMENT, 0), None);
    }
}
