//! Whether errors are as large as the covariance says, if the truth is known: channel by channel, so that right ones do
//! not dilute a wrong one, and all together.

use crate::judgement::diagnosis::case::Case;
use crate::judgement::diagnosis::distributions::{chi_squared_p, normal_p};
use crate::judgement::diagnosis::evidence::{Evidence, Subject, Test};
use crate::judgement::diagnosis::parts::{Chosen, PARTS};
use crate::judgement::diagnosis::verdict_kind::VerdictKind;
use crate::judgement::diagnosis::words::{percent, short};
use crate::numbers::diagnostics::chi_squared;

/// Limits the error of a parameter, in standard deviations; its errors over a record count as one.
const OFF: f64 = 4.0;

/// Limits the squared errors of a motion from above, relative to the covariance.
const TOO_LARGE: f64 = 2.0;

/// The least squared errors of a motion, relative to the covariance.
const TOO_SMALL: f64 = 0.3;

/// The least share of the samples with the truth in the 95 % ellipsoid.
const OUTSIDE: f64 = 0.5;

/// The same if each channel alone is inside. The errors are then outside only in a direction across the channels, in
/// which linearised filters are always overconfident.
const OUTSIDE_ACROSS: f64 = 0.25;

pub(super) static CHANNELS: Test = Test {
    name: "errors of a channel (NEES)",
    statistic: "mean of e² / P over the record for a motion, and over its last fifth for a parameter",
    distribution: "χ² with as many degrees of freedom as errors are independent: one for a parameter",
    source: "Bar-Shalom, Li and Kirubarajan (2001), section 5.4",
    reading: "1 is right on average; 16 is an error of 4σ",
    run: channels,
};

pub(super) static ELLIPSOID: Test = Test {
    name: "errors of all channels (NEES)",
    statistic: "share of samples with eᵀ P⁻¹ e below the 95 % quantile of χ²",
    distribution: "95 % on average over many runs; errors of one run are much alike from sample to sample",
    source: "Bar-Shalom, Li and Kirubarajan (2001), section 5.4",
    reading: "near 95 % is right; below a half, the truth is outside what the filter holds possible most of the time",
    run: ellipsoid,
};

fn channels(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let late: Chosen = std::array::from_fn(|part| part >= PARTS - 2);
    for one in &case.errors {
        let evidence = Evidence::new(test, Subject::Channel(one.channel), case);
        let name = one.channel.name();
        if one.channel.is_parameter() {
            let off = one.level(&late).sqrt();
            if one.count(&late) == 0.0 {
                continue;
            }
            found.push(Evidence {
                statistic: off * off,
                // Errors stay below `OFF` even with the slight overconfidence of linearised filters: a larger one
                // counts as certain.
                p_value: if off > OFF { 0.0 } else { normal_p(off) },
                effect: off / OFF,
                speaks_for: VerdictKind::Overconfident,
                samples: case.late(),
                sentence: format!(
                    "the {name} is {} times its σ off in the last fifth, and inside ±2σ in {} of it",
                    short(off),
                    percent(one.coverage(&late))
                ),
                ..evidence
            });
            continue;
        }
        let level = one.level(&case.kept);
        if level.is_nan() {
            continue;
        }
        let (effect, kind) = if level > 1.0 {
            (libm::log(level) / libm::log(TOO_LARGE), VerdictKind::Overconfident)
        } else {
            // Small errors by chance, or because nothing moves, come with innovations as large as expected.
            let effect = if case.nis(&case.kept).0 < 0.9 { libm::log(level) / libm::log(TOO_SMALL) } else { 0.0 };
            (effect, VerdictKind::Underconfident)
        };
        found.push(Evidence {
            statistic: level,
            p_value: chi_squared_p(level, one.independent(&case.kept)),
            effect,
            speaks_for: kind,
            sentence: format!("errors² of the {name} are {} times what the covariance says", short(level)),
            ..evidence
        });
    }
}

fn ellipsoid(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let Some(share) = case.share_in_ellipsoid() else { return };
    let late = case.diagnostics.nees_within(case.part(PARTS / 2).start..case.samples.end);
    let degrees = late.degrees.checked_div(late.samples).unwrap_or(0);
    let all_inside = case.errors.iter().all(|one| one.level(&case.kept) < 1.0);
    let limit = if all_inside { OUTSIDE_ACROSS } else { OUTSIDE };
    found.push(Evidence {
        statistic: share,
        // The errors of one record count as a single one.
        p_value: chi_squared::upper_tail(late.mean(), degrees).unwrap_or(1.0),
        effect: if share > 0.0 { limit / share } else { f64::MAX },
        speaks_for: VerdictKind::Overconfident,
        sentence: format!("the truth is in the 95 % ellipsoid in {} of the samples", percent(share)),
        ..Evidence::new(test, Subject::All, case)
    });
}
