//! A filter: predict and update, by the equations of [`crate::filter`].

use super::belief::{FilterNoise, GaussianBelief, NoiseShare};
use super::columns::{Rooted, lower_root};
use super::design::{Design, Method};
use super::dynamics::Dynamics;
use super::level::{Baseline, Level, apart};
use super::linearised::Linearised;
use super::model::{Input, Step};
use super::number::{Mask, Number};
use super::passage::Passage;
use super::sigma_points::SigmaPoints;
use super::square_root::{SquareRoot, may_have_root, std};
use super::update::{Checks, MeasuredReadings, Target, Update, UpdateResult};
use crate::filter_error::of_root;
use crate::{FilterError, Hold};

/// Filters of one design, one a lane, with their memory. What takes a level is compiled for its instructions.
pub struct GaussianFilter<T: Number, P> {
    pub design: Design<P>,
    pub noise: FilterNoise<T>,
    pub(super) of_share: NoiseShare<T>,
    /// The variance of the white force.
    pub white: T,
    pub belief: GaussianBelief<T>,
    linearised: Linearised<T>,
    points: SigmaPoints<T>,
    root: Option<SquareRoot<T>>,
    pub update: Update<T>,
    pub(super) checks: Checks<T::Mask>,
}

impl<T: Number, P: Dynamics> GaussianFilter<T, P> {
    pub fn new(design: Design<P>, belief: GaussianBelief<T>, noise: FilterNoise<T>, white: T) -> Self {
        let Design { model, readings, method, .. } = &design;
        let root = match *method {
            Method::SquareRoot(rule) if const { may_have_root::<T, Baseline>() } => {
                let mut root = SquareRoot::new(model, rule, readings.len());
                // The covariance is diagonal: it has a root.
                root.take(Baseline, &belief.cov);
                Some(root)
            }
            _ => None,
        };
        Self {
            linearised: Linearised::new(model),
            points: SigmaPoints::new(model),
            root,
            update: Update::new(&design),
            checks: Checks::new(),
            design,
            of_share: NoiseShare::new(&noise),
            noise,
            white,
            belief,
        }
    }

    /// Takes the inputs at the ends of a share of a step. White forces and jumps belong to whole steps.
    #[inline(always)]
    pub(super) fn predict<L: Level>(&mut self, level: L, share: f64, [begin, end]: [Input<'_, T>; 2]) {
        let Design { has_slope, dt, substeps, white, .. } = self.design;
        // The compiler copies two whole inputs where it chooses between them.
        let (force, at) = if has_slope { (end.force, end.at) } else { (begin.force, begin.at) };
        let hold = if has_slope { Hold::First } else { Hold::Zero };
        let whole = Step { inputs: [begin, Input { force, at, ..begin }], hold, dt: dt * share };
        let (parts, renewed) = white.map_or((substeps, 0), |(_, course)| course.steps(substeps));
        for at in 0..self.design.model.forgotten.len() {
            let (place, time) = self.design.model.forgotten[at];
            self.renew(level, place, [T::of(libm::exp(-whole.dt / time)), T::of(0.0)]);
        }
        let part;
        let first = if parts == 1 {
            &whole
        } else {
            part = whole.part(0, parts);
            &part
        };
        self.checks.predicted = self.pass(level, share, first, parts == 1, renewed == 1);
        // The first part stands before the loop, so that a step of one part has no loop.
        for i in 1..parts {
            let before = self.checks.predicted;
            let rooted = self.pass(level, share, &whole.part(i, parts), i + 1 == parts, i + 1 == renewed);
            self.checks.predicted = before.and(rooted);
        }
        if self.update.passage.is_some() {
            self.square();
        }
        if let Some(passage) = &mut self.update.passage {
            passage.predicted.copy_from_slice(&self.belief.cov);
        }
    }

    #[inline(always)]
    fn pass<L: Level>(
        &mut self,
        level: L,
        share: f64,
        step: &Step<'_, T>,
        is_last: bool,
        renews: bool,
    ) -> Rooted<T::Mask> {
        if self.update.passage.is_some() {
            self.note_regression(level.plain(), step);
        }
        let rooted = self.advance(level, step);
        if let (Some(passage), Method::Linearised(..)) = (&mut self.update.passage, self.design.method) {
            passage.follow(&self.linearised, self.design.model.moving());
        }
        let rooted = rooted.and(self.spread(level, share, is_last));
        if let Some((place, _)) = self.design.white.filter(|_| renews) {
            self.renew(level, place, [T::of(0.0), self.white]);
        }
        rooted
    }

    fn renew<L: Level>(&mut self, level: L, place: usize, [kept, variance]: [T; 2]) {
        let Self { belief, root, update, .. } = self;
        match root {
            Some(root) if const { may_have_root::<T, L>() } => root.renew(level, belief, place, [kept, variance]),
            _ => belief.renew(place, kept, variance),
        }
        if let Some(passage) = &mut update.passage {
            passage.renew(place, kept);
        }
    }

    #[inline(never)]
    fn note_regression<L: Level>(&mut self, level: L, step: &Step<'_, T>) {
        self.square();
        let Self { design, points, belief, update, .. } = self;
        if let Some(passage) = &mut update.passage {
            passage.regress(level, design, points, belief, step);
        }
    }

    #[inline(always)]
    fn advance<L: Level>(&mut self, level: L, step: &Step<'_, T>) -> Rooted<T::Mask> {
        let Self { design: Design { model, method, .. }, belief, linearised, points, root, .. } = self;
        match (*method, root) {
            (Method::Linearised(propagation, _), _) => linearised.advance(level, propagation, model, belief, step),
            (Method::SquareRoot(_), Some(root)) if const { may_have_root::<T, L>() } => {
                root.advance(level, model, belief, step);
            }
            (Method::SigmaPoints(rule) | Method::SquareRoot(rule), _) => {
                if const { L::HAS_POINTS } {
                    return points.advance(level, rule, model, belief, step);
                }
            }
        }
        Rooted { holds: T::Mask::of(true), is_finite: T::Mask::of(true) }
    }

    #[inline(always)]
    fn spread<L: Level>(&mut self, level: L, share: f64, is_last: bool) -> Rooted<T::Mask> {
        let Self { belief, noise, of_share, root, .. } = self;
        let noise = of_share.of(share, noise);
        let mut rooted = Rooted { holds: T::Mask::of(true), is_finite: T::Mask::of(true) };
        match (&mut *root, is_last) {
            (Some(root), true) if const { may_have_root::<T, L>() } && !noise.matrix.is_empty() => {
                let n = belief.size();
                rooted = lower_root(level, &noise.matrix, &mut belief.cov, n);
                let of_noise = &belief.cov;
                root.spread(level, noise.fading, |i, row| (0..=i).for_each(|k| row[k] = of_noise[k * n + i]));
            }
            (Some(root), true) if const { may_have_root::<T, L>() } => apart!(level, {
                root.spread(
                    level,
                    noise.fading,
                    #[inline(always)]
                    |i, row| row[i] = std(noise.process[i]),
                );
            }),
            (Some(root), false) if const { may_have_root::<T, L>() } => root.spread(level, T::of(1.0), |_, _| ()),
            (_, true) => apart!(level, belief.spread(level, noise)),
            (_, false) => belief.clamp(),
        }
        rooted
    }

    /// A measurement that is NaN skips its sensor; `variances` replace the diagonal of R.
    #[inline(always)]
    pub(super) fn update<L: Level>(
        &mut self,
        level: L,
        input: Input<'_, T>,
        measured: &[T],
        variances: Option<&[T]>,
    ) -> UpdateResult<T> {
        let Self { design, noise, belief, update, checks, root, .. } = self;
        let observation = MeasuredReadings { input, measured, variances: variances.unwrap_or(&noise.sensors) };
        update.condition(level, &mut Target { design, belief, root: root.as_mut(), checks }, observation)
    }

    pub(super) fn root_rows(&mut self) -> Option<&mut Vec<T>> {
        self.root.as_mut().filter(|_| const { may_have_root::<T, Baseline>() }).map(|root| &mut root.rows)
    }

    pub(super) fn fill_process_noise(&mut self) {
        if self.noise.matrix.is_empty() {
            self.noise.fill_matrix();
            self.of_share = NoiseShare::new(&self.noise);
        }
    }

    pub(super) fn take_root(&mut self) -> Rooted<T::Mask> {
        let Self { belief, root, .. } = self;
        match root {
            Some(root) if const { may_have_root::<T, Baseline>() } => root.take(Baseline, &belief.cov),
            _ => Rooted { holds: T::Mask::of(true), is_finite: T::Mask::of(true) },
        }
    }

    pub(crate) fn widen(&mut self, variances: impl Iterator<Item = (usize, T)>) {
        self.square();
        let n = self.belief.size();
        for (place, variance) in variances {
            let entry = &mut self.belief.cov[place * (n + 1)];
            *entry = *entry + variance;
        }
        self.take_root();
    }

    /// Fails where the filter needs a root that the covariance does not have, in the first lane.
    pub fn set_belief(&mut self, mean: &[T], cov: &[T]) -> Result<(), FilterError> {
        self.belief.mean.copy_from_slice(mean);
        self.belief.cov.copy_from_slice(cov);
        let Rooted { holds, is_finite } = self.take_root();
        if holds.lane(0) { Ok(()) } else { Err(of_root(is_finite.lane(0), FilterError::IndefiniteCovariance)) }
    }

    pub fn keep_passages(&mut self) {
        self.update.passage = Some(Box::new(Passage::new(self.belief.size())));
    }

    pub fn passage(&self) -> Option<&Passage<T>> {
        self.update.passage.as_deref()
    }

    pub fn begin_passage(&mut self) {
        if let Some(mut passage) = self.update.passage.take() {
            self.square();
            passage.begin(&self.belief);
            self.update.passage = Some(passage);
        }
    }

    pub fn square(&mut self) {
        let Self { belief, root, .. } = self;
        if const { may_have_root::<T, Baseline>() }
            && let Some(root) = root
        {
            root.square(Baseline, &mut belief.cov);
        }
    }

    #[inline(always)]
    pub fn complete<L: Level>(&mut self, level: L) {
        let n = level.size(self.belief.size());
        super::columns::mirror(level, &mut self.belief.cov[..n * n], n);
    }

    /// Whether the forces that count in a step are finite in all lanes.
    pub fn are_finite(&self, [begin, end]: [Input<'_, T>; 2]) -> bool {
        begin.force.is_finite().all() && (!self.design.has_slope || end.force.is_finite().all())
    }

    pub fn is_predicted(&self, lane: usize) -> bool {
        self.checks.predicted.holds.lane(lane)
    }

    #[cold]
    pub fn reason(&self, lane: usize) -> FilterError {
        self.checks.reason(lane, &|| self.update.of_lane(lane))
    }
}
