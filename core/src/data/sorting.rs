//! Sorting with little code: the standard library's stable sort is compiled again for each type, and each copy adds 6
//! kB to a web page.

use std::cmp::Ordering;

/// Sorts numbers, the least first, as [`f64::total_cmp`] orders them.
pub fn sort_numbers(numbers: &mut [f64]) {
    numbers.sort_unstable_by(f64::total_cmp);
}

/// Sorts a short list by insertion, n²/4 comparisons for n items. Equal items stay in their order.
pub fn sort_short_by<T>(items: &mut [T], mut compare: impl FnMut(&T, &T) -> Ordering) {
    for end in 1..items.len() {
        let mut place = end;
        while place > 0 && compare(&items[place - 1], &items[place]) == Ordering::Greater {
            items.swap(place - 1, place);
            place -= 1;
        }
    }
}

/// As [`sort_short_by()`], by a key of each item.
pub fn sort_short_by_key<T, K: PartialOrd>(items: &mut [T], mut key: impl FnMut(&T) -> K) {
    sort_short_by(items, |a, b| key(a).partial_cmp(&key(b)).unwrap_or(Ordering::Equal));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_lists_are_sorted_as_the_standard_sort_does() {
        for seed in 0..200_u64 {
            let number = |i: u64| (seed + 1).wrapping_mul(6_364_136_223_846_793_005).rotate_left(i as u32 * 7) % 5;
            let items: Vec<(u64, u64)> = (0..seed % 12).map(|i| (number(i), i)).collect();
            let (mut ours, mut by_key, mut standard) = (items.clone(), items.clone(), items);
            sort_short_by(&mut ours, |a, b| b.0.cmp(&a.0));
            sort_short_by_key(&mut by_key, |item| std::cmp::Reverse(item.0));
            standard.sort_by_key(|item| std::cmp::Reverse(item.0));
            assert_eq!(ours, standard);
            assert_eq!(by_key, standard);
        }
    }

    #[test]
    fn numbers_are_sorted_with_infinities_at_the_ends() {
        let mut numbers = [2.0, f64::INFINITY, -1.0, 0.0, f64::NEG_INFINITY];
        sort_numbers(&mut numbers);
        assert_eq!(numbers, [f64::NEG_INFINITY, -1.0, 0.0, 2.0, f64::INFINITY]);
    }
}
