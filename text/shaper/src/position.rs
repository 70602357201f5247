//! Places of glyphs: widths, kerning, and marks on letters.
//!
//! Source: OpenType specification 1.9.1, table `GPOS`.

use crate::buffer::{GlyphPosition, Item};
use crate::bytes::Bytes;
use crate::characters::Space;
use crate::context::chained;
use crate::font::Font;
use crate::lookup::{Lookup, lookups_of};

/// Places all glyphs of a text.
pub(crate) fn position(font: &Font<'_>, script: &[u8; 4], items: &mut [Item]) {
    for item in &mut *items {
        item.position.x_advance = width(font, item);
    }
    for lookup in lookups_of(font.positions, script) {
        let Some(lookup) = Lookup::of(font.positions, lookup) else { continue };
        let mut place = 0;
        while place < items.len() {
            let applied = if lookup.sees(font, &items[place]) { apply(font, lookup, items, place, true) } else { None };
            place = applied.unwrap_or(place + 1);
        }
    }
    for item in &mut *items {
        if item.class == 3 {
            item.position.x_advance = 0;
        }
        if item.is_hidden {
            item.position = GlyphPosition::default();
        }
    }
    for place in 0..items.len() {
        sit(items, place);
    }
}

fn width(font: &Font<'_>, item: &Item) -> i32 {
    let usual = font.advance(item.info.glyph_id);
    match item.space {
        None | Some(Space::Usual) => usual,
        Some(Space::Narrow) => usual / 2,
        Some(Space::Em(1, parts)) => (font.em + parts / 2) / parts,
        Some(Space::Em(some, parts)) => font.em * some / parts,
        Some(Space::As(characters)) => {
            let glyph = characters.chars().find_map(|character| font.glyph(character));
            glyph.map_or(usual, |glyph| font.advance(u32::from(glyph)))
        }
    }
}

/// Moves a mark from its own place onto that of the glyph that it sits on, which stands before it.
fn sit(items: &mut [Item], place: usize) {
    let Some(base) = place.checked_sub(items[place].sits_on).filter(|base| *base < place) else { return };
    let GlyphPosition { x_offset, y_offset, .. } = items[base].position;
    let between: i32 = items[base..place].iter().map(|item| item.position.x_advance).sum();
    items[place].position.x_offset += x_offset - between;
    items[place].position.y_offset += y_offset;
}

/// Applies the first subtable of a lookup that has something for the glyph at a place. Returns the place to go on from.
fn apply(font: &Font<'_>, lookup: Lookup<'_>, items: &mut [Item], place: usize, may_nest: bool) -> Option<usize> {
    lookup.subtables().find_map(|(kind, table)| {
        let (kind, table) = if kind == 9 { Lookup::extended(table) } else { (kind, table) };
        match kind {
            1 => single(table, &mut items[place]).map(|()| place + 1),
            2 => pair(font, lookup, table, items, place),
            4 => sit_on_base(font, lookup, table, items, place).map(|()| place + 1),
            6 => sit_on_mark(font, lookup, table, items, place).map(|()| place + 1),
            8 if may_nest => {
                let matched = chained(font, lookup, table, items, place)?;
                for (place, nested) in matched.records() {
                    if let Some(nested) = Lookup::of(font.positions, nested).filter(|_| place < items.len()) {
                        apply(font, nested, items, place, false);
                    }
                }
                Some(place + 1)
            }
            _ => None,
        }
    })
}

/// The number of values that a format has.
fn size_of(format: u16) -> usize {
    2 * format.count_ones() as usize
}

/// Moves a glyph by values of a format.
fn move_by(item: &mut Item, format: u16, values: Bytes<'_>) {
    let GlyphPosition { x_advance, x_offset, y_offset } = &mut item.position;
    let mut at = 0;
    for (bit, target) in [(1, Some(x_offset)), (2, Some(y_offset)), (4, Some(x_advance)), (8, None)] {
        if format & bit != 0 {
            if let Some(target) = target {
                *target += values.i16(at);
            }
            at += 2;
        }
    }
}

fn single(table: Bytes<'_>, item: &mut Item) -> Option<()> {
    let place = table.follow(2).coverage(item.glyph())?;
    let format = table.u16(4);
    let values = if table.u16(0) == 1 { table.from(6) } else { table.from(8 + place * size_of(format)) };
    move_by(item, format, values);
    Some(())
}

fn pair(font: &Font<'_>, lookup: Lookup<'_>, table: Bytes<'_>, items: &mut [Item], first: usize) -> Option<usize> {
    let set = table.follow(2).coverage(items[first].glyph())?;
    let second = lookup.next(font, items, first)?;
    let formats = [table.u16(4), table.u16(6)];
    let sizes = formats.map(size_of);
    let glyph = items[second].glyph();
    let values = match table.u16(0) {
        1 => {
            let (set, size) = (table.follow(10 + 2 * set), 2 + sizes[0] + sizes[1]);
            let record = set.from(2 + size * set.from(2).last_until(set.index(0), size, glyph)?);
            if record.u16(0) != glyph {
                return None;
            }
            record.from(2)
        }
        2 => {
            let classes = [table.follow(8).class(items[first].glyph()), table.follow(10).class(glyph)].map(usize::from);
            let counts = [table.index(12), table.index(14)];
            if classes[0] >= counts[0] || classes[1] >= counts[1] {
                return None;
            }
            table.from(16 + (classes[0] * counts[1] + classes[1]) * (sizes[0] + sizes[1]))
        }
        _ => return None,
    };
    move_by(&mut items[first], formats[0], values);
    move_by(&mut items[second], formats[1], values.from(sizes[0]));
    Some(if formats[1] == 0 { second } else { second + 1 })
}

fn sit_on_base(font: &Font<'_>, lookup: Lookup<'_>, table: Bytes<'_>, items: &mut [Item], mark: usize) -> Option<()> {
    let covered = table.follow(2).coverage(items[mark].glyph())?;
    let base = lookup.without_marks().last(font, items, mark)?;
    attach(table, items, (covered, mark), base)
}

fn sit_on_mark(font: &Font<'_>, lookup: Lookup<'_>, table: Bytes<'_>, items: &mut [Item], mark: usize) -> Option<()> {
    let covered = table.follow(2).coverage(items[mark].glyph())?;
    let base = lookup.with_all_classes().last(font, items, mark).filter(|&base| items[base].class == 3)?;
    attach(table, items, (covered, mark), base)
}

/// Lays the mark's anchor on that of its base.
fn attach(table: Bytes<'_>, items: &mut [Item], (covered, mark): (usize, usize), base: usize) -> Option<()> {
    let covered_base = table.follow(4).coverage(items[base].glyph())?;
    let (class_count, marks, bases) = (table.index(6), table.follow(8), table.follow(10));
    let record = 2 + 4 * covered;
    let class = marks.index(record);
    if class >= class_count {
        return None;
    }
    let [on_mark, on_base] = [marks.follow(record + 2), bases.follow(2 + 2 * (covered_base * class_count + class))];
    if on_base.0.is_empty() {
        return None;
    }
    let item = &mut items[mark];
    item.position.x_offset = on_base.i16(2) - on_mark.i16(2);
    item.position.y_offset = on_base.i16(4) - on_mark.i16(4);
    item.sits_on = mark - base;
    Some(())
}
