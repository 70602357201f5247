//! Characters to glyphs, composed or taken apart as the font has them.
//!
//! Source: HarfBuzz, `hb-ot-shape-normalize.cc`, mode `COMPOSED_DIACRITICS`.

use crate::buffer::{GlyphInfo, GlyphPosition, Item, UnicodeBuffer};
use crate::characters::{composed, continues, is_hidden, is_mark, parts, space};
use crate::font::Font;

/// Fills in the items of a text.
pub(crate) fn normalise(font: &Font<'_>, buffer: &mut UnicodeBuffer) {
    let UnicodeBuffer { text, items, .. } = buffer;
    let mut cluster = 0;
    let mut characters = text.char_indices().peekable();
    while let Some((at, character)) = characters.next() {
        if !continues(character) || at == 0 {
            cluster = at;
        }
        // A letter with marks is taken apart, to be composed with as many of them as the font has.
        let is_marked = is_mark(character) || characters.peek().is_some_and(|(_, next)| is_mark(*next));
        let mut add = |character, glyph| items.push(Item::new(font, character, glyph, cluster));
        let whole = font.glyph(character);
        match whole {
            Some(glyph) if !is_marked => add(character, glyph),
            _ if take_apart(font, character, is_marked, &mut add) => {}
            Some(glyph) => add(character, glyph),
            None => {
                let other = space(character).map(|_| ' ').or((character == '\u{2011}').then_some('\u{2010}'));
                add(character, other.and_then(|other| font.glyph(other)).unwrap_or(0));
            }
        }
    }
    compose(font, items);
}

impl Item {
    fn new(font: &Font<'_>, character: char, glyph: u16, cluster: usize) -> Self {
        let space = space(character).filter(|_| glyph != 0 && font.glyph(character).is_none());
        Self {
            character,
            info: GlyphInfo { glyph_id: u32::from(glyph), cluster: u32::try_from(cluster).unwrap_or(u32::MAX) },
            position: GlyphPosition::default(),
            is_mark: is_mark(character),
            is_hidden: is_hidden(character),
            space,
            class: font.class(glyph, character),
            sits_on: 0,
        }
    }

    /// Makes it another glyph.
    pub(crate) fn set(&mut self, font: &Font<'_>, glyph: u16) {
        self.info.glyph_id = u32::from(glyph);
        self.class = font.class(glyph, self.character);
    }

    /// The glyph as tables have it.
    pub(crate) fn glyph(&self) -> u16 {
        u16::try_from(self.info.glyph_id).unwrap_or(0)
    }
}

/// Adds the parts of a character, as far apart as possible or else as little as possible. Returns whether the font has them.
fn take_apart(font: &Font<'_>, character: char, is_far: bool, add: &mut impl FnMut(char, u16)) -> bool {
    let Some((letter, mark)) = parts(character) else { return false };
    let mark = mark.map(|mark| (mark, font.glyph(mark)));
    if mark.is_some_and(|(_, glyph)| glyph.is_none()) {
        return false;
    }
    let glyph = font.glyph(letter);
    let is_whole = !is_far && glyph.is_some();
    if is_whole || !take_apart(font, letter, is_far, add) {
        let Some(glyph) = glyph else { return false };
        add(letter, glyph);
    }
    if let Some((mark, Some(glyph))) = mark {
        add(mark, glyph);
    }
    true
}

/// Composes letters and marks that the font has as one.
fn compose(font: &Font<'_>, items: &mut Vec<Item>) {
    if !items.iter().any(|item| item.is_mark) {
        return;
    }
    let (mut letter, mut len) = (0, 1);
    for i in 1..items.len() {
        let item = items[i];
        let whole = if item.is_mark && letter + 1 == len {
            composed(items[letter].character, item.character).and_then(|whole| Some((whole, font.glyph(whole)?)))
        } else {
            None
        };
        if let Some((whole, glyph)) = whole {
            items[letter].character = whole;
            items[letter].set(font, glyph);
            continue;
        }
        items[len] = item;
        if !item.is_mark {
            letter = len;
        }
        len += 1;
    }
    items.truncate(len);
}
