//! What comes in and goes out.

use std::ops::BitOrAssign;

use crate::characters::Space;

/// Where a text stands in its paragraph, which matters to no script that is shaped here.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BufferFlags(u8);

impl BufferFlags {
    /// The text begins a paragraph.
    pub const BEGINNING_OF_TEXT: Self = Self(1);
    /// The text ends a paragraph.
    pub const END_OF_TEXT: Self = Self(2);

    /// Neither.
    pub fn empty() -> Self {
        Self(0)
    }
}

impl BitOrAssign for BufferFlags {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

/// A glyph of a shaped text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GlyphInfo {
    /// Its number in the font.
    pub glyph_id: u32,
    /// The byte of the text at which its characters begin.
    pub cluster: u32,
}

/// The place of a glyph, in font units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GlyphPosition {
    /// How far the next glyph is.
    pub x_advance: i32,
    /// How much it moves to the right.
    pub x_offset: i32,
    /// How much it moves up.
    pub y_offset: i32,
}

/// A character on its way to a glyph.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    pub(crate) character: char,
    pub(crate) info: GlyphInfo,
    pub(crate) position: GlyphPosition,
    /// Whether the character is a combining mark.
    pub(crate) is_mark: bool,
    /// Whether the character has no picture and no width.
    pub(crate) is_hidden: bool,
    /// The width of a space that the font lacks.
    pub(crate) space: Option<Space>,
    /// The glyph's class in the font: 1 is a base, 2 a ligature, 3 a mark.
    pub(crate) class: u16,
    /// How many glyphs before stands the one that this mark sits on, or 0.
    pub(crate) sits_on: usize,
}

/// A text to be shaped, with memory for its glyphs.
#[derive(Clone, Debug, Default)]
pub struct UnicodeBuffer {
    pub(crate) text: String,
    pub(crate) items: Vec<Item>,
    glyphs: GlyphBufferParts,
}

#[derive(Clone, Debug, Default)]
struct GlyphBufferParts {
    infos: Vec<GlyphInfo>,
    positions: Vec<GlyphPosition>,
}

impl UnicodeBuffer {
    /// No text.
    pub fn new() -> Self {
        Self::default()
    }

    /// Says where the text stands in its paragraph.
    pub fn set_flags(&mut self, _: BufferFlags) {}

    /// Appends text.
    pub fn push_str(&mut self, text: &str) {
        self.text.push_str(text);
    }

    /// Finds script and direction; here they are found when the text is shaped.
    pub fn guess_segment_properties(&mut self) {}

    /// Makes the glyphs of the items. A character that has no picture becomes a space without width.
    pub(crate) fn finish(mut self, space: Option<u16>) -> GlyphBuffer {
        let Self { items, glyphs: GlyphBufferParts { infos, positions }, .. } = &mut self;
        infos.clear();
        positions.clear();
        for item in items.iter_mut() {
            if item.is_hidden {
                let Some(space) = space else { continue };
                item.info.glyph_id = u32::from(space);
            }
            infos.push(item.info);
            positions.push(item.position);
        }
        GlyphBuffer(self)
    }
}

/// The glyphs of a text.
#[derive(Clone, Debug)]
pub struct GlyphBuffer(UnicodeBuffer);

impl GlyphBuffer {
    /// The glyphs.
    pub fn glyph_infos(&self) -> &[GlyphInfo] {
        &self.0.glyphs.infos
    }

    /// Their places.
    pub fn glyph_positions(&self) -> &[GlyphPosition] {
        &self.0.glyphs.positions
    }

    /// The memory, for the next text.
    pub fn clear(self) -> UnicodeBuffer {
        let mut buffer = self.0;
        buffer.text.clear();
        buffer.items.clear();
        buffer
    }
}
