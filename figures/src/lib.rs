//! Figures as SVG: paths, circles, rectangles and text, and axes with curves over them.
//!
//! ```
//! use kalmanscope_figures::{Axes, Color, Style, Svg};
//! let mut svg = Svg::default();
//! let axes = Axes { area: [60.0, 10.0, 400.0, 200.0], x: [0.0, 2.0], y: [-1.0, 1.0] };
//! axes.grid(&mut svg, "x [m]", Some("t [s]"), &|number| number.to_string());
//! let curve = (0..200).map(|k| (0.01 * f64::from(k), (0.1 * f64::from(k)).sin()));
//! axes.line(&mut svg, curve, Style::stroke(Color([0, 114, 178, 255]), 1.5));
//! assert!(svg.finish([480.0, 260.0], [480.0, 260.0], "").ends_with("</svg>\n"));
//! ```

mod axes;
mod svg;

pub use axes::{Axes, marks};
pub use svg::{Anchor, Color, Point, Style, Svg, Text, escaped};
