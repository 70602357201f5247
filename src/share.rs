//! A picture as a link: the state of the screen, compressed, in the fragment of an address.
//!
//! ```text
//! #link=1.DATA     DATA = base64url(deflate(line of JSON + scenario as TOML) + check)
//! ```
//! The number is the format's version. A program reads the versions up to its own.

pub mod address;
mod base64url;
pub mod message;
mod outline;
mod packed;
mod picture;
mod tiles;

use kalmanscope_core::{Document, DocumentError, Scenario};
use thiserror::Error;

use crate::laboratory::Choices;
use crate::layout::Layout;
use crate::ruler::Ruler;
use crate::session::{Mode, Session};

pub use outline::Outline;
pub(crate) use picture::Screen;
pub use picture::{Picture, PictureError};
pub(crate) use tiles::outline_of_tiles;

/// The beginning of a fragment with a link.
pub const MARK: &str = "#link=";

/// The newest format.
const VERSION: u32 = 1;

/// Limits the characters of a link after [`MARK`].
pub const LONGEST: usize = 16_384;

/// The reason why a link cannot be read or made.
#[derive(Debug, Error)]
pub enum LinkError {
    /// The text is longer than [`LONGEST`].
    #[error("it has {0} characters, and a link has at most {LONGEST}")]
    TooLong(usize),
    /// The version is not known.
    #[error("it is of version {0}, and this program reads links up to version {VERSION}")]
    Newer(u64),
    /// The text was not written by a program, or is damaged.
    #[error("it is damaged: a part of it is missing or changed")]
    Damaged,
    /// The picture is not valid.
    #[error(transparent)]
    Picture(#[from] PictureError),
}

impl Picture {
    /// The picture with these settings and views, at the usual speed, without marks, with all of the legend.
    pub(crate) fn new(scenario: Scenario, layout: &Layout, mode: Mode, time: f64) -> Self {
        let (views, enlarged) = (Outline::of(layout.tree()), layout.enlarged());
        let (speed, ruler, hidden) = (Session::DEFAULT_SPEED, Ruler::default(), Vec::new());
        let laboratory = Choices::default();
        Self { scenario, views, enlarged, laboratory, mode, time, speed, ruler, hidden }
    }

    /// The picture as a fragment, from `#` on.
    ///
    /// # Errors
    /// [`LinkError::Picture`] where the scenario cannot be written, [`LinkError::TooLong`] where the link would be too
    /// long.
    pub fn fragment(&self) -> Result<String, LinkError> {
        let (screen, scenario) = self.parts()?;
        let screen = Document::json(&screen).map_err(|error: DocumentError| PictureError::Screen(error.to_string()))?;
        let text = format!("{screen}\n{scenario}");
        let link = format!("{VERSION}.{}", base64url::encode(&packed::pack(&text)));
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
        let (version, data) = link.split_once('.').ok_or(LinkError::Damaged)?;
        match version.parse() {
            Ok(newer) if newer > u64::from(VERSION) => return Err(LinkError::Newer(newer)),
            Ok(version) if version == u64::from(VERSION) => {}
            _ => return Err(LinkError::Damaged),
        }
        let bytes = base64url::decode(data).ok_or(LinkError::Damaged)?;
        let text = packed::unpack(&bytes).ok_or(LinkError::Damaged)?;
        let (screen, scenario) = text.split_once('\n').ok_or(LinkError::Damaged)?;
        let screen =
            Document::read_json(screen).map_err(|error: DocumentError| PictureError::Screen(error.to_string()))?;
        Ok(Self::of_parts(screen, scenario)?)
    }

    /// The views as tiles.
    pub(crate) fn layout(&self) -> Layout {
        Layout::of_outline(self.views.as_ref(), self.enlarged)
    }
}

#[cfg(test)]
mod tests;
