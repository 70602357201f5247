//! Glyphs and places are those of the crate in whose place this one stands, which has written `shaped.tsv`: font, text, and
//! for each glyph `glyph@cluster:advance,x offset,y offset` in font units.

#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

use harfrust::{FontRef, ShapeOptions, ShaperData, UnicodeBuffer};

fn shaped(font: &[u8], text: &str) -> String {
    let font = FontRef::from_index(font, 0).unwrap();
    let shaper = ShaperData::new(&font).shaper(&font).instance(None).build();
    let mut buffer = UnicodeBuffer::new();
    buffer.push_str(text);
    buffer.guess_segment_properties();
    let glyphs = shaper.shape(buffer, ShapeOptions::new());
    let pairs = glyphs.glyph_infos().iter().zip(glyphs.glyph_positions());
    let written = pairs.map(|(info, at)| {
        format!("{}@{}:{},{},{}", info.glyph_id, info.cluster, at.x_advance, at.x_offset, at.y_offset)
    });
    written.collect::<Vec<_>>().join(" ")
}

/// Undoes `\u{…}`.
fn unescaped(text: &str) -> String {
    let mut parts = text.split(r"\u{");
    let mut all = parts.next().unwrap().to_owned();
    for part in parts {
        let (code, rest) = part.split_once('}').unwrap();
        all.push(char::from_u32(u32::from_str_radix(code, 16).unwrap()).unwrap());
        all.push_str(rest);
    }
    all
}

#[test]
fn texts_are_shaped_as_by_harfrust() {
    let mut texts = 0;
    for line in include_str!("shaped.tsv").lines() {
        let [font, text, glyphs] = line.splitn(3, '\t').collect::<Vec<_>>().try_into().unwrap();
        let path = format!("{}/../../assets/fonts/{font}.subset.ttf", env!("CARGO_MANIFEST_DIR"));
        assert_eq!(shaped(&std::fs::read(&path).expect(&path), &unescaped(text)), glyphs, "{font}: {text}");
        texts += 1;
    }
    assert_eq!(texts, 54);
}

#[test]
fn no_text_and_no_font_make_no_glyphs() {
    let regular = include_bytes!("../../../assets/fonts/NotoSans-Regular.subset.ttf");
    assert_eq!(shaped(regular, ""), "");
    // A font that ends in the middle of its tables gives some glyphs or other, and no panic.
    for len in (200..regular.len()).step_by(997) {
        let mut broken = regular.to_vec();
        broken[len..].fill(0xFF);
        shaped(&broken, "AV fi\u{308}\u{301} ωₙ");
    }
}
