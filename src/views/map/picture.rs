//! The picture of a map: cells and lines of each filter and of their comparison, made again when rows have come.

use std::sync::Arc;

use egui::{
    Color32, ColorImage, Context, Id, Mesh, Rect, Shape, TextureHandle, TextureOptions, Ui, UiBuilder, Vec2, pos2, vec2,
};
use kalmanscope_diagnosis::Measure;

use super::marks::{Piece, consistent};
use super::scale::{Cell, CellEnd, Colors, Graph, bar_room, compared, of_filter};
use crate::laboratory::{Laboratory, Survey};
use crate::plot::cache::cached;
use crate::plot::medium::Medium;
use crate::theme::Palette;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Contents {
    Filter(usize),
    Comparison,
}

pub(super) struct MapPanel {
    pub(super) contents: Contents,
    pub(super) colors: Colors,
    pub(super) cells: Vec<Cell>,
    pub(super) contour: Vec<Piece>,
    pub(super) counts: [usize; 2],
    /// One texel a cell. `None` for a figure.
    texture: Option<TextureHandle>,
    shades: Vec<Option<Color32>>,
}

pub(super) fn panels(
    ctx: &Context,
    laboratory: &Laboratory,
    survey: &Survey,
    measure: Measure,
    palette: &Palette,
) -> Arc<Vec<MapPanel>> {
    let of = (laboratory.edition, laboratory.state.version, ctx.theme(), measure.name());
    cached(ctx, Id::unique("panels of the map"), of, || Some(made(ctx, survey, measure, palette)))
}

fn made(ctx: &Context, survey: &Survey, measure: Measure, palette: &Palette) -> Vec<MapPanel> {
    let filters: Vec<Vec<Cell>> = (0..survey.filters.len()).map(|at| of_filter(survey, at, measure)).collect();
    let colors = Colors::of(measure, &filters.iter().map(Vec::as_slice).collect::<Vec<_>>());
    let comparison = match &filters[..] {
        [a, b] if !measure.info().kind.is_of_kinds() => Some(compared(a, b, measure)),
        _ => None,
    };
    let comparison = comparison.map(|cells| (Contents::Comparison, Colors::of_comparison(measure, &cells), cells));
    let filters = filters.into_iter().enumerate().map(|(at, cells)| (Contents::Filter(at), colors.clone(), cells));
    let counts = survey.axes().map(|axis| axis.count);
    let panel = |(contents, colors, cells): (Contents, Colors, Vec<Cell>)| {
        let contour = match contents {
            Contents::Filter(at) => consistent(survey, at),
            Contents::Comparison => Vec::new(),
        };
        let shades: Vec<_> = cells.iter().map(|cell| colors.of_cell(*cell, palette)).collect();
        let texture = (Medium::of(ctx) == Medium::Screen).then(|| texture(ctx, contents, &shades, counts));
        MapPanel { contents, colors, cells, contour, counts, texture, shades }
    };
    filters.chain(comparison).map(panel).collect()
}

fn texture(ctx: &Context, contents: Contents, shades: &[Option<Color32>], [across, up]: [usize; 2]) -> TextureHandle {
    let texel = |place: usize| {
        let (row, column) = (up - 1 - place / across, place % across);
        shades[column * up + row].unwrap_or(Color32::TRANSPARENT)
    };
    let image = ColorImage::new([across, up], (0..across * up).map(texel).collect());
    ctx.load_texture(format!("map, {contents:?}"), image, TextureOptions::NEAREST)
}

impl MapPanel {
    pub(super) fn shapes(&self, graph: &Graph, opacity: f32) -> Vec<Shape> {
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        match &self.texture {
            Some(texture) => {
                vec![Shape::image(texture.id(), graph.rect, whole, Color32::WHITE.gamma_multiply(opacity))]
            }
            None => self.areas(graph),
        }
    }

    /// A figure carries no texture. Equal neighbours are one rectangle, which overlaps the next: no seams show.
    fn areas(&self, graph: &Graph) -> Vec<Shape> {
        const OVERLAP: f32 = 0.25;
        let [across, up] = self.counts;
        let mut meshes: Vec<(Color32, Mesh)> = Vec::new();
        let corner = |x: usize, y: usize| graph.at_shares([x as f64 / across as f64, y as f64 / up as f64]);
        for x in 0..across {
            let column = &self.shades[x * up..(x + 1) * up];
            let mut from = 0;
            for run in column.chunk_by(PartialEq::eq) {
                let to = from + run.len();
                if let Some(color) = run[0] {
                    let (low, high) = (corner(x, from), corner(x + 1, to));
                    let max = pos2(high.x + OVERLAP, low.y + OVERLAP).min(graph.rect.max);
                    let rect = Rect::from_min_max(pos2(low.x, high.y), max);
                    let place = meshes.iter().position(|(other, _)| *other == color).unwrap_or_else(|| {
                        meshes.push((color, Mesh::default()));
                        meshes.len() - 1
                    });
                    meshes[place].1.add_colored_rect(rect, color);
                }
                from = to;
            }
        }
        meshes.into_iter().map(|(_, mesh)| Shape::mesh(mesh)).collect()
    }

    pub(super) fn has(&self, end: CellEnd) -> bool {
        self.cells.iter().any(|cell| cell.end == end)
    }
}

/// The least width of panels side by side \[points\].
const LEAST: f32 = 160.0;

/// The least height of panels one below the other \[points\].
const LOW: f32 = 180.0;

const GAP: f32 = 6.0;

pub(super) struct PanelPlace {
    pub(super) at: usize,
    pub(super) room: Rect,
    pub(super) has_bar: bool,
}

pub(super) fn arrange(ui: &mut Ui, area: Rect, panels: &[MapPanel], survey: &Survey) -> Vec<PanelPlace> {
    let count = panels.len().max(1) as f32;
    let gaps = GAP * (count - 1.0);
    let is_last = |at: usize| panels.get(at + 1).is_none_or(|next| next.colors != panels[at].colors);
    let bars: Vec<f32> =
        (0..panels.len()).map(|at| if is_last(at) { bar_room(&panels[at].colors) } else { 0.0 }).collect();
    let plot = (area.width() - gaps - bars.iter().sum::<f32>()) / count;
    let mut corner = area.min;
    if plot >= LEAST || panels.len() < 2 {
        let place = |(at, bar): (usize, &f32)| {
            let room = Rect::from_min_size(corner, vec2(plot + bar, area.height()));
            corner.x += room.width() + GAP;
            PanelPlace { at, room, has_bar: *bar > 0.0 }
        };
        return bars.iter().enumerate().map(place).collect();
    }
    let height = (area.height() - gaps) / count;
    if height >= LOW || Medium::of(ui.ctx()) != Medium::Screen {
        let place = |at: usize| {
            let room = Rect::from_min_size(corner, vec2(area.width(), height));
            corner.y += height + GAP;
            PanelPlace { at, room, has_bar: true }
        };
        return (0..panels.len()).map(place).collect();
    }
    one_ui(ui, area, panels, survey)
}

fn one_ui(ui: &mut Ui, area: Rect, panels: &[MapPanel], survey: &Survey) -> Vec<PanelPlace> {
    let id = Id::unique("panel of the map");
    let mut chosen: usize = ui.data(|data| data.get_temp(id)).unwrap_or(0).min(panels.len() - 1);
    let filters = &survey.ensemble.scenario().filters;
    let mut child = ui.new_child(UiBuilder::new().id_salt("panels of the map").max_rect(area));
    let row = child.horizontal(|ui| {
        for (at, panel) in panels.iter().enumerate() {
            let text = match panel.contents {
                Contents::Filter(place) => filters[place].name.as_str(),
                Contents::Comparison => "compared",
            };
            ui.selectable_value(&mut chosen, at, text);
        }
    });
    ui.data_mut(|data| data.insert_temp(id, chosen));
    let top = row.response.rect.bottom() + GAP;
    let size = Vec2::new(area.width(), (area.bottom() - top).max(1.0));
    vec![PanelPlace { at: chosen, room: Rect::from_min_size(egui::pos2(area.left(), top), size), has_bar: true }]
}
