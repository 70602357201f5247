//! The lookups of a script, and the glyphs that they look at.

use crate::buffer::Item;
use crate::bytes::Bytes;
use crate::font::Font;

/// The features that every text has.
const FEATURES: [&[u8; 4]; 4] = [b"ccmp", b"kern", b"mark", b"mkmk"];

/// A glyph class in the order of the flags that leave it out.
const IGNORED: [(u16, u16); 3] = [(1, 2), (2, 4), (3, 8)];
const HAS_SET: u16 = 16;

/// A lookup of a table.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lookup<'a> {
    table: Bytes<'a>,
    flag: u16,
    set: usize,
}

/// The places of the lookups of a script, in their order.
pub(crate) fn lookups_of(table: Bytes<'_>, script: &[u8; 4]) -> Vec<usize> {
    let (scripts, features) = (table.follow(4), table.follow(6));
    let tag_at = |list: Bytes<'_>, place: usize, tag: &[u8]| list.from(2 + 6 * place).0.starts_with(tag);
    let find = |tag: &[u8]| (0..scripts.index(0)).find(|&place| tag_at(scripts, place, tag));
    let found = find(script).or_else(|| find(b"DFLT")).or_else(|| find(b"latn"));
    let language = found.map_or(Bytes::default(), |place| scripts.follow(6 + 6 * place)).follow(0);
    let mut lookups = Vec::new();
    for nth in 0..language.index(4) {
        let feature = language.index(6 + 2 * nth);
        if FEATURES.iter().any(|tag| tag_at(features, feature, *tag)) {
            let feature = features.follow(6 + 6 * feature);
            lookups.extend((0..feature.index(2)).map(|nth| feature.index(4 + 2 * nth)));
        }
    }
    lookups.sort_unstable();
    lookups.dedup();
    lookups
}

impl<'a> Lookup<'a> {
    /// A lookup of a table, by its place.
    pub(crate) fn of(table: Bytes<'a>, place: usize) -> Option<Self> {
        let list = table.follow(8);
        if place >= list.index(0) {
            return None;
        }
        let table = list.follow(2 + 2 * place);
        let flag = table.u16(2);
        Some(Self { table, flag, set: table.index(6 + 2 * table.index(4)) })
    }

    /// Its subtables with their types.
    pub(crate) fn subtables(self) -> impl Iterator<Item = (u16, Bytes<'a>)> {
        let Self { table, .. } = self;
        (0..table.index(4)).map(move |nth| (table.u16(0), table.follow(6 + 2 * nth)))
    }

    /// The subtable of an extension, with its type.
    pub(crate) fn extended(subtable: Bytes<'a>) -> (u16, Bytes<'a>) {
        (subtable.u16(2), subtable.from(subtable.long(4)))
    }

    /// The same, looking at all classes of glyphs.
    pub(crate) fn with_all_classes(self) -> Self {
        Self { flag: self.flag & !14, ..self }
    }

    /// The same, leaving out marks.
    pub(crate) fn without_marks(self) -> Self {
        Self { flag: 8, ..self }
    }

    /// Whether it looks at a glyph.
    pub(crate) fn sees(self, font: &Font<'_>, item: &Item) -> bool {
        let Self { flag, set, .. } = self;
        !IGNORED.iter().any(|(class, bit)| item.class == *class && flag & bit != 0)
            && (flag & HAS_SET == 0 || item.class != 3 || font.is_in_set(set, item.glyph()))
    }

    /// The next glyph after a place that it looks at.
    pub(crate) fn next(self, font: &Font<'_>, items: &[Item], place: usize) -> Option<usize> {
        (place + 1..items.len()).find(|&next| !items[next].is_hidden && self.sees(font, &items[next]))
    }

    /// The last glyph before a place that it looks at.
    pub(crate) fn last(self, font: &Font<'_>, items: &[Item], place: usize) -> Option<usize> {
        (0..place).rev().find(|&last| !items[last].is_hidden && self.sees(font, &items[last]))
    }
}
