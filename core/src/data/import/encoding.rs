//! The encodings of text files.

use serde::{Deserialize, Serialize};

/// The encoding of a text file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Encoding {
    /// UTF-8, which includes ASCII.
    #[default]
    Utf8,
    /// Latin-1, one byte a character.
    Latin1,
    /// UTF-16, the lower byte first.
    Utf16Le,
    /// UTF-16, the higher byte first.
    Utf16Be,
}

/// The first bytes of encodings that announce themselves.
const MARKS: [(&[u8], Encoding); 3] =
    [(b"\xEF\xBB\xBF", Encoding::Utf8), (b"\xFF\xFE", Encoding::Utf16Le), (b"\xFE\xFF", Encoding::Utf16Be)];

impl Encoding {
    /// Every encoding.
    pub const ALL: [Self; 4] = [Self::Utf8, Self::Latin1, Self::Utf16Le, Self::Utf16Be];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Utf8 => "UTF-8",
            Self::Latin1 => "Latin-1",
            Self::Utf16Le => "UTF-16",
            Self::Utf16Be => "UTF-16 (big-endian)",
        }
    }

    /// The encoding of a file that begins with these bytes, or `None` if it is not text.
    pub fn sniff(bytes: &[u8]) -> Option<Self> {
        if let Some(&(_, marked)) = MARKS.iter().find(|(mark, _)| bytes.starts_with(mark)) {
            return Some(marked);
        }
        // Digits and delimiters have a zero byte each in UTF-16.
        let zeros = |first: usize| bytes.iter().skip(first).step_by(2).filter(|&&byte| byte == 0).count();
        let (even, odd) = (zeros(0), zeros(1));
        let most = bytes.len() / 3;
        if even + odd > 0 {
            return match (even, odd) {
                (0, _) if odd >= most => Some(Self::Utf16Le),
                (_, 0) if even >= most => Some(Self::Utf16Be),
                _ => None,
            };
        }
        let is_control = |byte: &&u8| **byte < b' ' && !matches!(**byte, b'\t' | b'\n' | b'\r' | 0x0C);
        if bytes.iter().filter(is_control).count() * 100 > bytes.len() {
            return None;
        }
        Some(match std::str::from_utf8(bytes) {
            // The end may lie within a character.
            Ok(_) => Self::Utf8,
            Err(error) if error.error_len().is_none() => Self::Utf8,
            Err(_) => Self::Latin1,
        })
    }

    /// The number of bytes of the mark at the beginning.
    pub(super) fn mark(self, bytes: &[u8]) -> usize {
        let own = MARKS.iter().find(|(mark, encoding)| *encoding == self && bytes.starts_with(mark));
        own.map_or(0, |(mark, _)| mark.len())
    }

    /// Appends the text of some bytes. Invalid characters become `�`.
    pub(super) fn decode(self, bytes: &[u8], text: &mut String) {
        match self {
            Self::Utf8 => text.push_str(&String::from_utf8_lossy(bytes)),
            Self::Latin1 => text.extend(bytes.iter().map(|&byte| char::from(byte))),
            Self::Utf16Le | Self::Utf16Be => {
                let number = |pair: &[u8; 2]| match self {
                    Self::Utf16Be => u16::from_be_bytes(*pair),
                    _ => u16::from_le_bytes(*pair),
                };
                let (pairs, _) = bytes.as_chunks::<2>();
                let characters = char::decode_utf16(pairs.iter().map(number));
                text.extend(characters.map(|character| character.unwrap_or(char::REPLACEMENT_CHARACTER)));
            }
        }
    }

    /// The number of bytes of the first line with its end; `None` if no line ends here.
    pub(super) fn line_length(self, bytes: &[u8]) -> Option<usize> {
        match self {
            Self::Utf8 | Self::Latin1 => bytes.iter().position(|&byte| byte == b'\n').map(|place| place + 1),
            Self::Utf16Le | Self::Utf16Be => {
                let end: [u8; 2] = if self == Self::Utf16Le { [b'\n', 0] } else { [0, b'\n'] };
                bytes.as_chunks::<2>().0.iter().position(|pair| *pair == end).map(|place| 2 * place + 2)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn utf16(text: &str) -> Vec<u8> {
        text.encode_utf16().flat_map(u16::to_le_bytes).collect()
    }

    #[test]
    fn encodings_are_found_with_and_without_a_mark() {
        assert_eq!(Encoding::sniff(b"t,x\n1,2\n"), Some(Encoding::Utf8));
        assert_eq!(Encoding::sniff("\u{FEFF}t,x\n".as_bytes()), Some(Encoding::Utf8));
        assert_eq!(Encoding::sniff("Größe;Weg\n".as_bytes()), Some(Encoding::Utf8));
        assert_eq!(Encoding::sniff(b"Gr\xF6\xDFe;Weg\n"), Some(Encoding::Latin1));
        assert_eq!(Encoding::sniff(&utf16("t;x\n1;2\n")), Some(Encoding::Utf16Le));
        assert_eq!(Encoding::sniff(&utf16("\u{FEFF}t;x\n1;2\n")), Some(Encoding::Utf16Le));
        let big: Vec<u8> = "t;x\n1;2\n".encode_utf16().flat_map(u16::to_be_bytes).collect();
        assert_eq!(Encoding::sniff(&big), Some(Encoding::Utf16Be));
        assert_eq!(Encoding::sniff(b"\x7FELF\x02\x01\x01\x00\x00\x03\x10\x00\x00"), None);
        assert_eq!(Encoding::sniff(b"\x89PNG\r\n\x1A\n\x01\x02\x03"), None);
    }

    #[test]
    fn a_character_that_is_cut_at_the_end_does_not_change_the_encoding() {
        let text = "Größe".as_bytes();
        assert_eq!(Encoding::sniff(&text[..3]), Some(Encoding::Utf8));
    }

    #[test]
    fn lines_are_found_and_decoded() {
        let bytes = utf16("a;b\n1;2\n");
        let end = Encoding::Utf16Le.line_length(&bytes).unwrap();
        let mut text = String::new();
        Encoding::Utf16Le.decode(&bytes[..end], &mut text);
        assert_eq!(text, "a;b\n");
        text.clear();
        Encoding::Latin1.decode(b"\xE4", &mut text);
        assert_eq!(text, "ä");
    }
}
