//! Warnings about a tuned filter.

use std::fmt;

use super::cost::Cost;
use super::{Goal, Try};
use kalmanscope_core::{Spacing, VerdictKind};

/// A setting at this share of its axis from an end is at that end.
const EDGE: f64 = 0.01;

/// A setting is flat if the score allows multiplying it by this factor.
const TURN: f64 = 2.0;

/// A warning about a result.
#[derive(Clone, Debug, PartialEq)]
pub enum Remark {
    /// No values are better than the scenario's own.
    NoBetter,
    /// The record has little information on this setting: half and twice the value are as good.
    Flat(String),
    /// The best value of this setting is at an end of its axis.
    Edge(String),
    /// The goal prefers a filter with a bad verdict.
    Inconsistent(Goal, VerdictKind),
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoBetter => f.write_str("No values are better than the present ones."),
            Self::Flat(key) => write!(f, "The record hardly tells {key}: half and twice the value are as good."),
            Self::Edge(key) => {
                write!(f, "The best value of {key} is at an end of its range: widen the range, or doubt the model.")
            }
            Self::Inconsistent(goal, verdict) => {
                let goal = match goal {
                    Goal::Likelihood => "The likelihood",
                    Goal::FreeRun(_) => "The free run",
                    Goal::Consistency => "The mean NIS",
                };
                write!(
                    f,
                    "{goal} is best for a filter whose verdict is “{}”: the model lacks something that no Q or R mends.",
                    verdict.name()
                )
            }
        }
    }
}

pub(super) fn all(cost: &Cost, path: &[Try], verdict: Option<VerdictKind>) -> Vec<Remark> {
    let mut remarks = Vec::new();
    let [_, .., best] = path else { return vec![Remark::NoBetter] };
    for (place, axis) in cost.axes.iter().enumerate() {
        let share = axis.share_of(best.values[place]);
        if !(EDGE..=1.0 - EDGE).contains(&share) {
            remarks.push(Remark::Edge(axis.key.clone()));
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
            remarks.push(Remark::Flat(axis.key.clone()));
        }
    }
    let is_bad = |kind: &VerdictKind| {
        !matches!(kind, VerdictKind::Consistent | VerdictKind::Recovered | VerdictKind::NotIdentifiable)
    };
    remarks.extend(verdict.filter(is_bad).map(|kind| Remark::Inconsistent(cost.goal, kind)));
    remarks
}
