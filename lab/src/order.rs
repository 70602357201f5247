//! The order in which cells are computed: coarse to fine.

/// The cells of a grid, the last axis fastest, in an order that covers the grid evenly at every moment: first every
/// cell at places that are multiples of the widest stride, then those of half the stride, down to 1.
///
/// ```
/// use kalmanscope_lab::order;
///
/// assert_eq!(order::coarse_to_fine(&[9]), [0, 2, 4, 6, 8, 1, 3, 5, 7]);
/// ```
pub fn coarse_to_fine(counts: &[usize]) -> Vec<usize> {
    let all: usize = counts.iter().product();
    let mut order = Vec::with_capacity(all);
    let mut stride = widest(counts);
    let mut before = None;
    while stride > 0 {
        visit(counts, stride, before, 0, 0, true, &mut order);
        before = Some(stride);
        stride /= 2;
    }
    order
}

/// The widest stride of a grid: about eight cells along its longest axis, a power of two.
pub fn widest(counts: &[usize]) -> usize {
    let longest = counts.iter().copied().max().unwrap_or(1).max(1);
    let stride = longest.div_ceil(8).next_power_of_two();
    if stride > longest { 1 } else { stride }
}

/// The cell that stands in for another one as long as only cells on multiples of `stride` are done.
pub fn stand_in(counts: &[usize], cell: usize, stride: usize) -> usize {
    let (mut rest, mut scale, mut found) = (cell, 1, 0);
    for &count in counts.iter().rev() {
        let place = rest % count;
        found += scale * (place - place % stride);
        rest /= count;
        scale *= count;
    }
    found
}

fn visit(
    counts: &[usize],
    stride: usize,
    before: Option<usize>,
    axis: usize,
    cell: usize,
    is_old: bool,
    order: &mut Vec<usize>,
) {
    let Some(&count) = counts.get(axis) else {
        if !(is_old && before.is_some()) {
            order.push(cell);
        }
        return;
    };
    for place in (0..count).step_by(stride) {
        let old = is_old && before.is_some_and(|before| place % before == 0);
        visit(counts, stride, before, axis + 1, cell * count + place, old, order);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_comes_once() {
        for counts in [&[1][..], &[7], &[128, 128], &[5, 3], &[1, 9], &[4, 3, 2], &[256, 1], &[]] {
            let mut order = coarse_to_fine(counts);
            order.sort_unstable();
            assert!(order.iter().copied().eq(0..counts.iter().product()), "{counts:?}");
        }
    }

    #[test]
    fn the_beginning_covers_the_grid() {
        let counts = [128, 128];
        let order = coarse_to_fine(&counts);
        let stride = widest(&counts);
        assert_eq!(stride, 16);
        let first: Vec<usize> = order[..64].to_vec();
        for cell in 0..128 * 128 {
            assert!(first.contains(&stand_in(&counts, cell, stride)));
        }
        assert!(order[64..256].iter().all(|&cell| cell % 8 == 0 && (cell / 128) % 8 == 0));
    }
}
