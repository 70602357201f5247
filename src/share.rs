//! A picture as a link: its text, packed, in the fragment of an address.
//!
//! ```text
//! #link=1.DATA     DATA = base64url(deflate(JSON of the picture) + check)
//! ```
//! The number is the format's version.

pub mod address;
mod outline;
mod packed;
mod picture;

use base64::Engine as _;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use thiserror::Error;

pub use outline::Outline;
pub use picture::{Habits, Picture, PictureError};

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

impl Picture {
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

fn packed(text: &str) -> String {
    format!("{VERSION}.{}", URL_SAFE_NO_PAD.encode(packed::pack(text)))
}

fn unpacked(link: &str) -> Result<String, LinkError> {
    let (version, data) = link.split_once('.').ok_or(LinkError::Damaged)?;
    match version.parse() {
        Ok(VERSION) => {}
        Ok(other) if other > VERSION => return Err(LinkError::Version(other)),
        _ => return Err(LinkError::Damaged),
    }
    let bytes = URL_SAFE_NO_PAD.decode(data).map_err(|_| LinkError::Damaged)?;
    packed::unpack(&bytes).ok_or(LinkError::Damaged)
}

#[cfg(test)]
mod tests;
