//! Drawings of oscillators that one can build, and the steps of an experiment.

use egui::epaint::QuadraticBezierShape;
use egui::{Align, Color32, Layout, Pos2, Rect, RichText, Sense, Shape, Stroke, StrokeKind, Ui, UiBuilder, pos2, vec2};

use crate::theme::Palette;

/// A part of a drawing \[points, from its corner\].
enum Part {
    Line(&'static [[f32; 2]]),
    Curve([[f32; 2]; 3]),
    /// Corner and size of a phone or a clamp.
    Frame([f32; 4]),
    /// An arrow along the motion: the place across, and both ends.
    Arrow(f32, [f32; 2]),
}

use Part::{Arrow, Curve, Frame, Line};

/// A set-up: its drawing and name, an advice, and the usual frequency and damping.
struct SetUp {
    parts: &'static [Part],
    name: &'static str,
    care: &'static str,
    usual: &'static str,
}

/// The size of a drawing \[points\].
const SIZE: [f32; 2] = [150.0, 130.0];

/// The width of a set-up with its words \[points\].
const WIDTH: f32 = 178.0;

/// The height that a set-up has for its drawing and its words \[points\].
const HEIGHT: f32 = 250.0;

const SET_UPS: [SetUp; 4] = [
    SetUp {
        parts: &[
            Line(&[[30.0, 8.0], [120.0, 8.0]]),
            Line(&[
                [75.0, 8.0],
                [75.0, 14.0],
                [84.0, 18.0],
                [66.0, 25.0],
                [84.0, 32.0],
                [66.0, 39.0],
                [84.0, 46.0],
                [66.0, 53.0],
                [75.0, 57.0],
                [75.0, 64.0],
            ]),
            Frame([58.0, 64.0, 34.0, 58.0]),
            Arrow(112.0, [72.0, 114.0]),
        ],
        name: "On a rubber band",
        care: "A phone in a bag. Pull it down by a hand's width, and let go without a push.",
        usual: "1 to 2 Hz, ζ 0.5 to 3 %",
    },
    SetUp {
        parts: &[
            Line(&[[8.0, 124.0], [8.0, 60.0], [46.0, 60.0], [46.0, 124.0]]),
            Frame([16.0, 46.0, 22.0, 14.0]),
            Line(&[[14.0, 53.0], [128.0, 53.0]]),
            Frame([92.0, 37.0, 42.0, 14.0]),
            Arrow(142.0, [30.0, 74.0]),
        ],
        name: "At the end of a ruler",
        care: "A phone taped to it. Clamp the other end: what slips there damps.",
        usual: "2 to 6 Hz, ζ 1 to 5 %",
    },
    SetUp {
        parts: &[
            Line(&[[6.0, 124.0], [6.0, 66.0], [22.0, 66.0]]),
            Line(&[[6.0, 94.0], [34.0, 94.0], [34.0, 124.0]]),
            Line(&[[116.0, 124.0], [116.0, 94.0], [144.0, 94.0], [144.0, 66.0], [128.0, 66.0]]),
            Line(&[[144.0, 94.0], [144.0, 124.0]]),
            Curve([[10.0, 63.0], [75.0, 78.0], [140.0, 63.0]]),
            Frame([52.0, 54.0, 46.0, 13.0]),
            Arrow(75.0, [12.0, 44.0]),
        ],
        name: "On a plank",
        care: "In the middle, between two chairs. Push it down once; hands off the chairs.",
        usual: "3 to 10 Hz, ζ 1 to 3 %",
    },
    SetUp {
        parts: &[
            Line(&[[38.0, 124.0], [38.0, 84.0]]),
            Line(&[[22.0, 66.0], [22.0, 8.0]]),
            Line(&[[54.0, 66.0], [54.0, 8.0]]),
            Curve([[22.0, 66.0], [22.0, 84.0], [38.0, 84.0]]),
            Curve([[54.0, 66.0], [54.0, 84.0], [38.0, 84.0]]),
            Curve([[66.0, 28.0], [76.0, 44.0], [66.0, 60.0]]),
            Curve([[76.0, 20.0], [92.0, 44.0], [76.0, 68.0]]),
            Frame([106.0, 26.0, 34.0, 58.0]),
        ],
        name: "Beside a fork",
        care: "A tuning fork, a glass, a ruler that hums: strike it once, a hand's width from the phone.",
        usual: "100 to 4000 Hz, ζ 0.02 to 0.3 %",
    },
];

const STEPS: [&str; 4] = [
    "1. Measure with a phone: Scenario, Measure with this device…, then Open the record. Or open a file of one.",
    "2. Look at Measured and predicted: is it a damped oscillator at all? The residual must have no pattern.",
    "3. Add this run. Measure again: the same shows how well it repeats; with a coin more, write its mass beside it.",
    "4. With several masses, the slope of T² over the mass is the spring's stiffness.",
];

/// Shows the steps, and all set-ups.
pub(super) fn setups_ui(ui: &mut Ui, palette: &Palette) {
    ui.add_space(4.0);
    for step in STEPS {
        ui.label(step);
    }
    ui.add_space(8.0);
    ui.horizontal_wrapped(|ui| {
        for set_up in &SET_UPS {
            let (room, _) = ui.allocate_exact_size(vec2(WIDTH, HEIGHT), Sense::hover());
            let mut own =
                ui.new_child(UiBuilder::new().id_salt(set_up.name).max_rect(room).layout(Layout::top_down(Align::Min)));
            let (rect, drawing) = own.allocate_exact_size(SIZE.into(), Sense::hover());
            drawing.ctx.accesskit_node_builder(drawing.id, |node| node.set_label(format!("Drawing: {}", set_up.name)));
            set_up.parts.iter().for_each(|part| own.painter().extend(part.shapes(rect, palette)));
            own.strong(set_up.name);
            own.label(set_up.care);
            own.label(RichText::new(format!("usual: {}", set_up.usual)).small().color(palette.weak));
        }
    });
}

impl Part {
    fn shapes(&self, rect: Rect, palette: &Palette) -> Vec<Shape> {
        let at = |[x, y]: [f32; 2]| rect.min + vec2(x, y);
        let stroke = Stroke::new(1.8, palette.text);
        match self {
            Line(points) => vec![Shape::line(points.iter().copied().map(at).collect(), stroke)],
            Curve(points) => {
                let curve =
                    QuadraticBezierShape::from_points_stroke(points.map(at), false, Color32::TRANSPARENT, stroke);
                vec![curve.into()]
            }
            Frame([x, y, width, height]) => {
                let sides = Rect::from_min_size(at([*x, *y]), vec2(*width, *height));
                vec![Shape::rect_stroke(sides, 4.0, stroke, StrokeKind::Middle)]
            }
            Arrow(x, ends) => {
                let [top, bottom] = ends.map(|y| at([*x, y]));
                let stroke = Stroke::new(1.8, palette.accent);
                let head = |tip: Pos2, up: f32| {
                    let wing = |side: f32| pos2(tip.x + side, tip.y + up);
                    Shape::line(vec![wing(-4.0), tip, wing(4.0)], stroke)
                };
                vec![Shape::line(vec![top, bottom], stroke), head(top, 6.0), head(bottom, -6.0)]
            }
        }
    }
}
