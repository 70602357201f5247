//! Compresses a link's text: deflate after a dictionary, and a check of the text.
//!
//! The dictionary is a text like those of most links. Compression and decompression begin with the dictionary, and the
//! result does not include it, so that a link has little more than its differences from the dictionary. The dictionary
//! belongs to the format: a change of it needs a new version.

use kalmanscope_core::Document;
use kalmanscope_core::internals::short_hash;
use miniz_oxide::deflate::core::{CompressorOxide, TDEFLFlush, compress_to_output, create_comp_flags_from_zip_params};
use miniz_oxide::inflate::TINFLStatus;
use miniz_oxide::inflate::core::inflate_flags::TINFL_FLAG_USING_NON_WRAPPING_OUTPUT_BUF;
use miniz_oxide::inflate::core::{DecompressorOxide, decompress};

const SETTINGS: &str = include_str!("dictionary.txt");
const SCREENS: &str = include_str!("screens.txt");

/// Limits the decompressed text \[bytes\].
const LARGEST: usize = 65_536;

const LEVEL: i32 = 9;

/// Deflate without the header of zlib: a negative number of bits.
const RAW: i32 = -15;

fn dictionary() -> Vec<u8> {
    let settings = Document::json(SETTINGS).unwrap_or_default();
    [settings.trim_matches('"'), SCREENS].concat().into_bytes()
}

pub(super) fn pack(text: &str) -> Vec<u8> {
    let mut compressor = CompressorOxide::new(create_comp_flags_from_zip_params(LEVEL, RAW, 0));
    // The result begins on a full byte after this.
    compress_to_output(&mut compressor, &dictionary(), TDEFLFlush::Sync, |_| true);
    let mut bytes = Vec::new();
    compress_to_output(&mut compressor, text.as_bytes(), TDEFLFlush::Finish, |part| {
        bytes.extend_from_slice(part);
        true
    });
    bytes.extend_from_slice(&short_hash(text.as_bytes()).to_be_bytes());
    bytes
}

pub(super) fn unpack(bytes: &[u8]) -> Option<String> {
    let (bytes, expected) = bytes.split_last_chunk()?;
    let mut buffer = dictionary();
    let begin = buffer.len();
    buffer.resize(begin + LARGEST, 0);
    let mut decompressor = Box::<DecompressorOxide>::default();
    let flags = TINFL_FLAG_USING_NON_WRAPPING_OUTPUT_BUF;
    let (status, read, written) = decompress(&mut decompressor, bytes, &mut buffer, begin, flags);
    let text = buffer.get(begin..begin + written)?;
    let is_whole = status == TINFLStatus::Done && read == bytes.len() && short_hash(text).to_be_bytes() == *expected;
    is_whole.then(|| String::from_utf8(text.to_vec()).ok()).flatten()
}
