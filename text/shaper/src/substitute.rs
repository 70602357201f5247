//! Glyphs that take the place of others.
//!
//! Source: OpenType specification 1.9.1, table `GSUB`.

use crate::buffer::Item;
use crate::bytes::Bytes;
use crate::context::chained;
use crate::font::Font;
use crate::lookup::{Lookup, lookups_of};

/// Substitutes all glyphs of a text.
pub(crate) fn substitute(font: &Font<'_>, script: &[u8; 4], items: &mut Vec<Item>) {
    for lookup in lookups_of(font.substitutions, script) {
        let Some(lookup) = Lookup::of(font.substitutions, lookup) else { continue };
        let mut place = 0;
        while place < items.len() {
            if lookup.sees(font, &items[place]) {
                apply(font, lookup, items, place, true);
            }
            place += 1;
        }
    }
}

/// Applies the first subtable of a lookup that has something for the glyph at a place.
fn apply(font: &Font<'_>, lookup: Lookup<'_>, items: &mut Vec<Item>, place: usize, may_nest: bool) -> bool {
    lookup.subtables().any(|(kind, table)| match kind {
        1 => single(font, table, &mut items[place]),
        4 => ligature(font, lookup, table, items, place),
        6 if may_nest => {
            let Some(matched) = chained(font, lookup, table, items, place) else { return false };
            for (place, nested) in matched.records() {
                if let Some(nested) = Lookup::of(font.substitutions, nested).filter(|_| place < items.len()) {
                    apply(font, nested, items, place, false);
                }
            }
            true
        }
        _ => false,
    })
}

fn single(font: &Font<'_>, table: Bytes<'_>, item: &mut Item) -> bool {
    let Some(place) = table.follow(2).coverage(item.glyph()) else { return false };
    let glyph = match table.u16(0) {
        1 => item.glyph().wrapping_add(table.u16(4)),
        _ => table.u16(6 + 2 * place),
    };
    item.set(font, glyph);
    true
}

fn ligature(font: &Font<'_>, lookup: Lookup<'_>, table: Bytes<'_>, items: &mut Vec<Item>, place: usize) -> bool {
    let Some(set) = table.follow(2).coverage(items[place].glyph()) else { return false };
    let set = table.follow(6 + 2 * set);
    for nth in 0..set.index(0) {
        let ligature = set.follow(2 + 2 * nth);
        let (mut last, mut parts) = (place, vec![]);
        for component in 1..ligature.index(2) {
            let next = lookup.next(font, items, last);
            let Some(next) = next.filter(|&next| items[next].glyph() == ligature.u16(2 + 2 * component)) else { break };
            (last, _) = (next, parts.push(next));
        }
        if parts.len() + 1 == ligature.index(2) {
            items[place].set(font, ligature.u16(0));
            for part in parts.into_iter().rev() {
                items.remove(part);
            }
            return true;
        }
    }
    false
}
