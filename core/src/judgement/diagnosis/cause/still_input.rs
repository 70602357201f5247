//! The recorded input is constant for a while, but not the force.

use std::ops::Range;

use super::{BadFilter, Cause, LikelyCause};
use crate::judgement::diagnosis::words::short;

/// The least share of a record in which the input must stand still.
const SHARE: f64 = 0.05;

/// The least number of samples of such a part.
const SAMPLES: usize = 20;

/// The least share of the other samples in which the input must change: a step or a train of blows is constant by
/// nature.
const MOVES: f64 = 0.5;

/// The least innovations² in that part, relative to those elsewhere and to their expectation.
const RISE: f64 = 1.5;

pub(super) static CAUSE: Cause = Cause {
    key: "still_input",
    name: "an input that is not recorded for a while",
    hint: "A cable, an amplifier or a logger has stopped. No setting of a filter makes up for it: leave that part of the record out.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let case = bad.case;
    let input = &case.record.input()[case.samples.clone()];
    let Some(still) = still_part(input) else { return };
    let part = case.samples.start + still.start..case.samples.start + still.end;
    let level = |ranges: &[Range<usize>]| {
        let totals = ranges.iter().map(|range| case.diagnostics.nis_within(range.clone()));
        let (sum, degrees) = totals.fold((0.0, 0.0), |(sum, n), one| (sum + one.sum, n + f64::from(one.degrees)));
        sum / degrees
    };
    let there = level(std::slice::from_ref(&part));
    let elsewhere = level(&[case.samples.start..part.start, part.end..case.samples.end]);
    // Without readings, there or elsewhere, the level is NaN, which is no evidence.
    let rises = there > RISE && there > RISE * elsewhere;
    if !rises {
        return;
    }
    let time = |sample: usize| short(case.record.time(sample));
    let until = if part.end == case.samples.end { "on".to_owned() } else { format!("to {} s", time(part.end)) };
    let sentence = format!(
        "the input stands still from {} s {until}, where innovations² are {} times what is expected ({} elsewhere): it is not \
         recorded there, and no setting mends that",
        time(part.start),
        short(there),
        short(elsewhere)
    );
    let likely = LikelyCause::new(cause, 1.0 - 1.0 / there, 0.0, Vec::new(), sentence);
    found.push(LikelyCause { certain: true, of_record: true, samples: Some(part), ..likely });
}

/// The longest part in which an input that moves elsewhere stands still, if it is long.
fn still_part(input: &[f64]) -> Option<Range<usize>> {
    let (mut longest, mut start) = (0..0, 0);
    for end in 1..=input.len() {
        if end == input.len() || input[end].to_bits() != input[start].to_bits() {
            if end - start > longest.len() {
                longest = start..end;
            }
            start = end;
        }
    }
    let least = SAMPLES.max((SHARE * input.len() as f64) as usize);
    let elsewhere = input.len() - longest.len();
    let changes = input.windows(2).filter(|pair| pair[0].to_bits() != pair[1].to_bits()).count();
    (longest.len() >= least && changes as f64 > MOVES * elsewhere as f64 && elsewhere > 0).then_some(longest)
}

#[cfg(test)]
mod tests {
    use super::still_part;

    #[test]
    fn a_part_without_motion_is_found_beside_motion_only() {
        let moves = |k: usize| (0.1 * k as f64).sin();
        let dead: Vec<f64> = (0..1000).map(|k| if k < 750 { moves(k) } else { 0.0 }).collect();
        assert_eq!(still_part(&dead), Some(750..1000));
        let hole: Vec<f64> = (0..1000).map(|k| if (300..400).contains(&k) { 0.7 } else { moves(k) }).collect();
        assert_eq!(still_part(&hole), Some(300..400));
        let short: Vec<f64> = (0..1000).map(|k| if (300..340).contains(&k) { 0.7 } else { moves(k) }).collect();
        let step: Vec<f64> = (0..1000).map(|k| f64::from(u8::from(k > 100))).collect();
        let blows: Vec<f64> = (0..1000).map(|k| f64::from(u8::from(k < 600 && k % 100 == 0))).collect();
        for input in [short, step, blows, vec![0.0; 1000], Vec::new()] {
            assert_eq!(still_part(&input), None);
        }
    }
}
