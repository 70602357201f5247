//! Lookups that depend on the glyphs around.

use crate::buffer::Item;
use crate::bytes::Bytes;
use crate::font::Font;
use crate::lookup::Lookup;

/// The most glyphs that a rule names.
const MOST: usize = 16;

/// A rule that holds at some place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Matched<'a> {
    /// The places of the glyphs that it names.
    places: [usize; MOST],
    /// What is to be done: pairs of a glyph's number and a lookup's place.
    records: Bytes<'a>,
}

impl Matched<'_> {
    /// The places of glyphs, each with the place of the lookup that is to be applied there.
    pub(crate) fn records(&self) -> impl Iterator<Item = (usize, usize)> {
        let Self { places, records } = *self;
        (0..records.index(0)).filter_map(move |nth| {
            let record = records.from(2 + 4 * nth);
            Some((*places.get(record.index(0))?, record.index(2)))
        })
    }
}

/// The rule of a chained context of format 3, if it holds for the glyph at a place: coverages of what stands before, of the
/// glyphs themselves, and of what comes after.
pub(crate) fn chained<'a>(
    font: &Font<'_>,
    lookup: Lookup<'_>,
    table: Bytes<'a>,
    items: &[Item],
    place: usize,
) -> Option<Matched<'a>> {
    if table.u16(0) != 3 {
        return None;
    }
    let covers = |at: usize, place: usize| table.follow(at).coverage(items[place].glyph()).is_some();
    let mut at = 2;
    let mut count = || {
        let first = at + 2;
        let count = table.index(at);
        at = first + 2 * count;
        (0..count).map(move |nth| first + 2 * nth)
    };
    let [before, mut glyphs, after] = [count(), count(), count()];
    let (mut places, mut here) = ([usize::MAX; MOST], place);
    places[0] = place;
    if !covers(glyphs.next()?, place) {
        return None;
    }
    for (coverage, slot) in glyphs.zip(&mut places[1..]) {
        here = lookup.next(font, items, here).filter(|&next| covers(coverage, next))?;
        *slot = here;
    }
    for coverage in after {
        here = lookup.next(font, items, here).filter(|&next| covers(coverage, next))?;
    }
    here = place;
    for coverage in before {
        here = lookup.last(font, items, here).filter(|&last| covers(coverage, last))?;
    }
    Some(Matched { places, records: table.from(at) })
}
