//! A filter: predict and update.
//!
//! ```text
//! predict   y⁻ = g-step of y,  P⁻ = λ cov(g-step of y) + Q
//! update    e = z - h(y⁻),  S = H P⁻ Hᵀ + R,  K = P⁻ Hᵀ S⁻¹,  y = y⁻ + K e,  P = (I - K H) P⁻ (I - K H)ᵀ + K R Kᵀ
//! ```

use super::belief::{Belief, Noise};
use super::columns::Rooted;
use super::design::{Design, Method};
use super::fault::Held;
use super::learning::Learning;
#[cfg(not(target_arch = "wasm32"))]
use super::learning::Learnt;
use super::level::Level;
use super::linearised::Linearised;
use super::number::{Mask, Number};
use super::share::Share;
use super::sigma_points::SigmaPoints;
use super::square_root::{SquareRoot, may_have_root, std};
use super::step::Step;
use super::update::{Observation, Told, Update};
use crate::FilterError;

/// Filters of one design, one a lane, with their memory: a step needs no other.
#[derive(Clone, Debug)]
pub(crate) struct Filter<T: Number, L> {
    level: L,
    design: Design,
    noise: Noise<T>,
    of_share: Share<T>,
    /// The variance of the white force.
    white: T,
    /// The belief after the last predict or update.
    pub belief: Belief<T>,
    linearised: Linearised<T>,
    points: SigmaPoints<T>,
    /// The root of the covariance, of a filter that holds one.
    root: Option<SquareRoot<T>>,
    update: Update<T>,
    learning: Option<Box<Learning<T>>>,
    /// The lanes for which the parts of the last step hold.
    held: Held<T::Mask>,
}

/// The last update of a filter of one run, and what it has learnt.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) struct Parts<'a> {
    pub(crate) belief: &'a Belief<f64>,
    pub(crate) update: &'a Update<f64>,
    pub(crate) noise: &'a Noise<f64>,
    /// The place of a white force and its variance.
    pub(crate) white: Option<(usize, f64)>,
    /// `None` of a filter that learns nothing.
    pub(crate) learnt: Option<Learnt<'a>>,
    /// Whether it learns Q or R.
    pub(crate) is_adaptive: bool,
}

#[cfg(not(target_arch = "wasm32"))]
impl<L: Level> Filter<f64, L> {
    /// The last update and what the filter has learnt.
    pub(crate) fn parts(&self) -> Parts<'_> {
        let Self { design, belief, update, noise, learning, white, .. } = self;
        Parts {
            belief,
            update,
            noise,
            white: design.white.map(|(place, _)| (place, *white)),
            learnt: learning.as_ref().map(|learning| learning.learnt()),
            is_adaptive: design.adaptation.is_on(),
        }
    }
}

#[cfg(not(target_arch = "wasm32"))]
impl<T: Number, L: Level> Filter<T, L> {
    /// Whether the filters weigh, learn or jump.
    pub(crate) fn learns(&self) -> bool {
        self.learning.is_some()
    }

    /// The belief, and the last update.
    pub(crate) fn told(&mut self) -> (&Belief<T>, &mut Update<T>) {
        (&self.belief, &mut self.update)
    }
}

impl<T: Number, L: Level> Filter<T, L> {
    /// Filters that begin with a belief.
    pub(crate) fn new(level: L, design: Design, belief: Belief<T>, mut noise: Noise<T>, white: T) -> Self {
        let Design { model, readings, method, .. } = &design;
        let root = match *method {
            Method::SquareRoot(rule) if const { may_have_root::<T, L>() } => {
                let mut root = SquareRoot::new(model, rule, readings.len());
                // The covariance is diagonal: it has a root.
                root.take(level, &belief.cov);
                Some(root)
            }
            _ => None,
        };
        Self {
            linearised: Linearised::new(model),
            points: SigmaPoints::new(model),
            root,
            update: Update::new(model, readings.len()),
            learning: Learning::new(&design, &belief, &mut noise),
            held: Held::new(),
            level,
            design,
            of_share: Share::new(&noise),
            noise,
            white,
            belief,
        }
    }

    /// Carries the beliefs over one step, from a sample to the next, with the recorded forces over mass of both \[m/s²\]. The noise
    /// is added in the last of its parts.
    ///
    /// A white force is another one from the next sample on, or from the middle of the step ([`Course`](super::course::Course)).
    #[cfg(not(target_arch = "wasm32"))]
    #[inline(always)]
    pub(crate) fn predict(&mut self, forces: [T; 2]) {
        self.predict_share(1.0, forces);
    }

    /// The same over a share of a step, with its share of the noise. A white force and jumps belong to whole steps.
    #[inline(always)]
    pub(crate) fn predict_share(&mut self, share: f64, forces: [T; 2]) {
        let Self { learning, design, noise, .. } = self;
        let has_widened = learning.as_mut().is_some_and(|learning| learning.widen(design, noise));
        self.carry(share, forces);
        if let Some(learning) = self.learning.as_ref().filter(|_| has_widened) {
            learning.narrow(&mut self.noise);
        }
    }

    #[inline(always)]
    fn carry(&mut self, share: f64, forces: [T; 2]) {
        let Design { has_slope, dt, substeps, white, .. } = self.design;
        let [begin, end] = forces;
        let whole = Step { forces: [begin, if has_slope { end } else { begin }], has_slope, dt: dt * share };
        let (parts, renewed) = white.map_or((substeps, 0), |(_, course)| course.steps(substeps));
        let yes = T::Mask::of(true);
        let mut held = Rooted { holds: yes, is_finite: yes };
        for i in 0..parts {
            let rooted = if parts == 1 { self.advance(&whole) } else { self.advance(&whole.part(i, parts)) };
            held = Rooted {
                holds: held.holds & rooted.holds,
                is_finite: held.is_finite & (!held.holds | rooted.is_finite),
            };
            self.spread(share, i + 1 == parts);
            if let Some((place, _)) = white.filter(|_| i + 1 == renewed) {
                let Self { level, belief, root, white, .. } = self;
                match root {
                    Some(root) if const { may_have_root::<T, L>() } => root.renew(*level, belief, place, *white),
                    _ => belief.renew(place, *white),
                }
            }
        }
        self.held.predicted = held;
    }

    /// Moves the beliefs, without noise.
    #[inline(always)]
    fn advance(&mut self, step: &Step<T>) -> Rooted<T::Mask> {
        let Self { level, design: Design { model, method, .. }, belief, linearised, points, root, .. } = self;
        match (*method, root) {
            (Method::Linearised(propagation, _), _) => linearised.advance(*level, propagation, model, belief, step),
            (Method::SquareRoot(_), Some(root)) if const { may_have_root::<T, L>() } => {
                root.advance(*level, model, belief, step);
            }
            (Method::SigmaPoints(rule) | Method::SquareRoot(rule), _) => {
                return points.advance(*level, rule, model, belief, step);
            }
        }
        Rooted { holds: T::Mask::of(true), is_finite: T::Mask::of(true) }
    }

    /// Ends a part of a prediction, with the noise in the last one.
    #[inline(always)]
    fn spread(&mut self, share: f64, is_last: bool) {
        let Self { level, belief, noise, of_share, root, .. } = self;
        let noise = of_share.of(share, noise);
        match (root, is_last) {
            (Some(root), true) if const { may_have_root::<T, L>() } => level.apart(
                #[inline(always)]
                || {
                    root.spread(
                        *level,
                        noise.fading,
                        #[inline(always)]
                        |i, row| row[i] = std(noise.process[i]),
                    );
                },
            ),
            (Some(root), false) if const { may_have_root::<T, L>() } => root.spread(*level, T::of(1.0), |_, _| ()),
            (_, true) => level.apart(
                #[inline(always)]
                || belief.spread(*level, noise),
            ),
            (_, false) => belief.clamp(),
        }
    }

    /// Conditions the beliefs on one sample of the sensors, while `force` acts. A measurement that is NaN skips its
    /// sensor. The last step holds for [some lanes](Told::holds); [`Self::reason`] gives the reason for the others.
    #[inline(always)]
    pub(crate) fn update(&mut self, force: T, measured: &[T]) -> Told<T> {
        let Self { level, design, noise, belief, update, held, root, learning, .. } = self;
        let observation = Observation { force, measured };
        match learning {
            None => update.condition(*level, design, belief, root.as_mut(), noise, observation, held),
            Some(learning) => learning.condition(*level, design, belief, noise, observation, update, held),
        }
    }

    /// Gives a lane a belief that makes no trouble.
    pub(crate) fn park(&mut self, lane: usize) {
        self.belief.park(lane);
        if const { may_have_root::<T, L>() }
            && let Some(root) = &mut self.root
        {
            root.park(lane);
        }
    }

    /// Makes the covariance after a prediction that of the root, if there is one.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn square(&mut self) {
        let Self { level, belief, root, .. } = self;
        if const { may_have_root::<T, L>() }
            && let Some(root) = root
        {
            root.square(*level, &mut belief.cov);
        }
    }

    /// Makes the covariance symmetric to the last bit, from its lower triangle.
    #[cfg(not(target_arch = "wasm32"))]
    #[inline(always)]
    pub(crate) fn complete(&mut self) {
        let n = self.level.size(self.belief.size());
        super::columns::mirror(self.level, &mut self.belief.cov[..n * n], n);
    }

    #[cfg(not(target_arch = "wasm32"))]
    /// Whether the forces that count in a step are finite in all lanes.
    pub(crate) fn are_finite(&self, [begin, end]: [T; 2]) -> bool {
        begin.is_finite().all() && (!self.design.has_slope || end.is_finite().all())
    }

    #[cfg(not(target_arch = "wasm32"))]
    /// Whether sigma points could be drawn for the last prediction in a lane.
    pub(crate) fn is_predicted(&self, lane: usize) -> bool {
        self.held.predicted.holds.lane(lane)
    }

    /// Why the last step does not hold for a lane.
    #[cold]
    pub(crate) fn reason(&self, lane: usize) -> FilterError {
        self.held.reason(lane, || self.update.of_lane(lane))
    }

    /// ln det S of the last update in a lane.
    #[cold]
    pub(crate) fn ln_determinant(&self, lane: usize) -> f64 {
        self.update.ln_determinant(lane)
    }
}
