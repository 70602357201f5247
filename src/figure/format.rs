//! Sizes of figures, of their type and of their lines.

use crate::request::FigureFormat;

/// The length of a point \[mm\].
pub(super) const MILLIMETRES_PER_POINT: f32 = 25.4 / 72.0;

/// The size of type on the canvas \[points of the canvas\]. Views are laid out for type of about this size.
pub(super) const TYPE: f32 = 12.0;

pub(super) struct Geometry {
    pub(super) width: f32,
    /// Height over width. `None` if the contents determine the height.
    pub(super) aspect: Option<f32>,
    pub(super) type_size: f32,
    /// The width of the finest and of the boldest curve \[points\].
    pub(super) curves: [f32; 2],
    /// Whether views stand one below the other, because there is no room for two.
    pub(super) is_narrow: bool,
}

impl Geometry {
    pub(super) fn of(format: FigureFormat) -> Self {
        let paper = |millimetres: f32, is_narrow| Self {
            width: millimetres / MILLIMETRES_PER_POINT,
            aspect: None,
            type_size: 8.0,
            curves: [0.5, 0.75],
            is_narrow,
        };
        match format {
            FigureFormat::Column => paper(84.0, true),
            FigureFormat::Page => paper(174.0, false),
            FigureFormat::Slide => {
                Self { width: 960.0, aspect: Some(9.0 / 16.0), type_size: 18.0, curves: [2.0, 4.0], is_narrow: false }
            }
        }
    }
}

impl FigureFormat {
    pub const ALL: [Self; 3] = [Self::Column, Self::Page, Self::Slide];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Column => "Paper, 84 mm",
            Self::Page => "Paper, 174 mm",
            Self::Slide => "Slide, 16:9",
        }
    }

    pub(crate) const fn key(self) -> &'static str {
        match self {
            Self::Column => "84mm",
            Self::Page => "174mm",
            Self::Slide => "slide",
        }
    }
}
