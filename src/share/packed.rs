//! Compresses a link's text: deflate after a dictionary, and a check of the text.
//!
//! The dictionary is a text like those of most links. Compression and decompression begin with the dictionary, and the
//! result does not include it, so that a link has little more than its differences from the dictionary. The dictionary
//! belongs to the format: a change of it needs a new version, and the old one must be kept.

use kalmanscope_core::internals::short_hash;
use miniz_oxide::deflate::core::{CompressorOxide, TDEFLFlush, compress_to_output, create_comp_flags_from_zip_params};
use miniz_oxide::inflate::TINFLStatus;
use miniz_oxide::inflate::core::inflate_flags::TINFL_FLAG_USING_NON_WRAPPING_OUTPUT_BUF;
use miniz_oxide::inflate::core::{DecompressorOxide, decompress};

const DICTIONARY: &[u8] = include_bytes!("dictionary.txt");

/// Limits the decompressed text \[bytes\].
const LARGEST: usize = 65_536;

/// Slow and small.
const LEVEL: i32 = 9;

/// Deflate without the header of zlib: a negative number of bits.
const RAW: i32 = -15;

/// The compressed text with its check.
pub(super) fn pack(text: &str) -> Vec<u8> {
    let mut compressor = CompressorOxide::new(create_comp_flags_from_zip_params(LEVEL, RAW, 0));
    // The result begins on a full byte after this.
    compress_to_output(&mut compressor, DICTIONARY, TDEFLFlush::Sync, |_| true);
    let mut bytes = Vec::new();
    compress_to_output(&mut compressor, text.as_bytes(), TDEFLFlush::Finish, |part| {
        bytes.extend_from_slice(part);
        true
    });
    bytes.extend_from_slice(&short_hash(text.as_bytes()).to_be_bytes());
    bytes
}

/// The text. `None` if the bytes are damaged or the text is larger than [`LARGEST`].
pub(super) fn unpack(bytes: &[u8]) -> Option<String> {
    let (bytes, expected) = bytes.split_last_chunk()?;
    let mut buffer = vec![0; DICTIONARY.len() + LARGEST];
    buffer[..DICTIONARY.len()].copy_from_slice(DICTIONARY);
    let mut decompressor = Box::<DecompressorOxide>::default();
    let flags = TINFL_FLAG_USING_NON_WRAPPING_OUTPUT_BUF;
    let (status, read, written) = decompress(&mut decompressor, bytes, &mut buffer, DICTIONARY.len(), flags);
    let text = buffer.get(DICTIONARY.len()..DICTIONARY.len() + written)?;
    let is_whole = status == TINFLStatus::Done && read == bytes.len() && short_hash(text).to_be_bytes() == *expected;
    is_whole.then(|| String::from_utf8(text.to_vec()).ok()).flatten()
}
