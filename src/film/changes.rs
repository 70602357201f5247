//! Pictures of one size as places in a palette, each with the pixels only that differ from the picture before it.

use std::collections::HashMap;

pub type Color = [u8; 3];

/// The place in the palette of a pixel that has not changed.
pub const UNCHANGED: u8 = 255;

pub struct Shades {
    /// The commonest colours, and one of no meaning at [`UNCHANGED`].
    pub colors: Vec<Color>,
    common: usize,
    known: HashMap<Color, u8>,
}

impl Shades {
    pub fn of<'a>(pictures: impl Iterator<Item = &'a [Color]>) -> Self {
        let mut counts: HashMap<Color, usize> = HashMap::new();
        // Most neighbours are alike: one look into the table for all of them.
        let runs = pictures.flat_map(|picture| picture.chunk_by(|one, other| one == other));
        runs.for_each(|run| *counts.entry(run[0]).or_default() += run.len());
        let mut all: Vec<(usize, Color)> = counts.into_iter().map(|(color, count)| (count, color)).collect();
        all.sort_unstable_by(|a, b| b.cmp(a));
        let mut colors: Vec<Color> = all.iter().map(|(_, color)| *color).take(usize::from(UNCHANGED)).collect();
        let common = colors.len();
        colors.resize(usize::from(UNCHANGED) + 1, [0; 3]);
        Self { colors, common, known: HashMap::new() }
    }

    /// The places of the nearest colours.
    pub fn places(&mut self, picture: &[Color]) -> Vec<u8> {
        let Self { colors, common, known } = self;
        let mut places = Vec::with_capacity(picture.len());
        for run in picture.chunk_by(|one, other| one == other) {
            let color = run[0];
            let far = |other: &Color| (0..3).map(|i| (i32::from(other[i]) - i32::from(color[i])).pow(2)).sum::<i32>();
            let nearest = || (0..UNCHANGED).zip(&colors[..*common]).min_by_key(|(_, other)| far(other));
            let place = *known.entry(color).or_insert_with(|| nearest().map_or(0, |(place, _)| place));
            places.resize(places.len() + run.len(), place);
        }
        places
    }
}

/// The smallest rectangle with all changes; a single pixel where there are none.
pub struct Change {
    pub corner: [usize; 2],
    pub size: [usize; 2],
    pub pixels: Vec<u8>,
}

impl Change {
    pub fn between(before: Option<&[u8]>, now: &[u8], width: usize) -> Self {
        let differs = |at: &usize| before.is_none_or(|before| before[*at] != now[*at]);
        let ends = |of: fn(usize, usize) -> usize| {
            let changed = || (0..now.len()).filter(differs).map(|at| of(at, width));
            (changed().min().unwrap_or(0), changed().max().unwrap_or(0))
        };
        let ((top, bottom), (left, right)) = (ends(|at, width| at / width), ends(|at, width| at % width));
        let inside = (top..=bottom).flat_map(|y| (left..=right).map(move |x| y * width + x));
        let pixels = inside.map(|at| if differs(&at) { now[at] } else { UNCHANGED }).collect();
        Self { corner: [left, top], size: [right - left + 1, bottom - top + 1], pixels }
    }
}
