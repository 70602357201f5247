//! A small drawing of each view, for the menu.

use egui::Color32;
use kalmanscope_core::FilterColor;

use crate::request::ViewKind;
use crate::spark::{Spark, SparkInk, SparkMark, SparkPicture};
use crate::theme;

/// Columns of a drawing, and the cells up of that of a map.
const COLUMNS: usize = 120;
const CELLS: usize = 6;

/// The drawing of a view, or of the first of its tabs: it shows the kind of plot, not a run.
pub(crate) fn sketch(view: ViewKind) -> SparkPicture {
    let noise = |x: f64| (91.0 * x).sin() * (57.0 * x).cos();
    let wave = |x: f64| 0.9 * (19.0 * x).sin();
    let course = |mark: SparkMark, of: &dyn Fn(f64) -> [f64; 2]| {
        let spark = Spark::over((-1.05, 1.05), COLUMNS, |k| of(k as f64 / COLUMNS as f64));
        (mark, SparkInk::Filter(FilterColor::ALL[0]), spark)
    };
    let band = |half: &dyn Fn(f64) -> f64| course(SparkMark::Band, &|x| [-half(x), half(x)]);
    let line = |of: &dyn Fn(f64) -> f64| course(SparkMark::Line, &|x| [of(x); 2]);
    let courses = match view {
        ViewKind::Oscillator => {
            vec![course(SparkMark::Line, &|x| if x < 0.65 { [0.4 * (62.0 * x).sin(); 2] } else { [-0.8, 0.8] })]
        }
        ViewKind::Parameters => vec![band(&|x| (-5.0 * x).exp()), line(&|x| 0.6 * (-7.0 * x).exp() * noise(x))],
        ViewKind::Measured => vec![course(SparkMark::Dots, &|x| [wave(x) + 0.15 * noise(x); 2]), line(&wave)],
        ViewKind::Phase => vec![band(&|x| (1.0 - (2.0 * x - 1.0).powi(2)).sqrt())],
        ViewKind::FrequencyResponse => vec![line(&|x| 0.16 / (1.0 - 4.0 * x * x).hypot(0.16 * x).max(0.08) - 0.95)],
        ViewKind::Errors => vec![band(&|x| 0.5 + 0.5 * (-6.0 * x).exp()), line(&|x| 0.6 * noise(x))],
        ViewKind::Innovations => vec![course(SparkMark::Dots, &|x| [0.9 * noise(x); 2])],
        ViewKind::Scores => vec![course(SparkMark::Line, &|x| {
            if (6.0 * x).fract() < 0.6 { [-1.0, 0.8 - 0.3 * (6.0 * x).floor()] } else { [f64::NAN; 2] }
        })],
        ViewKind::Classes => vec![course(SparkMark::Band, &|x| [-1.0, 2.0 / (1.0 + (6.0 - 14.0 * x).exp()) - 1.0])],
        ViewKind::Gain => vec![line(&|x| 1.7 * (-6.0 * x).exp() - 0.7)],
        ViewKind::Matrices => vec![band(&|x| 0.3 + 0.7 * (5.0 * x).fract())],
        ViewKind::Map => Vec::new(),
        _ => vec![line(&wave)],
    };
    let cell = |k: usize| theme::sequential(((k / CELLS) as f32 / 14.0 - (k % CELLS) as f32 / 6.0).abs());
    let cells: Vec<Color32> = if view == ViewKind::Map { (0..14 * CELLS).map(cell).collect() } else { Vec::new() };
    SparkPicture { courses, cells: (CELLS, cells) }
}
