//! Sorting, and lists by functions. What the standard library has for them is compiled once for each type and each function, a sort
//! of 2,500 lines of the compiler's code, a list of 500; here the program has each once, at the price of a call for each item.

use std::cmp::Ordering;

/// Sorts numbers, the least first, as [`f64::total_cmp`] orders them.
pub fn sort_numbers(numbers: &mut [f64]) {
    numbers.sort_unstable_by(f64::total_cmp);
}

/// The median, of two in the middle the larger one.
pub fn median(mut numbers: Vec<f64>) -> Option<f64> {
    sort_numbers(&mut numbers);
    numbers.get(numbers.len() / 2).copied()
}

/// The numbers of a function at 0 to below a count.
pub fn numbers(count: usize, of: &dyn Fn(usize) -> f64) -> Vec<f64> {
    (0..count).map(of).collect()
}

/// The values of a function at all items.
pub fn mapped<'a, T, U>(items: &'a [T], of: &dyn Fn(&'a T) -> U) -> Vec<U> {
    let mut mapped = Vec::with_capacity(items.len());
    for item in items {
        mapped.push(of(item));
    }
    mapped
}

/// The places from 0 to below a count that pass a test.
pub fn places(count: usize, is_so: &dyn Fn(usize) -> bool) -> Vec<usize> {
    (0..count).filter(|place| is_so(*place)).collect()
}

/// The places from 0 to below a count in their order; equal ones stay as they are.
pub fn sorted_places(count: usize, compare: &dyn Fn(usize, usize) -> Ordering) -> Vec<usize> {
    let mut places: Vec<usize> = (0..count).collect();
    places.sort_by(|&a, &b| compare(a, b));
    places
}

/// Sorts items; equal ones stay in their order.
pub fn sort_items<T>(items: &mut [T], compare: impl Fn(&T, &T) -> Ordering) {
    let places = sorted_places(items.len(), &|a, b| compare(&items[a], &items[b]));
    for i in 0..items.len() {
        // An earlier swap has moved an item from before `i`.
        let mut place = places[i];
        while place < i {
            place = places[place];
        }
        items.swap(i, place);
    }
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

    #[test]
    fn items_are_sorted_as_by_the_standard_library() {
        for count in 0..200 {
            let mut items: Vec<(usize, usize)> = (0..count).map(|i| (i * 7919 % 31, i)).collect();
            let mut expected = items.clone();
            sort_items(&mut items, |a, b| a.0.cmp(&b.0));
            expected.sort_by_key(|item| item.0);
            assert_eq!(items, expected);
        }
    }
}
