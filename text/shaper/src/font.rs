//! The tables of a font.

use read_fonts::tables::cmap::Cmap;
use read_fonts::types::Tag;
use read_fonts::{FontRef, TableProvider};

use crate::bytes::Bytes;
use crate::characters::is_nonspacing_mark;

/// A font's tables.
#[derive(Clone)]
pub(crate) struct Font<'a> {
    characters: Option<Cmap<'a>>,
    advances: Bytes<'a>,
    /// The number of glyphs that have an advance of their own; the others have the last one.
    advance_count: usize,
    /// The glyphs' classes, if the font tells them.
    classes: Option<Bytes<'a>>,
    /// Sets of marks.
    mark_sets: Bytes<'a>,
    pub(crate) substitutions: Bytes<'a>,
    pub(crate) positions: Bytes<'a>,
    /// The units of an em.
    pub(crate) em: i32,
}

impl std::fmt::Debug for Font<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Font").field("em", &self.em).finish_non_exhaustive()
    }
}

impl<'a> Font<'a> {
    pub(crate) fn new(font: &FontRef<'a>) -> Self {
        let table = |tag: &[u8; 4]| Bytes(font.table_data(Tag::new(tag)).map_or(&[][..], |data| data.as_bytes()));
        let definitions = table(b"GDEF");
        let has_sets = definitions.long(0) >= 0x0001_0002;
        Self {
            characters: font.cmap().ok(),
            advances: table(b"hmtx"),
            advance_count: table(b"hhea").index(34),
            classes: Some(definitions.follow(4)).filter(|classes| !classes.0.is_empty()),
            mark_sets: if has_sets { definitions.follow(12) } else { Bytes::default() },
            substitutions: table(b"GSUB"),
            positions: table(b"GPOS"),
            em: i32::from(table(b"head").u16(18)),
        }
    }

    /// The glyph of a character.
    pub(crate) fn glyph(&self, character: char) -> Option<u16> {
        let glyph = self.characters.as_ref()?.map_codepoint(character)?;
        u16::try_from(glyph.to_u32()).ok().filter(|glyph| *glyph != 0)
    }

    /// The width of a glyph.
    pub(crate) fn advance(&self, glyph: u32) -> i32 {
        let last = self.advance_count.saturating_sub(1);
        i32::from(self.advances.u16(4 * usize::try_from(glyph).map_or(last, |glyph| glyph.min(last))))
    }

    /// The class of a glyph: 1 is a base, 2 a ligature, 3 a mark. A font that tells none has that of the character.
    pub(crate) fn class(&self, glyph: u16, character: char) -> u16 {
        let of_character = || if is_nonspacing_mark(character) { 3 } else { 1 };
        self.classes.map_or_else(of_character, |classes| classes.class(glyph))
    }

    /// Whether a glyph belongs to a set of marks.
    pub(crate) fn is_in_set(&self, set: usize, glyph: u16) -> bool {
        let sets = self.mark_sets;
        set < sets.index(2) && sets.from(sets.long(4 + 4 * set)).coverage(glyph).is_some()
    }
}
