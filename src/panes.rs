//! The views on screen: tiles that can be dragged, resized, closed and enlarged.

use egui::{
    Button, Color32, Label, Rect, Response, RichText, ScrollArea, Sense, Stroke, Ui, UiBuilder, Vec2, WidgetText, vec2,
};
use egui_tiles::{Behavior, ResizeState, SimplificationOptions, TileId, UiResponse};

use crate::layout::{ViewLayout, simplification};
use crate::request::{Arrangement, Proportions, Request, ViewKind};
use crate::theme;
use crate::view::{View, ViewContext};
use crate::views::view;
use crate::widgets::named;

/// Limits the height below which views are in one column \[points\].
const LOW: f32 = 340.0;

/// The least heights of a view in tiles, below its bar: of plots, of a picture of the plant with the bar, and of a map; and of
/// each plot of a view with several \[points\].
const LEAST: f32 = 140.0;
const LEAST_FLAT: f32 = 90.0;
const LEAST_TALL: f32 = 216.0;
const LEAST_PLOT: f32 = 70.0;

const GAP: f32 = 14.0;

/// The room around a view into which its plots may draw \[points\].
const MARGIN: f32 = 4.0;

/// The height of the titles of plots, below which the bar of a view is \[points\].
const BELOW_TITLES: f32 = 24.0;

/// Limits the width below which the names of tabs are short \[points\].
const TABS: f32 = 450.0;

/// The side of a button above a view, at least \[points\].
const TARGET: f32 = 24.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PaneArrangement {
    /// As the layout has them, if there is room.
    Tiles,
    Column,
    /// In one column of views without bars, each with all the room, pictures of the plant last: while a setting is
    /// changed on a phone, and where it lies on its side, the curves are on screen.
    Plots,
}

pub(crate) fn panes_ui(
    ui: &mut Ui,
    layout: &ViewLayout,
    context: &ViewContext<'_>,
    requests: &mut Vec<Request>,
    way: PaneArrangement,
    above: impl FnOnce(&mut Ui, &mut Vec<Request>),
) {
    let area = ui.available_size();
    if area.x < 1.0 || area.y < 1.0 {
        return;
    }
    let narrow = way != PaneArrangement::Tiles;
    let mut panes = Panes { context, requests, pointed: None, draggable: !narrow, clip: ui.clip_rect() };
    if let Some(kind) = layout.enlarged() {
        panes.draggable = false;
        panes.view_ui(ui, kind);
    } else if way == PaneArrangement::Plots {
        panes.plots_ui(ui, &layout.in_order());
    } else if narrow || area.y < LOW {
        panes.draggable = false;
        let mut kinds = layout.in_order();
        if !narrow {
            // On a phone in landscape the picture of the plant would leave the plots no room.
            kinds.sort_by_key(|kind| kind.proportions() == Proportions::Flat);
        }
        panes.column_ui(ui, &kinds, above);
    } else if layout.tree().is_empty() {
        empty_ui(ui, panes.requests);
    } else {
        // Tiles are dragged in a copy; if its tree changes, the copy is requested as the new layout.
        let bar = bar_height(ui);
        let (mut tree, height) = layout.fitted(area.y, GAP, &|kind| least_height(kind, bar, context));
        let fitted = tree.clone();
        if height > area.y {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                panes.clip = ui.clip_rect();
                let width = ui.available_width() - ui.spacing().scroll.bar_width;
                ui.allocate_ui(vec2(width, height), |ui| {
                    ui.set_min_size(vec2(width, height));
                    tree.ui(&mut panes, ui);
                });
            });
        } else {
            tree.ui(&mut panes, ui);
        }
        if tree != fitted {
            panes.requests.push(Request::Rearrange(Box::new(tree)));
        }
    }
    let Panes { pointed, requests, .. } = panes;
    if pointed != context.axis.pointed {
        requests.push(Request::PointAt(pointed));
    }
}

fn least_height(kind: ViewKind, bar: f32, context: &ViewContext<'_>) -> f32 {
    match kind.proportions() {
        Proportions::Flat => LEAST_FLAT,
        Proportions::Tall => bar + LEAST_TALL,
        Proportions::Wide | Proportions::Square => bar + LEAST.max(LEAST_PLOT * (view(kind).plots)(context) as f32),
    }
}

fn empty_ui(ui: &mut Ui, requests: &mut Vec<Request>) {
    ui.vertical_centered(|ui| {
        ui.add_space(0.3 * ui.available_height());
        ui.weak("No view is shown.");
        for arrangement in Arrangement::ALL {
            if ui.add(Button::new(arrangement.name()).min_size(vec2(160.0, 40.0))).clicked() {
                requests.push(Request::Arrange(arrangement));
            }
        }
    });
}

fn bar_height(ui: &Ui) -> f32 {
    ui.spacing().interact_size.y.max(TARGET)
}

pub(crate) fn help_ui(ui: &mut Ui, name: &str, help: [&str; 3]) {
    let lines = |ui: &mut Ui| {
        ui.set_max_width(380.0);
        for line in help {
            ui.label(line);
        }
    };
    let side = bar_height(ui);
    let help = ui.add(Button::new(RichText::new("?").weak()).frame(false).min_size(vec2(side, side)));
    // On a touch screen nothing hovers.
    let is_open = egui::Popup::from_toggle_button_response(&help).show(lines).is_some();
    let help = if is_open { help } else { help.on_hover_ui(lines) };
    named(help, format!("About {name}"));
}

struct Panes<'a> {
    context: &'a ViewContext<'a>,
    requests: &'a mut Vec<Request>,
    pointed: Option<f64>,
    draggable: bool,
    clip: Rect,
}

impl Panes<'_> {
    fn column_ui(&mut self, ui: &mut Ui, kinds: &[ViewKind], above: impl FnOnce(&mut Ui, &mut Vec<Request>)) {
        let gap = ui.spacing().item_spacing.y;
        let column = Heights::new(kinds, ui.available_size(), bar_height(ui) + gap, gap);
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            above(ui, self.requests);
            let width = ui.available_width() - if column.scrolls { ui.spacing().scroll.bar_width } else { 0.0 };
            for (&kind, height) in kinds.iter().zip(column.heights) {
                let (rect, _) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
                let mut child = ui.new_child(UiBuilder::new().id_salt(view(kind).name).max_rect(rect));
                self.view_ui(&mut child, kind);
            }
        });
    }

    fn plots_ui(&mut self, ui: &mut Ui, kinds: &[ViewKind]) {
        let is_picture = |kind: &&ViewKind| kind.proportions() == Proportions::Flat;
        let (pictures, plots): (Vec<&ViewKind>, Vec<&ViewKind>) = kinds.iter().partition(is_picture);
        let size = ui.available_size();
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for &&kind in plots.iter().chain(&pictures) {
                let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
                let mut child = ui.new_child(UiBuilder::new().id_salt(view(kind).name).max_rect(rect));
                self.pointed = view(kind).ui(&mut child, self.context, self.requests).or(self.pointed);
            }
        });
    }

    fn view_ui(&mut self, ui: &mut Ui, kind: ViewKind) -> bool {
        let view = view(kind);
        ui.shrink_clip_rect(self.clip);
        // The titles of its plots are enough where a pointer can ask for more.
        let is_bare = self.draggable && kind.tabs().len() < 2 && !theme::is_for_fingers(ui.ctx());
        let whole = ui.max_rect();
        let dragged = !is_bare && ui.horizontal(|ui| self.bar_ui(ui, kind)).inner;
        // A table stays inside its view.
        ui.shrink_clip_rect(whole.expand(MARGIN));
        self.pointed = view.ui(ui, self.context, self.requests).or(self.pointed);
        if is_bare { self.corner_ui(ui, whole, kind) } else { dragged }
    }

    fn corner_ui(&mut self, ui: &mut Ui, whole: Rect, kind: ViewKind) -> bool {
        let corner = Rect::from_min_size(whole.min + vec2(0.0, BELOW_TITLES), vec2(whole.width(), bar_height(ui)));
        let focused = ui.memory(egui::Memory::focused).and_then(|id| ui.ctx().read_response(id));
        let has_focus = focused.is_some_and(|control| corner.contains_rect(control.rect));
        let is_shown = ui.rect_contains_pointer(whole) || has_focus;
        let layout = egui::Layout::right_to_left(egui::Align::Center);
        let mut ui = ui.new_child(UiBuilder::new().id_salt("corner").max_rect(corner).layout(layout));
        // Invisible and not left out: the keyboard must reach the buttons.
        ui.set_opacity(if is_shown { 1.0 } else { 0.0 });
        let ground = ui.painter().add(egui::Shape::Noop);
        let dragged = self.bar_ui(&mut ui, kind);
        let ground_color = self.context.palette.ground.gamma_multiply(0.85);
        ui.painter().set(ground, egui::Shape::rect_filled(ui.min_rect(), 0.0, ground_color));
        dragged
    }

    fn bar_ui(&mut self, ui: &mut Ui, kind: ViewKind) -> bool {
        let view = view(kind);
        ui.spacing_mut().item_spacing.x = 4.0;
        let (title, enlarged) = if ui.layout().prefer_right_to_left() {
            let enlarged = self.buttons_ui(ui, kind);
            help_ui(ui, view.name, view.help);
            (self.title_ui(ui, kind), enlarged)
        } else {
            let title = self.title_ui(ui, kind);
            help_ui(ui, view.name, view.help);
            let at_right = egui::Layout::right_to_left(egui::Align::Center);
            (title, ui.with_layout(at_right, |ui| self.buttons_ui(ui, kind)).inner)
        };
        let title = if self.draggable { title.on_hover_text("Drag to move") } else { title };
        if enlarged || title.double_clicked() {
            self.requests.push(Request::ToggleEnlarged(kind));
        }
        title.drag_started()
    }

    fn buttons_ui(&mut self, ui: &mut Ui, kind: ViewKind) -> bool {
        let name = view(kind).name;
        let side = bar_height(ui);
        let small = |icon: &str| Button::new(RichText::new(icon).weak()).frame(false).min_size(vec2(side, side));
        let close = ui.add(small("×")).on_hover_text("Hide this view");
        if named(close, format!("Hide {name}")).clicked() {
            self.requests.push(Request::ToggleView(kind));
        }
        let enlarge = ui.add(small("⛶")).on_hover_text("Enlarge, or back");
        named(enlarge, format!("Enlarge {name}")).clicked()
    }

    fn title_ui(&mut self, ui: &mut Ui, kind: ViewKind) -> Response {
        let sense = if self.draggable { Sense::click_and_drag() } else { Sense::click() };
        let tabs = kind.tabs();
        if tabs.len() < 2 {
            return ui.add(Label::new(RichText::new(view(kind).name).small().weak()).selectable(false).sense(sense));
        }
        let is_narrow = ui.available_width() < TABS;
        let name = |view: &View| RichText::new(view.short.filter(|_| is_narrow).unwrap_or(view.name)).small();
        ui.horizontal(|ui| {
            let tab_ui = |tab: &ViewKind| {
                let button = ui.add(Button::selectable(*tab == kind, name(view(*tab))).sense(sense));
                if button.clicked() && *tab != kind {
                    self.requests.push(Request::ChooseTab(kind, *tab));
                }
                button
            };
            tabs.iter().map(tab_ui).reduce(|a, b| a.union(b))
        })
        .inner
        .unwrap_or_else(|| ui.label(""))
    }
}

impl Behavior<ViewKind> for Panes<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _: TileId, kind: &mut ViewKind) -> UiResponse {
        if self.view_ui(ui, *kind) { UiResponse::DragStarted } else { UiResponse::None }
    }

    fn tab_title_for_pane(&mut self, kind: &ViewKind) -> WidgetText {
        view(*kind).name.into()
    }

    fn simplification_options(&self) -> SimplificationOptions {
        simplification()
    }

    fn gap_width(&self, _: &egui::Style) -> f32 {
        GAP
    }

    fn min_size(&self) -> f32 {
        LEAST
    }

    fn tab_bar_color(&self, _: &egui::Visuals) -> Color32 {
        self.context.palette.ground
    }

    fn resize_stroke(&self, style: &egui::Style, state: ResizeState) -> Stroke {
        match state {
            ResizeState::Idle => Stroke::NONE,
            ResizeState::Hovering => style.visuals.widgets.hovered.fg_stroke,
            ResizeState::Dragging => style.visuals.widgets.active.fg_stroke,
        }
    }
}

/// Limits the height per view above which all views fit on screen; below it they scroll \[points\].
const ENOUGH: f32 = 250.0;

const LEAST_IN_COLUMN: f32 = 300.0;

const TALL: f32 = 1.7;

const LEAST_TALL_IN_COLUMN: f32 = 240.0;

/// The height of a flat view without its bar, as a share of the column's width.
const FLAT: f32 = 0.3;

/// Limits the height of a flat view without its bar, as a share of the column's height for each of the other views; and
/// the least heights if all views fit and if they scroll \[points\].
const FLAT_SHARE: f32 = 0.2;
const LEAST_FLAT_IN_COLUMN: f32 = 64.0;
const LEAST_FLAT_SCROLLING: f32 = 84.0;

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Heights {
    pub(crate) heights: Vec<f32>,
    pub(crate) scrolls: bool,
}

impl Heights {
    /// A flat view has the height of its picture, above its bar and a gap; the others share the rest.
    pub(crate) fn new(kinds: &[ViewKind], room: Vec2, bar: f32, gap: f32) -> Self {
        let proportions: Vec<Proportions> = kinds.iter().map(|kind| kind.proportions()).collect();
        let others = proportions.iter().filter(|proportions| **proportions != Proportions::Flat).count();
        let share = |proportions: &Proportions| match proportions {
            Proportions::Flat if others > 0 => 0.0,
            Proportions::Tall => TALL,
            Proportions::Flat | Proportions::Wide | Proportions::Square => 1.0,
        };
        let all: f32 = proportions.iter().map(share).sum();
        let sharing = if others > 0 { others } else { kinds.len() };
        let picture = (FLAT * room.x).min(FLAT_SHARE * room.y / others.max(1) as f32);
        let flat = bar + picture.max(LEAST_FLAT_IN_COLUMN);
        let rest = room.y - flat * (kinds.len() - sharing) as f32 - gap * kinds.len() as f32;
        let scrolls = rest <= ENOUGH * all.max(sharing as f32);
        let least = if scrolls { LEAST_IN_COLUMN.min(room.y) } else { 1.0 };
        // A tall view can be seen as a whole.
        let most = room.y.max(LEAST_TALL_IN_COLUMN);
        let flat = if scrolls { bar + picture.max(LEAST_FLAT_SCROLLING) } else { flat };
        let height = |proportions: &Proportions| match share(proportions) {
            0.0 => flat,
            share => (rest * share / all.max(1.0)).max((least * share).min(most)),
        };
        Self { heights: proportions.iter().map(height).collect(), scrolls }
    }
}

#[cfg(test)]
mod tests {
    use egui::vec2;

    use super::*;

    #[test]
    fn a_tall_view_is_not_cut_off() {
        for room in [vec2(370.0, 320.0), vec2(824.0, 230.0)] {
            let Heights { heights, .. } = Heights::new(&[ViewKind::Map, ViewKind::Parameters], room, 44.0, 5.0);
            assert!(heights[0] == room.y.max(LEAST_TALL_IN_COLUMN), "{room}: {heights:?}");
        }
    }

    #[test]
    fn a_view_alone_has_all_the_room() {
        for kind in ViewKind::ALL {
            let Heights { heights, scrolls } = Heights::new(&[kind], vec2(370.0, 660.0), 44.0, 5.0);
            assert!(!scrolls && heights[0] > 640.0, "{kind:?}: {heights:?}");
        }
    }
}
