#![doc = include_str!("../README.md")]

mod buffer;
mod bytes;
mod characters;
mod context;
mod font;
mod lookup;
mod normalise;
mod pairs;
mod position;
mod substitute;

pub use buffer::{BufferFlags, GlyphBuffer, GlyphInfo, GlyphPosition, UnicodeBuffer};
pub use read_fonts::FontRef;
pub use read_fonts::types::Tag;

use font::Font;

/// What a font's shapers share: nothing, since tables are read as they stand in the file.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShaperData(());

impl ShaperData {
    /// The data of a font.
    pub fn new(_: &FontRef<'_>) -> Self {
        Self(())
    }

    /// Begins a shaper of this font.
    pub fn shaper<'a>(&self, font: &FontRef<'a>) -> ShaperBuilder<'a> {
        ShaperBuilder(Font::new(font))
    }
}

/// A setting of a variable font, which is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variation {
    /// The axis.
    pub tag: Tag,
    /// The place on it.
    pub value: f32,
}

/// A variable font's instance: the default one always.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShaperInstance(());

impl ShaperInstance {
    /// The default instance.
    pub fn from_variations(_: &FontRef<'_>, _: Vec<Variation>) -> Self {
        Self(())
    }
}

/// Builds a [`Shaper`].
#[derive(Clone, Debug)]
pub struct ShaperBuilder<'a>(Font<'a>);

impl<'a> ShaperBuilder<'a> {
    /// Takes a variable font's instance, which is the default one.
    pub fn instance(self, _: Option<&ShaperInstance>) -> Self {
        self
    }

    /// Finishes.
    pub fn build(self) -> Shaper<'a> {
        Shaper(self.0)
    }
}

/// How to shape: as usual.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShapeOptions(());

impl ShapeOptions {
    /// The usual.
    pub fn new() -> Self {
        Self(())
    }
}

/// Makes glyphs at places of text.
#[derive(Debug)]
pub struct Shaper<'a>(Font<'a>);

impl Shaper<'_> {
    /// The glyphs of a text, from left to right, in font units.
    pub fn shape(&self, mut buffer: UnicodeBuffer, _: ShapeOptions) -> GlyphBuffer {
        let Self(font) = self;
        let tags = characters::script_of(&buffer.text);
        normalise::normalise(font, &mut buffer);
        substitute::substitute(font, tags, &mut buffer.items);
        position::position(font, tags, &mut buffer.items);
        buffer.finish(font.glyph(' '))
    }
}
