//! A batch of runs, sample by sample.

mod repair;

use kalmanscope_core::Stop;
use kalmanscope_core::internals::kernel::Gaussian;
use kalmanscope_core::internals::kernel::Output;
use kalmanscope_core::score::{Look, Outcome};

use crate::belief::{Belief, Noise};
use crate::expect;
use crate::lane::{LANES, Lane, Mask};
use crate::observation::{Active, MOST, Observations, Run};
use crate::plant::Plant;
use crate::sums::{Sums, last_fifth};
use crate::update::{self, Correction};
use crate::{linearised, sigma_points};

/// A batch: the runs, and the state of all lanes.
struct Batch<'a, P, T, const N: usize, const E: usize> {
    runs: &'a [Run<'a, P, N>; LANES],
    observations: &'a Observations<'a, N>,
    noise: Noise<T, N>,
    /// R of each sensor.
    variances: Vec<T>,
    belief: Belief<T, N, E>,
    sums: Sums<T, N>,
    outcomes: [Option<Outcome>; LANES],
    /// Lanes with a stopped filter.
    stopped: [bool; LANES],
    looks: [Vec<Look>; LANES],
}

/// Runs the filters (UKFs if `UKF`, else KFs and EKFs), and looks at them at these samples, which are in order. A lane
/// without an outcome is left to the single filter.
#[inline(always)]
pub(crate) fn run<P: Plant<N>, T: Lane, const N: usize, const E: usize, const UKF: bool>(
    token: T::Token,
    runs: &[Run<'_, P, N>; LANES],
    observations: &Observations<'_, N>,
    samples: &[usize],
) -> [Option<Outcome>; LANES] {
    let initial = runs.map(|run| run.filter.initial.clone());
    let mut batch = Batch {
        runs,
        observations,
        noise: Noise::new(token, runs.map(|run| run.filter)),
        variances: observations.sensors.iter().map(|s| T::from_array(token, s.variance)).collect(),
        belief: Belief::new(token, &initial),
        sums: Sums::new(token),
        outcomes: [const { None }; LANES],
        stopped: [false; LANES],
        looks: [const { Vec::new() }; LANES],
    };
    let (dt, decays) = (runs[0].filter.dt, runs[0].filter.plant.eta() != 0.0);
    let recent = last_fifth(observations.samples);
    let mut force = observations.force.at::<T>(token, 0);
    let mut samples = samples.iter();
    let mut next = samples.next().copied();
    let nees = batch.compare(token, 0, recent);
    while next == Some(0) {
        batch.look(nees, T::splat(token, f64::NAN), 0);
        next = samples.next().copied();
    }
    for k in 1..observations.samples {
        let before = batch.belief;
        let force_before = force;
        force = observations.force.at(token, k);
        let (active, count, agree) = look(token, observations, &batch.variances, k);
        let Batch { belief, noise, .. } = &mut batch;
        let predicted = match (UKF, decays) {
            (false, false) => linearised::predict::<P, T, N, E>(belief, force_before, dt, noise),
            (true, false) => sigma_points::predict::<P, T, N, E>(belief, force_before, dt, noise),
            (false, true) => T::apart(
                token,
                #[inline(always)]
                || linearised::predict_decaying::<P, T, N, E>(belief, force_before, dt, noise),
            ),
            (true, true) => T::apart(
                token,
                #[inline(always)]
                || sigma_points::predict_decaying::<P, T, N, E>(belief, force_before, dt, noise),
            ),
        };
        let Correction { mut nis, mut determinant, holds } =
            condition::<P, T, N, E, UKF>(belief, &active, count, force);
        let holds = holds & predicted & agree;
        if !holds.all() {
            [nis, determinant] = batch.repair(&before, holds, [nis, determinant], k, count as u32);
            if batch.stopped == [true; LANES] {
                return batch.outcomes;
            }
        }
        batch.sums.measure(nis, determinant, count as u32);
        let nees = batch.compare(token, k, recent);
        while next == Some(k) {
            batch.look(nees, nis, k);
            next = samples.next().copied();
        }
    }
    batch.finish()
}

/// The sensors with a measurement at sample `k`, their number, and the lanes with measurements of exactly these
/// sensors.
#[inline(always)]
fn look<T: Lane, const N: usize>(
    token: T::Token,
    observations: &Observations<'_, N>,
    variances: &[T],
    k: usize,
) -> ([Active<T>; MOST], usize, T::Mask) {
    let zero = T::splat(token, 0.0);
    let mut active = [Active { output: Output::State(0), value: zero, variance: zero }; MOST];
    let (mut count, mut agree) = (0, T::always(token));
    for (sensor, &variance) in observations.sensors.iter().zip(variances) {
        let value = sensor.measured.at::<T>(token, k);
        if sensor.measured.of_lane(0, k).is_nan() {
            agree = agree & !value.le(value);
        } else if count < MOST {
            active[count] = Active { output: sensor.output, value, variance };
            count += 1;
        }
    }
    (active, count, agree)
}

/// Conditions the beliefs on these measurements.
#[inline(always)]
fn condition<P: Plant<N>, T: Lane, const N: usize, const E: usize, const UKF: bool>(
    belief: &mut Belief<T, N, E>,
    active: &[Active<T>; MOST],
    count: usize,
    force: T,
) -> Correction<T> {
    use Output::State;
    let &[a, b, c] = active;
    match (count, a.output, b.output) {
        (0, ..) => Correction { nis: force.of(0.0), determinant: force.of(1.0), holds: belief.is_valid() },
        (1, State(i), _) => by_components(belief, [i], &[a]),
        (2, State(0), State(1)) => update::by_components(belief, [0, 1], &[a, b]),
        (2, State(i), State(j)) => by_components(belief, [i, j], &[a, b]),
        (1, ..) => expected::<P, T, N, E, UKF, 1>(belief, &[a], force),
        (2, ..) => expected::<P, T, N, E, UKF, 2>(belief, &[a, b], force),
        _ => expected::<P, T, N, E, UKF, 3>(belief, &[a, b, c], force),
    }
}

/// [`update::by_components`] in its own function, shared by all kinds of filters.
#[inline(always)]
fn by_components<T: Lane, const N: usize, const E: usize, const M: usize>(
    belief: &mut Belief<T, N, E>,
    components: [usize; M],
    active: &[Active<T>; M],
) -> Correction<T> {
    T::apart(
        belief.mean[0].token(),
        #[inline(always)]
        || update::by_components(belief, components, active),
    )
}

/// Conditions the beliefs on sensors of which some read a rate.
#[inline(always)]
fn expected<P: Plant<N>, T: Lane, const N: usize, const E: usize, const UKF: bool, const M: usize>(
    belief: &mut Belief<T, N, E>,
    active: &[Active<T>; M],
    force: T,
) -> Correction<T> {
    T::apart(
        force.token(),
        #[inline(always)]
        || {
            let (expected, holds) = if UKF {
                expect::by_sigma_points::<P, T, N, E, M>(belief, active, force)
            } else {
                expect::linearised::<P, T, N, E, M>(belief, active, force)
            };
            let correction = update::by_expected(belief, &expected, active);
            Correction { holds: correction.holds & holds, ..correction }
        },
    )
}

impl<P: Plant<N>, T: Lane, const N: usize, const E: usize> Batch<'_, P, T, N, E> {
    /// Takes in the beliefs at sample `k`; returns their NEES, NaN where there is none.
    #[inline(always)]
    fn compare(&mut self, token: T::Token, k: usize, recent: usize) -> T {
        let Some(columns) = &self.observations.truth else { return T::splat(token, f64::NAN) };
        let mut truth = self.belief.mean;
        for i in 0..N {
            truth[i] = columns[i].at(token, k);
        }
        self.sums.compare::<P, E>(&self.belief, truth, k, k >= recent)
    }

    /// Looks at the filters that continue at sample `k`.
    #[cold]
    #[inline(never)]
    fn look(&mut self, nees: T, nis: T, k: usize) {
        let (nees, nis, beliefs) = (nees.to_array(), nis.to_array(), self.belief.split());
        for lane in (0..LANES).filter(|&lane| !self.stopped[lane]) {
            let belief = &beliefs[lane];
            let channel = |place: usize| {
                let error = self.observations.error(lane, k, belief, place);
                error.map_or([f64::NAN; 2], |[error, _]| [error, belief.cov[(place, place)].sqrt()])
            };
            let mut sensors = self.observations.sensors.iter();
            let has_measurement = k > 0 && sensors.any(|sensor| !sensor.measured.of_lane(lane, k).is_nan());
            let nis = if has_measurement { nis[lane] } else { f64::NAN };
            self.looks[lane].push(Look { nees: nees[lane], nis, channels: (0..N).map(channel).collect() });
        }
    }

    /// The outcome of a lane after `samples` samples.
    fn outcome(&mut self, lane: usize, samples: usize, last: &Gaussian<N>, stop: Option<Stop>) -> Option<Outcome> {
        let first = &self.runs[lane].filter.initial;
        let outcome = self.sums.outcome(lane, samples, [first, last], self.observations, stop)?;
        Some(Outcome { looks: std::mem::take(&mut self.looks[lane]), ..outcome })
    }

    /// The outcomes of the lanes that have not stopped.
    #[inline(never)]
    fn finish(mut self) -> [Option<Outcome>; LANES] {
        let beliefs = self.belief.split();
        for lane in 0..LANES {
            if !self.stopped[lane] {
                self.outcomes[lane] = self.outcome(lane, self.observations.samples, &beliefs[lane], None);
            }
        }
        self.outcomes
    }
}
