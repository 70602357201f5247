//! Remedies: causes that are repaired one after the other, their order after their trials, and their probabilities.

use kalmanscope_core::internals::{mapped, sort_items};
use kalmanscope_core::setting::Edit;

use super::case::VerdictKind;
use super::cause::LikelyCause;
use super::diagnosis::Verdict;
use super::trial::{TrialOutcome, Trials};

/// A cause, or several one after the other, and the effect of making their edits.
#[derive(Clone, Debug)]
pub struct Remedy {
    /// The cause, its evidence and its edits.
    pub first: LikelyCause,
    /// The causes of the remaining misfit after the first one is repaired, in the order of their repairs.
    pub then: Vec<LikelyCause>,
    /// The edits of all causes together, the last of each key.
    pub edits: Vec<Edit>,
    /// The gain in log likelihood over the window, less ½ ln n for each fitted number, of n samples (BIC); NaN where it is not tried.
    /// Source: Schwarz (1978), Estimating the dimension of a model, *The Annals of Statistics* 6.
    pub gain: f64,
    /// The verdict on the filter with the edits made, over the window.
    pub after: Option<Verdict>,
}

impl Remedy {
    /// The causes in the order in which they are repaired.
    pub fn causes(&self) -> impl Iterator<Item = &LikelyCause> {
        std::iter::once(&self.first).chain(&self.then)
    }

    pub(super) fn changes_plant(&self) -> bool {
        self.first.edits.iter().any(|edit| edit.inner() == "plant")
    }

    /// Whether the verdict after it is good or not identifiable, or the cause is a fault of the record, or certain and without an edit.
    pub fn explains(&self) -> bool {
        let of_nothing = self.first.certain && self.edits.is_empty();
        of_nothing || self.first.of_record || self.after.as_ref().is_some_and(|verdict| rests(verdict.kind) > 0)
    }

    /// Whether the first of some remedies, the likeliest first, explains the verdict: otherwise none of them does.
    pub fn is_explained(remedies: &[Self]) -> bool {
        remedies.first().is_some_and(Self::explains)
    }

    pub(super) fn precedence(&self) -> u8 {
        let ends = self.after.as_ref().map_or(0, |verdict| rests(verdict.kind));
        match &self.first {
            likely if likely.of_record => 6,
            likely if likely.certain && !self.edits.is_empty() => 5,
            likely if likely.silences => 0,
            _ if ends > 0 => 2 + ends,
            likely if likely.certain => 2,
            _ => 1,
        }
    }

    /// The probability of each of some remedies, the likeliest first, that its first cause is the right one: how often it was where
    /// one of the faults that are known was put into random situations. The rest to 1 is for none of them.
    /// ```text
    /// p = o / (1 + Σ o),  o = exp(Σ w x)
    /// ```
    pub fn probabilities(remedies: &[Self]) -> Vec<f64> {
        let gain = |remedy: &Self| if remedy.gain.is_nan() { 0.0 } else { remedy.gain.clamp(-1e6, 1e6) };
        let of = |(place, remedy): (usize, &Self)| {
            let others = || remedies.iter().enumerate().filter(|(other, _)| *other != place).map(|(_, other)| other);
            let lead = gain(remedy) - others().map(gain).fold(0.0, f64::max);
            let flag = |is: bool| f64::from(u8::from(is));
            let seen = [
                1.0,
                flag(place == 0),
                libm::copysign(libm::log1p(lead.abs() / 8.0), lead),
                flag(remedy.explains()),
                flag(others().any(Self::explains)),
                flag(remedy.first.certain),
                flag(others().any(|other| other.first.certain)),
                flag(!remedy.then.is_empty()),
            ];
            libm::exp(WEIGHTS.iter().zip(seen).map(|(weight, seen)| weight * seen).sum())
        };
        let odds: Vec<f64> = remedies.iter().enumerate().map(of).collect();
        let all = 1.0 + odds.iter().sum::<f64>();
        mapped(&odds, &|odds| odds / all)
    }
}

fn rests(kind: VerdictKind) -> u8 {
    match kind {
        kind if kind.is_good() => 2,
        VerdictKind::NotIdentifiable => 1,
        _ => 0,
    }
}

/// The least gain in log likelihood of a cause that is named, less the gain of its numbers by chance.
pub(super) const WORTH: f64 = 8.0;

const SIGNIFICANT: f64 = 4.0;

pub(super) const UNKNOWN_FORCE: &str = "unknown_force";

/// Limits the lead of a yielding spring over a slow force in log likelihood: 36 of 37 such springs had it, and 1 of 28 forces.
const AHEAD: f64 = 60.0;

fn is_noise(likely: &LikelyCause) -> bool {
    matches!(likely.cause.key, "sensor_noise" | "process_noise" | "felt_disturbance")
}

pub(super) struct Ranked {
    pub(super) remedy: Remedy,
    pub(super) rank: f64,
    pub(super) achieved: f64,
}

impl Trials {
    pub(super) fn ranked(&self) -> Vec<Ranked> {
        let Some(before) = &self.before else { return Vec::new() };
        let penalty = self.price();
        let tried = || self.tried();
        // A larger noise explains any misfit a little: a cause comes first if it is better with the size of all noise fitted.
        let open = |likely: &LikelyCause, outcome: &TrialOutcome| {
            outcome.scaled - before.log_likelihood - penalty * (likely.fitted + 1.0)
        };
        let of_noise = tried().filter(|(likely, _)| is_noise(likely)).map(|(likely, outcome)| open(likely, outcome));
        let of_noise = of_noise.fold(before.scaled - before.log_likelihood - penalty, f64::max);
        // Hysteresis fits better than a cubic part even for a hardening spring, although it does not harden.
        let hardens = |softening: &TrialOutcome| {
            tried().any(|(likely, outcome)| {
                likely.sign.is_some()
                    && outcome.learnt > SIGNIFICANT
                    && outcome.achieved - before.log_likelihood - penalty * likely.fitted > WORTH
                    && (outcome.is_good() || !softening.is_good())
            })
        };
        // A spring that yields, or a damper that creeps, has no place of rest, so it follows a slow force nearly as well as the force does.
        let is_of_force = |softening: &LikelyCause, outcome: &TrialOutcome| {
            tried().any(|(likely, force)| {
                let lead = outcome.achieved - force.achieved - penalty * (softening.fitted - likely.fitted);
                likely.cause.key == UNKNOWN_FORCE && lead < if force.is_good() { AHEAD } else { 0.0 }
            })
        };
        // Another plant begins with another guess: where that alone is enough, the plant was right.
        let is_of_guess = tried().any(|(likely, outcome)| likely.cause.key == "initial_guess" && outcome.is_good());
        let is_explained = |likely: &LikelyCause, outcome: &TrialOutcome| {
            (likely.softens && (hardens(outcome) || is_of_force(likely, outcome)))
                || (likely.renews_guess && is_of_guess)
        };
        let mut all: Vec<Ranked> = Vec::new();
        for (likely, outcome) in tried().filter(|(likely, outcome)| !is_explained(likely, outcome)) {
            let gain = match self.own.filter(|_| likely.cause.key == "collapsed_sample") {
                Some(own) => before.log_likelihood - own,
                None => outcome.log_likelihood - before.log_likelihood - penalty * likely.fitted,
            };
            if !(likely.certain || gain > WORTH) {
                continue;
            }
            let open = open(likely, outcome);
            let is_beyond = !is_noise(likely) && open > of_noise + 20.0;
            let rank = if is_beyond { gain.max(open) } else { gain };
            let achieved = outcome.achieved - before.log_likelihood - penalty * likely.fitted;
            let mut likely = likely.clone();
            if let Some((_, [positive, negative])) = likely.sign.filter(|_| outcome.learnt.abs() > SIGNIFICANT) {
                likely.sentence = if outcome.learnt > 0.0 { positive } else { negative }.to_owned();
            }
            let edits = likely.edits.clone();
            let remedy = Remedy { first: likely, then: Vec::new(), edits, gain, after: outcome.verdict.clone() };
            let ranked = Ranked { remedy, rank, achieved };
            let key = ranked.remedy.first.cause.key;
            match all.iter_mut().find(|other| other.remedy.first.cause.key == key) {
                Some(other) if compare((&ranked.remedy, rank), (&other.remedy, other.rank)).is_le() => {}
                Some(other) => *other = ranked,
                None => all.push(ranked),
            }
        }
        sort_items(&mut all, |a, b| compare((&b.remedy, b.rank), (&a.remedy, a.rank)));
        all
    }
}

pub(super) fn compare(one: (&Remedy, f64), other: (&Remedy, f64)) -> std::cmp::Ordering {
    let key = |(remedy, rank): (&Remedy, f64)| (remedy.precedence(), rank, remedy.first.weight);
    key(one).partial_cmp(&key(other)).unwrap_or(std::cmp::Ordering::Equal)
}

/// Weights in the logarithm of the odds, of what [`Remedy::probabilities`] sees.
/// They are the likeliest for 1,920 situations of the benchmark `diagnosis`, from seed 500,000 on. The constant and the weight of an
/// explained verdict are larger, so that half of the remedies that explain nothing are right where one fault in five has no name here.
/// Source: Platt (1999), Probabilistic outputs for support vector machines.
const WEIGHTS: [f64; 8] = [-4.7, 2.6, 0.5, 4.3, -0.4, 5.3, -1.5, -3.3];

/// A probability as it is read: never quite none or all.
pub fn in_percent(probability: f64) -> String {
    match 100.0 * probability {
        least if least < 1.0 => "< 1 %".to_owned(),
        most if most > 99.0 => "> 99 %".to_owned(),
        usual => format!("{usual:.0} %"),
    }
}
