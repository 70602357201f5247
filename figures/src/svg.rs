//! The text of an SVG file.

use std::fmt;

/// A point to the right and downwards.
pub type Point = [f32; 2];

/// Red, green, blue and opacity, from 0 to 255, not multiplied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Color(pub [u8; 4]);

impl Color {
    /// The same colour with this share of its opacity.
    #[must_use]
    pub fn faded(self, share: f32) -> Self {
        let Self([r, g, b, a]) = self;
        Self([r, g, b, (f32::from(a) * share).round() as u8])
    }

    fn attributes(self, name: &str) -> String {
        let Self([r, g, b, a]) = self;
        let opacity =
            if a < 255 { format!(" {name}-opacity=\"{}\"", number(f32::from(a) / 255.0)) } else { String::new() };
        format!(" {name}=\"#{r:02x}{g:02x}{b:02x}\"{opacity}")
    }
}

/// Fill and stroke of a shape.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Style {
    /// The colour inside.
    pub fill: Option<Color>,
    /// The colour and the width of the outline.
    pub stroke: Option<(Color, f32)>,
}

impl Style {
    /// A shape without an outline.
    pub fn fill(color: Color) -> Self {
        Self { fill: Some(color), stroke: None }
    }

    /// An outline alone.
    pub fn stroke(color: Color, width: f32) -> Self {
        Self { fill: None, stroke: Some((color, width)) }
    }
}

impl fmt::Display for Style {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.fill.map_or_else(|| " fill=\"none\"".to_owned(), |color| color.attributes("fill")))?;
        let Some((color, width)) = self.stroke else { return Ok(()) };
        write!(f, "{} stroke-width=\"{}\"", color.attributes("stroke"), number(width))
    }
}

/// The part of a text that stands at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its beginning.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// A line of text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Text<'a> {
    /// Its letters, which are never markup.
    pub text: &'a str,
    /// The point about which it is turned.
    pub origin: Point,
    /// Degrees, clockwise.
    pub turn: f32,
    /// The place of its baseline from the origin, before it is turned.
    pub at: Point,
    /// The part that stands there.
    pub anchor: Anchor,
    /// The size of its type.
    pub size: f32,
    /// Its length in every font; `None` for that of the font.
    pub length: Option<f32>,
    /// Whether its letters are bold.
    pub bold: bool,
    /// Its colour.
    pub color: Color,
}

/// A figure under way.
#[derive(Clone, Debug, Default)]
pub struct Svg {
    body: String,
    /// Left, top, width and height of the areas outside which shapes are cut off.
    clips: Vec<[f32; 4]>,
}

impl Svg {
    /// Shapes that are moved and scaled.
    pub fn group(&mut self, [x, y]: Point, scale: f32, draw: impl FnOnce(&mut Self)) {
        let [x, y, scale] = [x, y, scale].map(number);
        self.line(&format!("<g transform=\"translate({x} {y}) scale({scale})\">"));
        draw(self);
        self.line("</g>");
    }

    /// Shapes that are cut off outside an area, which has left, top, width and height.
    pub fn clipped(&mut self, area: [f32; 4], draw: impl FnOnce(&mut Self)) {
        if !self.clips.contains(&area) {
            self.clips.push(area);
        }
        self.line(&format!("<g clip-path=\"url(#{})\">", clip_id(area)));
        draw(self);
        self.line("</g>");
    }

    /// A line through points.
    pub fn path(&mut self, points: impl IntoIterator<Item = Point>, closed: bool, style: Style) {
        self.paths([points], closed, style);
    }

    /// Several lines that are one shape: where they lie over each other the colour is no deeper.
    pub fn paths<P: IntoIterator<Item = Point>>(
        &mut self,
        paths: impl IntoIterator<Item = P>,
        closed: bool,
        style: Style,
    ) {
        let mut data = String::new();
        for path in paths {
            for (place, point) in path.into_iter().enumerate() {
                data.push(if place == 0 { 'M' } else { 'L' });
                data.push_str(&at(point));
            }
            data.push_str(if closed { "Z" } else { "" });
        }
        self.data(&data, style);
    }

    /// A curve of Bézier through two points, with one or two points that pull it.
    pub fn curve(&mut self, from: Point, pulls: &[Point], to: Point, closed: bool, style: Style) {
        let pulls: Vec<String> = pulls.iter().map(|pull| at(*pull)).collect();
        let (letter, end) = (if pulls.len() == 1 { 'Q' } else { 'C' }, if closed { "Z" } else { "" });
        self.data(&format!("M{}{letter}{} {}{end}", at(from), pulls.join(" "), at(to)), style);
    }

    fn data(&mut self, data: &str, style: Style) {
        if !data.is_empty() {
            self.line(&format!("<path d=\"{data}\"{style}/>"));
        }
    }

    /// An ellipse with a horizontal and a vertical radius.
    pub fn ellipse(&mut self, [x, y]: Point, [across, down]: [f32; 2], style: Style) {
        let [x, y, across, down] = [x, y, across, down].map(number);
        self.line(&if across == down {
            format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{across}\"{style}/>")
        } else {
            format!("<ellipse cx=\"{x}\" cy=\"{y}\" rx=\"{across}\" ry=\"{down}\"{style}/>")
        });
    }

    /// A rectangle with left, top, width and height, and with round corners.
    pub fn rect(&mut self, area: [f32; 4], radius: f32, style: Style) {
        self.line(&rect(area, radius, &style.to_string()));
    }

    /// A line of text.
    pub fn text(&mut self, text: &Text<'_>) {
        let Text { text, origin: [left, top], turn, at: [x, y], anchor, size, length, bold, color } = *text;
        let [left, top, degrees, x, y, size] = [left, top, turn, x, y, size].map(number);
        let turn = if turn == 0.0 { String::new() } else { format!(" rotate({degrees})") };
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let length = length.map_or_else(String::new, |length| {
            format!(" textLength=\"{}\" lengthAdjust=\"spacingAndGlyphs\"", number(length.max(0.01)))
        });
        let weight = if bold { " font-weight=\"bold\"" } else { "" };
        self.line(&format!(
            "<text transform=\"translate({left} {top}){turn}\" x=\"{x}\" y=\"{y}\" font-size=\"{size}\"{anchor}{length} \
             xml:space=\"preserve\"{weight}{}>{}</text>",
            color.attributes("fill"),
            escaped(text)
        ));
    }

    /// The text of the file: a white ground of this size, shown as large as `shown` in this unit, which is empty for pixels.
    pub fn finish(self, size: [f32; 2], shown: [f32; 2], unit: &str) -> String {
        let Self { body, clips } = self;
        let ([x, y], [width, height]) = (size.map(number), shown.map(number));
        let clip = |area| format!("<clipPath id=\"{}\">{}</clipPath>\n", clip_id(area), rect(area, 0.0, ""));
        let clips: String = clips.into_iter().map(clip).collect();
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}{unit}\" height=\"{height}{unit}\" viewBox=\"0 0 {x} {y}\" \
             font-family=\"'Noto Sans','Noto Sans Math','DejaVu Sans',Arial,sans-serif\" stroke-linejoin=\"round\">\n\
             <title>Kalmanscope</title>\n<defs>\n{clips}</defs>\n<rect width=\"{x}\" height=\"{y}\" fill=\"#fff\"/>\n{body}</svg>\n"
        )
    }

    fn line(&mut self, markup: &str) {
        self.body.push_str(markup);
        self.body.push('\n');
    }
}

/// A page may hold several figures, so that equal ids must be equal areas.
fn clip_id(area: [f32; 4]) -> String {
    format!("clip{}", area.map(|number| format!("_{}", self::number(number))).concat())
}

fn rect([left, top, width, height]: [f32; 4], radius: f32, style: &str) -> String {
    let round = if radius > 0.0 { format!(" rx=\"{}\"", number(radius)) } else { String::new() };
    let [left, top, width, height] = [left, top, width.max(0.0), height.max(0.0)].map(number);
    format!("<rect x=\"{left}\" y=\"{top}\" width=\"{width}\" height=\"{height}\"{round}{style}/>")
}

fn at([x, y]: Point) -> String {
    format!("{} {}", number(x), number(y))
}

fn number(value: f32) -> String {
    let mut text = format!("{value:.2}");
    let short = text.trim_end_matches('0').trim_end_matches('.').len();
    text.truncate(short);
    if text == "-0" { "0".to_owned() } else { text }
}

/// Text without markup, and without characters that HTML and XML do not allow.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\n' | '\t' => escaped.push(letter),
            '\u{fffe}' | '\u{ffff}' | '\0'..='\u{1f}' | '\u{7f}'..='\u{9f}' => {
                escaped.push(char::REPLACEMENT_CHARACTER)
            }
            other => escaped.push(other),
        }
    }
    escaped
}
