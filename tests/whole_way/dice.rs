//! Choices that follow from a number, and hostile numbers at any address of a file.

use toml::Value;

/// A sequence of pseudo-random numbers.
///
/// Source: Steele, Lea and Flood (2014), Fast splittable pseudorandom number generators.
pub(crate) struct Dice(u64);

impl Dice {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A whole number from 0 to `n` - 1.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }

    pub(crate) fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    /// One of these. There must be at least one.
    pub(crate) fn pick<T: Clone>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())].clone()
    }
}

/// Numbers that are allowed in many places and usual in none.
const EXTREME: [f64; 18] = [
    0.0,
    -0.0,
    1e-300,
    -1e-300,
    5e-324,
    1e-160,
    1e-20,
    1e-9,
    1.0,
    1e3,
    1e9,
    1e20,
    1e150,
    -1e150,
    1e155,
    1e300,
    f64::MAX,
    -f64::MAX,
];

/// Numbers that are allowed in few places.
const IMPOSSIBLE: [f64; 5] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, -1e9];

const WHOLE: [i64; 10] = [0, 1, -1, 2, 7, 100, 1000, 1_000_000_000, i64::MAX, i64::MIN];

/// A hostile number, or the former one by some powers of ten off.
fn hostile(before: f64, dice: &mut Dice) -> f64 {
    match dice.below(16) {
        0 => dice.pick(&IMPOSSIBLE),
        1..=7 => dice.pick(&EXTREME),
        8 => -before,
        _ => before * 10_f64.powi(dice.below(13) as i32 - 6),
    }
}

/// Replaces some numbers of a document by hostile ones: one to four, and seldom one in three.
pub(crate) fn spoil(document: &mut Value, dice: &mut Dice) {
    let mut count = 0;
    visit(document, &mut |_| count += 1);
    let chosen: Vec<usize> = if dice.one_in(12) {
        (0..count).filter(|_| dice.one_in(3)).collect()
    } else {
        (0..1 + dice.below(4)).map(|_| dice.below(count)).collect()
    };
    let mut place = 0;
    visit(document, &mut |number| {
        if chosen.contains(&place) {
            *number = match *number {
                Value::Integer(before) if !dice.one_in(8) => {
                    Value::Integer(if dice.one_in(2) { dice.pick(&WHOLE) } else { before.saturating_mul(10) })
                }
                Value::Integer(before) => Value::Float(hostile(before as f64, dice)),
                Value::Float(before) => Value::Float(hostile(before, dice)),
                ref other => other.clone(),
            };
        }
        place += 1;
    });
}

fn visit(document: &mut Value, change: &mut dyn FnMut(&mut Value)) {
    match document {
        Value::Array(values) => values.iter_mut().for_each(|value| visit(value, change)),
        Value::Table(entries) => entries.iter_mut().for_each(|(_, value)| visit(value, change)),
        Value::Integer(_) | Value::Float(_) => change(document),
        _ => {}
    }
}
