//! What characters are.

use unicode_general_category::{GeneralCategory, get_general_category};

use crate::pairs::PAIRS;

/// Whether a character is a combining mark.
pub(crate) fn is_mark(character: char) -> bool {
    use GeneralCategory::{EnclosingMark, NonspacingMark, SpacingMark};
    character >= '\u{300}' && matches!(get_general_category(character), EnclosingMark | NonspacingMark | SpacingMark)
}

/// Whether a character is a mark without a width of its own.
pub(crate) fn is_nonspacing_mark(character: char) -> bool {
    character >= '\u{300}'
        && get_general_category(character) == GeneralCategory::NonspacingMark
        && !is_hidden(character)
}

/// Whether a character joins the cluster of the one before.
pub(crate) fn continues(character: char) -> bool {
    is_mark(character)
        || matches!(u32::from(character), 0x200D | 0x1F3FB..=0x1F3FF | 0xFF9E | 0xFF9F | 0xE0020..=0xE007F)
}

/// Whether a character has no picture where nothing is done about it: `Default_Ignorable_Code_Point`.
pub(crate) fn is_hidden(character: char) -> bool {
    matches!(
        u32::from(character),
        0xAD | 0x34F
            | 0x61C
            | 0x17B4
            | 0x17B5
            | 0x180B..=0x180E
            | 0x200B..=0x200F
            | 0x202A..=0x202E
            | 0x2060..=0x206F
            | 0x3164
            | 0xFE00..=0xFE0F
            | 0xFEFF
            | 0xFFA0
            | 0xFFF0..=0xFFF8
            | 0x1BCA0..=0x1BCA3
            | 0x1D173..=0x1D17A
            | 0xE0000..=0xE0FFF
    )
}

/// The width of a space that the font lacks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Space {
    /// That of the usual space.
    Usual,
    /// Half the usual.
    Narrow,
    /// These parts of an em.
    Em(i32, i32),
    /// That of the first of these that the font has.
    As(&'static str),
}

/// The width of a space that the font lacks, if it is one.
pub(crate) fn space(character: char) -> Option<Space> {
    Some(match character {
        '\u{A0}' => Space::Usual,
        '\u{2000}' | '\u{2002}' => Space::Em(1, 2),
        '\u{2001}' | '\u{2003}' | '\u{3000}' => Space::Em(1, 1),
        '\u{2004}' => Space::Em(1, 3),
        '\u{2005}' => Space::Em(1, 4),
        '\u{2006}' => Space::Em(1, 6),
        '\u{2007}' => Space::As("0123456789"),
        '\u{2008}' => Space::As(".,"),
        '\u{2009}' => Space::Em(1, 5),
        '\u{200A}' => Space::Em(1, 16),
        '\u{202F}' => Space::Narrow,
        '\u{205F}' => Space::Em(4, 18),
        _ => return None,
    })
}

/// A character and its mark, for one that is the same as both; or another character that is the same.
pub(crate) fn parts(character: char) -> Option<(char, Option<char>)> {
    let same = match character {
        '\u{340}' => '\u{300}',
        '\u{341}' => '\u{301}',
        '\u{37E}' => ';',
        '\u{387}' => '·',
        '\u{2126}' => 'Ω',
        '\u{212A}' => 'K',
        '\u{212B}' => 'Å',
        _ => {
            let code = u16::try_from(u32::from(character)).ok()?;
            let place = PAIRS.binary_search_by_key(&code, |pair| pair[0]).ok()?;
            let [_, letter, mark] = PAIRS[place].map(|code| char::from_u32(u32::from(code)));
            return letter.map(|letter| (letter, mark));
        }
    };
    Some((same, None))
}

/// The character that is the same as a letter and a mark.
pub(crate) fn composed(letter: char, mark: char) -> Option<char> {
    let parts = [letter, mark].map(|part| u16::try_from(u32::from(part)).unwrap_or(0));
    PAIRS.iter().find(|pair| pair[1..] == parts).and_then(|pair| char::from_u32(u32::from(pair[0])))
}

/// The script of a text: that of its first character that has one.
pub(crate) fn script_of(text: &str) -> &'static [u8; 4] {
    text.chars().find_map(script).unwrap_or(b"DFLT")
}

fn script(character: char) -> Option<&'static [u8; 4]> {
    Some(match u32::from(character) {
        0x41..=0x5A
        | 0x61..=0x7A
        | 0xAA
        | 0xBA
        | 0xC0..=0xD6
        | 0xD8..=0xF6
        | 0xF8..=0x2B8
        | 0x2E0..=0x2E4
        | 0x1D00..=0x1D25
        | 0x1D2C..=0x1D5C
        | 0x1D62..=0x1D65
        | 0x1D6B..=0x1D77
        | 0x1D79..=0x1DBE
        | 0x1E00..=0x1EFF
        | 0x2071
        | 0x207F
        | 0x2090..=0x209C
        | 0x212A
        | 0x212B => b"latn",
        0x37E | 0x385 | 0x387 => return None,
        0x370..=0x3E1
        | 0x3F0..=0x3FF
        | 0x1D26..=0x1D2A
        | 0x1D5D..=0x1D61
        | 0x1D66..=0x1D6A
        | 0x1F00..=0x1FFF
        | 0x2126 => b"grek",
        0x400..=0x484 | 0x487..=0x52F | 0x1D2B | 0x1D78 => b"cyrl",
        // Letters of scripts that no font here has.
        _ if character.is_alphabetic() && character > '\u{2FF}' => b"DFLT",
        _ => return None,
    })
}
