//! A packed file comes in parts of any size and is the same again; what is broken is refused.

use std::io::{self, Write};

use kalmanscope_unpack::Unpacker;
use lzma_rust2::{LzmaOptions, LzmaWriter};

/// Bytes that repeat themselves in part: 300,000 of them, more than are unpacked at once.
fn file() -> Vec<u8> {
    (0..300_000_u32)
        .map(|i| if i % 1000 < 700 { (i % 251) as u8 } else { (i.wrapping_mul(2_654_435_761) >> 24) as u8 })
        .collect()
}

fn packed(file: &[u8]) -> io::Result<Vec<u8>> {
    let options = LzmaOptions { lc: 8, pb: 0, ..LzmaOptions::with_preset(6) };
    let mut writer = LzmaWriter::new_use_header(Vec::new(), &options, Some(file.len() as u64))?;
    writer.write_all(file)?;
    writer.finish()
}

#[test]
fn parts_of_any_size_unpack_to_the_file() {
    let file = file();
    let packed = packed(&file).unwrap();
    assert!(packed.len() < file.len() / 2, "{}", packed.len());
    for size in [1, 7, 1000, 65_536, packed.len()] {
        let mut unpacker = Unpacker::new();
        let mut all = Vec::new();
        for part in packed.chunks(size) {
            assert!(!unpacker.is_complete(), "parts of {size}");
            all.extend(unpacker.push(part).unwrap());
        }
        assert!(all == file, "parts of {size}: {} bytes of {}", all.len(), file.len());
        assert!(unpacker.is_complete(), "parts of {size}");
        assert_eq!(unpacker.push(b"behind the end"), Ok(Vec::new()));
    }
}

#[test]
fn a_file_that_ends_early_is_not_complete() {
    let packed = packed(&file()).unwrap();
    let mut unpacker = Unpacker::new();
    unpacker.push(&packed[..packed.len() - 100]).unwrap();
    assert!(!unpacker.is_complete());
}

#[test]
fn what_is_not_packed_is_refused() {
    let mut unpacker = Unpacker::new();
    let sentence = unpacker.push(b"<!doctype html><title>404 Not Found</title>").unwrap_err();
    assert!(!sentence.is_empty());
    assert!(unpacker.push(&packed(&file()).unwrap()).is_err(), "and it stays refused");
}
