//! Sorting of numbers.

/// Sorts numbers, the least first, as [`f64::total_cmp`] orders them.
pub fn sort_numbers(numbers: &mut [f64]) {
    numbers.sort_unstable_by(f64::total_cmp);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_sorted_with_infinities_at_the_ends() {
        let mut numbers = [2.0, f64::INFINITY, -1.0, 0.0, f64::NEG_INFINITY];
        sort_numbers(&mut numbers);
        assert_eq!(numbers, [f64::NEG_INFINITY, -1.0, 0.0, 2.0, f64::INFINITY]);
    }
}
