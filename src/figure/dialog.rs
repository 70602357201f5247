//! The dialog *Figure…*: the size, and a preview.

use egui::emath::TSTransform;
use egui::{Align2, Color32, Context, Rect, Sense, Shape, Ui, Vec2, Window, vec2};

use super::Figure;
use crate::probe::Remembered as _;
use crate::request::{Export, FigureFormat, Request};
use crate::theme::Palette;
use crate::widgets::primary;

/// The largest size of the preview, and the distance of the dialog from the window's edges \[points\].
const PREVIEW: Vec2 = vec2(620.0, 420.0);
const MARGINS: Vec2 = vec2(40.0, 150.0);

pub(crate) struct FigureDialog {
    format: FigureFormat,
    drawn: Option<(FigureFormat, Figure)>,
}

impl Default for FigureDialog {
    fn default() -> Self {
        Self { format: FigureFormat::Page, drawn: None }
    }
}

impl FigureDialog {
    pub(crate) fn ui(
        &mut self,
        ctx: &Context,
        draw: impl FnOnce(FigureFormat) -> Figure,
        requests: &mut Vec<Request>,
    ) -> bool {
        let (mut is_open, mut is_written) = (true, false);
        let room = PREVIEW.min(ctx.content_rect().size() - MARGINS).max(Vec2::splat(60.0));
        let window = Window::new("Figure").collapsible(false).resizable(false).open(&mut is_open);
        window.anchor(Align2::CENTER_CENTER, Vec2::ZERO).show(ctx, |ui| {
            ui.set_width(room.x);
            ui.horizontal_wrapped(|ui| {
                for format in FigureFormat::ALL {
                    ui.selectable_value(&mut self.format, format, format.name()).remembered(format.name());
                }
            });
            let format = self.format;
            // A figure takes several passes over every view: it is drawn once for each size and not in each frame.
            self.drawn.take_if(|(of, _)| *of != format);
            let (_, figure) = self.drawn.get_or_insert_with(|| (format, draw(format)));
            let [width, height] = figure.millimetres();
            let size = figure.size * (room / figure.size).min_elem();
            ui.vertical_centered(|ui| {
                let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
                figure.paint(ui, rect);
            });
            ui.horizontal(|ui| {
                let button = ui.add(primary("Save as SVG", &Palette::of(ui.ctx().theme()))).remembered("Save as SVG");
                is_written = button.clicked();
                ui.weak(format!("{width:.0} × {height:.0} mm, the views on screen as outlines and text"));
            });
        });
        if is_written {
            requests.push(Request::Export(Export::Figure(self.format)));
        }
        is_open && !is_written
    }
}

impl Figure {
    fn paint(&self, ui: &Ui, sheet: Rect) {
        let scale = sheet.width() / self.size.x;
        let painter = ui.painter();
        painter.rect_filled(sheet, 0.0, Color32::WHITE);
        for part in &self.parts {
            let to = TSTransform::new(sheet.min.to_vec2(), scale) * part.to;
            for clipped in &part.shapes {
                let mut shape = clipped.shape.clone();
                laid_out_here(&mut shape, ui);
                shape.transform(to);
                painter.with_clip_rect((to * clipped.clip_rect).intersect(sheet)).add(shape);
            }
        }
    }
}

/// Lays texts out with the letters of this screen: those of the figure are of another one.
fn laid_out_here(shape: &mut Shape, ui: &Ui) {
    match shape {
        Shape::Vec(shapes) => shapes.iter_mut().for_each(|shape| laid_out_here(shape, ui)),
        Shape::Text(text) => text.galley = ui.painter().layout_job((*text.galley.job).clone()),
        _ => {}
    }
}
