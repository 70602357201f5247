//! A picture as a link: its text, packed, in the fragment of an address.
//!
//! ```text
//! #link=1.DATA     DATA = base64url(deflate(JSON of the picture) + check)
//! ```
//! The number is the format's version.

pub mod address;
mod picture;

use base64::Engine as _;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use kalmanscope_core::document;
use kalmanscope_core::internals::short_hash;
use miniz_oxide::deflate::core::{CompressorOxide, TDEFLFlush, compress_to_output, create_comp_flags_from_zip_params};
use miniz_oxide::inflate::TINFLStatus;
use miniz_oxide::inflate::core::inflate_flags::TINFL_FLAG_USING_NON_WRAPPING_OUTPUT_BUF;
use miniz_oxide::inflate::core::{DecompressorOxide, decompress};
use thiserror::Error;

pub(crate) use picture::{Bookmark, Studies};
pub use picture::{Habits, PictureError, SavedPicture};

pub const MARK: &str = "#link=";

const VERSION: u32 = 1;

/// Limits the characters of a link after [`MARK`].
pub const LONGEST: usize = 16_384;

#[derive(Debug, Error)]
pub enum LinkError {
    #[error("it has {0} characters, and a link has at most {LONGEST}")]
    TooLong(usize),
    #[error("it is of version {0}, and this program reads links of version {VERSION}")]
    Version(u32),
    #[error("it is damaged: a part of it is missing or changed")]
    Damaged,
    #[error(transparent)]
    Picture(#[from] PictureError),
}

impl SavedPicture {
    /// The picture as a fragment, from `#` on.
    ///
    /// # Errors
    /// [`LinkError::Picture`] where the scenario cannot be written, [`LinkError::TooLong`] where the link would be too
    /// long.
    pub fn fragment(&self) -> Result<String, LinkError> {
        let link = packed(&self.line()?);
        if link.len() > LONGEST { Err(LinkError::TooLong(link.len())) } else { Ok(format!("{MARK}{link}")) }
    }

    /// Reads the text after [`MARK`].
    ///
    /// # Errors
    /// [`LinkError`] with the reason. No text is decoded that is longer than [`LONGEST`], and none is decompressed beyond
    /// 64 kB.
    pub fn read(link: &str) -> Result<Self, LinkError> {
        if link.len() > LONGEST {
            return Err(LinkError::TooLong(link.chars().count()));
        }
        Ok(Self::of_text(&unpacked(link)?)?)
    }
}

fn unpacked(link: &str) -> Result<String, LinkError> {
    let (version, data) = link.split_once('.').ok_or(LinkError::Damaged)?;
    match version.parse() {
        Ok(VERSION) => {}
        Ok(other) if other > VERSION => return Err(LinkError::Version(other)),
        _ => return Err(LinkError::Damaged),
    }
    let bytes = URL_SAFE_NO_PAD.decode(data).map_err(|_| LinkError::Damaged)?;
    unpack(&bytes).ok_or(LinkError::Damaged)
}

const SETTINGS: &str = include_str!("share/dictionary.txt");
const SCREENS: &str = include_str!("share/screens.txt");

/// Limits the decompressed text \[bytes\].
const LARGEST: usize = 65_536;

const LEVEL: i32 = 9;

/// Deflate without the header of zlib: a negative number of bits.
const RAW: i32 = -15;

fn dictionary() -> Vec<u8> {
    let settings = document::to_json(SETTINGS).unwrap_or_default();
    [settings.trim_matches('"'), SCREENS].concat().into_bytes()
}

fn packed(text: &str) -> String {
    let mut compressor = CompressorOxide::new(create_comp_flags_from_zip_params(LEVEL, RAW, 0));
    // The result begins on a full byte after this.
    // A key that the dictionary has becomes a reference, so that usual keys take a few bits of a link.
    compress_to_output(&mut compressor, &dictionary(), TDEFLFlush::Sync, |_| true);
    let mut bytes = Vec::new();
    compress_to_output(&mut compressor, text.as_bytes(), TDEFLFlush::Finish, |part| {
        bytes.extend_from_slice(part);
        true
    });
    // Programs cut long links: what is left may still be base64, and only the check shows that it is damaged.
    bytes.extend_from_slice(&short_hash(text.as_bytes()).to_be_bytes());
    format!("{VERSION}.{}", URL_SAFE_NO_PAD.encode(bytes))
}

fn unpack(bytes: &[u8]) -> Option<String> {
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

#[cfg(test)]
mod tests;
