//! Where a curve has a gap, because nothing was measured for a while.

use std::ops::Range;

use super::layers::LayerColumns;

/// A curve breaks at a gap of at least `SAMPLES` samples that is `DISTANCES` times as long as the mean distance between columns.
/// So the curve of a sensor with a slow clock does not break.
const SAMPLES: usize = 10;
const DISTANCES: usize = 8;

pub(super) fn unbroken(columns: &LayerColumns, run: Range<usize>) -> Vec<Range<usize>> {
    match columns {
        LayerColumns::Band(all) => parts(run, all.len(), |place| all[place].samples),
        LayerColumns::Series(all) => parts(run, all.len(), |place| all[place].samples),
        LayerColumns::Level => vec![run],
    }
}

/// The unbroken parts of a run among `count` columns; `samples` gives the first and the last sample of each.
fn parts(run: Range<usize>, count: usize, samples: impl Fn(usize) -> (usize, usize)) -> Vec<Range<usize>> {
    let distances = count.saturating_sub(1);
    if run.is_empty() || distances == 0 {
        return vec![run];
    }
    let whole = samples(distances).0 - samples(0).0;
    let (mut parts, mut begin) = (Vec::new(), run.start);
    for place in run.start + 1..run.end {
        let gap = samples(place).0 - samples(place - 1).1;
        if gap >= SAMPLES && gap * distances > DISTANCES * whole {
            parts.push(begin..place);
            begin = place;
        }
    }
    parts.push(begin..run.end);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_gap_breaks_a_curve_and_a_slow_clock_does_not() {
        let of = |samples: &[usize]| parts(0..samples.len(), samples.len(), |place| (samples[place], samples[place]));
        let slow: Vec<usize> = (0..50).map(|k| 14 * k).collect();
        assert_eq!(of(&slow).len(), 1);
        let fast: Vec<usize> = (0..200).filter(|k| !(90..120).contains(k)).collect();
        assert_eq!(of(&fast), [0..90, 90..170]);
        let uneven: Vec<usize> = (0..200).filter(|k| k % 3 != 1 && !(50..58).contains(k)).collect();
        assert_eq!(of(&uneven).len(), 1);
        assert_eq!([&[][..], &[3], &[3, 90]].map(|samples| of(samples).len()), [1; 3]);
    }
}
