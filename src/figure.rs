//! Figures: the views on screen, drawn again for paper or a slide, as SVG.
//!
//! The views draw themselves in their own context, with a white ground, type of one size and thin lines. Their
//! shapes become SVG, which needs neither a screen nor a graphics card.

mod canvas;
mod dialog;
mod svg;

pub(crate) use canvas::extent;
use canvas::{Canvas, FigurePart, Geometry, Pen, TYPE};
use egui::epaint::ClippedShape;
use egui::{Color32, Label, Pos2, RichText, Sense, Ui, Vec2, pos2, vec2};

use crate::legend::{LegendMark, paint_mark};
use crate::plot::medium::Medium;
use crate::request::{FigureFormat, Proportions, ViewKind};
use crate::theme::Palette;
use crate::view::ViewContext;
use crate::views::view;

pub(crate) use dialog::FigureDialog;

pub struct Figure {
    parts: Vec<FigurePart>,
    size: Vec2,
    scale: f32,
}

impl Figure {
    pub fn new(context: &ViewContext<'_>, rows: &[Vec<ViewKind>], format: FigureFormat) -> Self {
        context.without_marks(&Palette::of(egui::Theme::Light), |context| arrange(context, rows, format))
    }

    /// Width and height \[mm\].
    pub fn millimetres(&self) -> [f32; 2] {
        [self.size.x, self.size.y].map(|length| length * self.scale * canvas::MILLIMETRES_PER_POINT)
    }

    pub fn svg(&self) -> String {
        svg::svg(self)
    }
}

const MARGIN: f32 = 4.0;
const GAP: Vec2 = vec2(16.0, 8.0);

/// The height of a plot with its heading, and that of a view's name \[points of the canvas\].
const PLOT: f32 = 100.0;
const NAME: f32 = 17.0;

/// Limits the width below which plots of one view are in one column \[points of the canvas\].
const TWO_COLUMNS: f32 = 480.0;

/// Text is drawn in more room than any needs, since only its shapes say how large it is \[points of the canvas\].
const AMPLE: f32 = 3000.0;

const LARGEST: f32 = 3.0;

fn arrange(context: &ViewContext<'_>, rows: &[Vec<ViewKind>], format: FigureFormat) -> Figure {
    let geometry = Geometry::of(format);
    let rows: Vec<&[ViewKind]> = if geometry.is_narrow {
        rows.iter().flatten().map(std::slice::from_ref).collect()
    } else {
        rows.iter().map(Vec::as_slice).collect()
    };
    let rows: Vec<&[ViewKind]> = rows.into_iter().filter(|row| !row.is_empty()).collect();
    let mut growth = 1.0;
    loop {
        let scale = geometry.type_size / TYPE / growth;
        let canvas = &Canvas::new(Pen::new(geometry.curves.map(|width| width / scale)));
        let width = geometry.width / scale;
        let page = FigurePage { canvas, context, width: width - 2.0 * MARGIN, is_alone: rows.concat().len() == 1 };
        let legend = page.legend();
        let top = MARGIN + extent(&legend).y.ceil() + GAP.y;
        let natural: Vec<f32> = rows.iter().map(|row| page.row_height(row)).collect();
        let gaps = GAP.y * rows.len().saturating_sub(1) as f32;
        let needed = top + natural.iter().sum::<f32>() + gaps + MARGIN;
        let height = geometry.aspect.map_or(needed, |aspect| aspect * width);
        if needed > height * 1.001 && growth < LARGEST {
            // By 5 % at least, so that the loop ends.
            growth *= (needed / height).sqrt().max(1.05);
            continue;
        }
        // Plots take the room that is left; pictures and text would gain nothing.
        let grows = |row: &[ViewKind]| row.iter().any(|kind| can_grow(*kind));
        let growing: f32 = rows.iter().zip(&natural).filter(|(row, _)| grows(row)).map(|(_, height)| height).sum();
        let stretch = if growing > 0.0 { 1.0 + (height - needed).max(0.0) / growing } else { 1.0 };
        let mut parts = vec![FigurePart::at(pos2(MARGIN, MARGIN), 1.0, legend)];
        let mut y = top;
        for (row, natural) in rows.iter().zip(&natural) {
            let height = natural * if grows(row) { stretch } else { 1.0 };
            page.row(row, y, height, &mut parts);
            y += height + GAP.y;
        }
        return Figure { parts, size: vec2(width, height), scale };
    }
}

struct FigurePage<'a> {
    canvas: &'a Canvas,
    context: &'a ViewContext<'a>,
    width: f32,
    is_alone: bool,
}

impl FigurePage<'_> {
    fn legend(&self) -> Vec<ClippedShape> {
        self.canvas.draw(vec2(self.width, AMPLE), |ui| legend_ui(ui, self.context))
    }

    fn share(&self, row: &[ViewKind]) -> f32 {
        (self.width - GAP.x * (row.len() - 1) as f32) / row.len() as f32
    }

    fn row_height(&self, row: &[ViewKind]) -> f32 {
        let name = if self.is_alone { 0.0 } else { NAME };
        let width = self.share(row);
        name + row.iter().map(|kind| self.height(*kind, width)).fold(0.0, f32::max)
    }

    fn height(&self, kind: ViewKind, width: f32) -> f32 {
        if let Some(natural) = self.text_size(kind, width) {
            return natural.y * (width / natural.x).min(1.0);
        }
        match kind.proportions() {
            Proportions::Flat => (0.26 * width).clamp(70.0, 120.0),
            Proportions::Square => (0.72 * width).clamp(150.0, 270.0),
            Proportions::Tall => {
                let rows = if width < TWO_COLUMNS { self.plots(kind, width) } else { 1 };
                rows as f32 * (0.62 * width).clamp(190.0, 290.0)
            }
            Proportions::Wide => {
                let plots = self.plots(kind, width);
                let columns = if width < TWO_COLUMNS { 1 } else { 2.min(plots.max(1)) };
                plots.div_ceil(columns).max(1) as f32 * PLOT + Medium::Figure.axis_height()
            }
        }
    }

    fn plots(&self, kind: ViewKind, width: f32) -> usize {
        Medium::take_plots(&self.canvas.ctx);
        self.canvas.draw(vec2(width, AMPLE), |ui| self.view_ui(ui, kind));
        Medium::take_plots(&self.canvas.ctx).unwrap_or(1)
    }

    fn text_size(&self, kind: ViewKind, width: f32) -> Option<Vec2> {
        if !kind.is_text() {
            return None;
        }
        // A diagram is laid out for the width that there is; a table takes its own.
        let room = if kind == ViewKind::Matrices { width } else { AMPLE };
        let shapes = self.canvas.draw(vec2(room, AMPLE), |ui| self.view_ui(ui, kind));
        Some((extent(&shapes) + vec2(6.0, 6.0)).max(vec2(width, 20.0)))
    }

    fn view_ui(&self, ui: &mut Ui, kind: ViewKind) {
        view(kind).ui(ui, self.context, &mut Vec::new());
    }

    fn row(&self, row: &[ViewKind], top: f32, height: f32, parts: &mut Vec<FigurePart>) {
        let width = self.share(row);
        let mut left = MARGIN;
        for &kind in row {
            let mut corner = pos2(left, top);
            left += width + GAP.x;
            let mut room = height;
            if !self.is_alone {
                parts.push(FigurePart::at(corner, 1.0, self.name(kind, width)));
                corner.y += NAME;
                room -= NAME;
            }
            parts.push(self.part(kind, corner, vec2(width, room)));
        }
    }

    fn name(&self, kind: ViewKind, width: f32) -> Vec<ClippedShape> {
        let name = RichText::new(view(kind).name).weak();
        self.canvas.draw(vec2(width, NAME), |ui| {
            ui.label(name.clone());
        })
    }

    fn part(&self, kind: ViewKind, corner: Pos2, room: Vec2) -> FigurePart {
        let natural = self.text_size(kind, room.x);
        let scaling = natural.map_or(1.0, |natural| (room / natural).min_elem().min(1.0));
        let mut size = room / scaling;
        if kind.proportions() == Proportions::Flat {
            // Beside a higher view there would be room for trails, which are for a moving picture.
            size.y = size.y.min(0.3 * size.x);
        }
        FigurePart::at(corner, scaling, self.canvas.draw(size, |ui| self.view_ui(ui, kind)))
    }
}

fn can_grow(kind: ViewKind) -> bool {
    !kind.is_text() && kind.proportions() != Proportions::Flat
}

const SAMPLE: egui::Vec2 = vec2(18.0, 9.0);

pub(crate) fn legend_ui(ui: &mut Ui, context: &ViewContext<'_>) {
    let ViewContext { session, palette, visible, .. } = *context;
    let record = session.run().record();
    let knows_truth = !record.true_channels().is_empty();
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(12.0, 2.0);
        if visible.truth && knows_truth {
            entry_ui(ui, "truth", LegendMark::Line, palette.truth);
        }
        if visible.measured && !record.sensors().is_empty() {
            entry_ui(ui, "measured", LegendMark::Dots, palette.weak);
        }
        for (_, estimates) in context.filters() {
            let mark = if visible.bands { LegendMark::Band } else { LegendMark::Line };
            let end = if visible.bands { " ±2σ" } else { "" };
            entry_ui(ui, &format!("{}{end}", estimates.name()), mark, context.color(estimates));
        }
        if visible.hindsight && !session.smoothed().is_empty() {
            entry_ui(ui, "hindsight", LegendMark::Dashes, palette.weak);
        }
        if let Some(words) = session.before().map(|before| before.words.as_str()) {
            entry_ui(ui, &format!("before: {words}"), LegendMark::Line, palette.weak);
        }
    });
}

fn entry_ui(ui: &mut Ui, name: &str, mark: LegendMark, color: Color32) {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let text = ui.painter().layout_no_wrap(name.to_owned(), font, ui.visuals().text_color());
    let size = text.size() + vec2(SAMPLE.x + 5.0, 0.0);
    // Sample and text stay together where a line ends.
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let sample = egui::Rect::from_center_size(rect.left_center() + vec2(0.5 * SAMPLE.x, 0.0), SAMPLE);
    paint_mark(ui.painter(), sample, mark, color);
    let label = egui::Rect::from_min_max(egui::pos2(sample.right() + 5.0, rect.top()), rect.max);
    ui.put(label, Label::new(text).selectable(false));
}
