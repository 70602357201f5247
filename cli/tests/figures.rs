//! Figures as SVG.

use kalmanscope_figures::{Anchor, Axes, Color, Style, Svg, Text, escaped, marks};

const BLUE: Color = Color([0, 114, 178, 255]);
const AXES: Axes = Axes { area: [10.0, 0.0, 100.0, 100.0], x: [0.0, 1.0], y: [-1.0, 1.0] };

#[test]
fn marks_are_round_few_and_inside() {
    assert_eq!(marks([0.0, 60.0], 13), (0..13).map(|k| 5.0 * f64::from(k)).collect::<Vec<_>>());
    assert_eq!(marks([-1.1, 1.1], 5), [-1.0, -0.5, 0.0, 0.5, 1.0]);
    for range in
        [[-1e300, 1e300], [1e300, 1.0001e300], [0.0, f64::INFINITY], [1.0, 1.0], [f64::NAN, 1.0], [0.0, 5e-324]]
    {
        let found = marks(range, 9);
        assert!(
            found.len() <= 10 && found.iter().all(|mark| (range[0]..=range[1]).contains(mark)),
            "{range:?} {found:?}"
        );
    }
}

#[test]
fn a_line_has_gaps_and_no_number_that_is_none() {
    let mut svg = Svg::default();
    let points = [(0.0, 0.0), (0.25, 1.0), (0.5, f64::NAN), (0.75, f64::INFINITY), (1.0, -1e300), (2.0, f64::NAN)];
    AXES.line(&mut svg, points, Style::stroke(BLUE, 1.0));
    AXES.dots(&mut svg, points, 1.0, BLUE);
    let text = svg.finish([100.0; 2], [100.0; 2], "");
    assert!(text.contains("d=\"M10 50L35 0M85 -19900L110 20100\""), "{text}");
    assert!(!text.contains("NaN") && !text.contains("inf") && text.matches("<circle").count() == 2, "{text}");
}

#[test]
fn shapes_are_elements_and_text_is_never_markup() {
    let mut svg = Svg::default();
    svg.path([[0.0, 0.0], [10.0, -0.001], [5.5, 2.125]], false, Style::stroke(BLUE, 1.5));
    svg.clipped([0.0, 0.0, 20.0, 10.0], |svg| svg.ellipse([1.0, 2.0], [3.0, 3.0], Style::fill(BLUE.faded(0.2))));
    svg.clipped([0.0, 0.0, 20.0, 10.0], |svg| svg.rect([1.0, 1.0, -2.0, 2.0], 0.0, Style::default()));
    let turned = Text {
        text: "<a & b>",
        origin: [0.0; 2],
        turn: -90.0,
        at: [3.0, 4.0],
        anchor: Anchor::Middle,
        size: 12.0,
        length: None,
        bold: false,
        color: BLUE,
    };
    svg.text(&turned);
    let text = svg.finish([20.0, 10.0], [84.0, 42.0], "mm");
    for part in [
        "width=\"84mm\" height=\"42mm\" viewBox=\"0 0 20 10\"",
        "<path d=\"M0 0L10 0L5.5 2.12\" fill=\"none\" stroke=\"#0072b2\" stroke-width=\"1.5\"/>",
        "<g clip-path=\"url(#clip_0_0_20_10)\">\n<circle cx=\"1\" cy=\"2\" r=\"3\" fill=\"#0072b2\" fill-opacity=\"0.2\"/>\n</g>",
        "<rect x=\"1\" y=\"1\" width=\"0\" height=\"2\" fill=\"none\"/>",
        "rotate(-90)\" x=\"3\" y=\"4\" font-size=\"12\" text-anchor=\"middle\"",
        ">&lt;a &amp; b&gt;</text>",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    assert_eq!(text.matches("<clipPath").count(), 1, "an area is defined once");
}

#[test]
fn markup_and_forbidden_characters_are_harmless() {
    assert_eq!(escaped("<a href=\"x\">&'ωₙ'\n"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;ωₙ&#39;\n");
    assert_eq!(escaped("a\u{0}b\u{fffe}c"), "a\u{fffd}b\u{fffd}c");
}
