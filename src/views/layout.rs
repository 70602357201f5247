//! Which views are shown, and where: tiles that can be dragged, resized, closed and enlarged.

use egui::{Button, Color32, Id, RichText, ScrollArea, Sense, Stroke, Ui, WidgetText, vec2};
use egui_tiles::{Behavior, LinearDir, ResizeState, SimplificationOptions, Tile, TileId, Tiles, Tree, UiResponse};

use serde::{Deserialize, Serialize};

use super::{ViewContext, ViewKind};
use crate::command::Command;
use crate::session::Wanted;

/// A ready-made choice of views.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arrangement {
    /// The story: the moving mass, parameters and states.
    #[default]
    Teach,
    /// What one tunes Q and R by: parameters, innovations, NIS and NEES, errors.
    Tune,
    /// Filters against each other: scores, parameters, errors, the parameter plane.
    Compare,
}

impl Arrangement {
    /// Every arrangement.
    pub const ALL: [Self; 3] = [Self::Teach, Self::Tune, Self::Compare];

    /// Its name in the menu.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Teach => "Teach",
            Self::Tune => "Tune",
            Self::Compare => "Compare",
        }
    }

    /// Rows of views, each with its share of the height.
    const fn rows(self) -> &'static [(f32, &'static [ViewKind])] {
        use ViewKind::{Consistency, Errors, Innovations, Oscillator, ParameterPlane, Parameters, Scores, States};
        match self {
            Self::Teach => &[(0.19, &[Oscillator]), (0.44, &[Parameters]), (0.37, &[States])],
            Self::Tune => &[(0.5, &[Parameters, Consistency]), (0.5, &[Innovations, Errors])],
            Self::Compare => &[(0.5, &[Parameters, Scores]), (0.5, &[Errors, ParameterPlane])],
        }
    }
}

/// The height for each of several views, one below the other, from which on all are seen at once; else they scroll
/// \[points\].
const ENOUGH: f32 = 180.0;

/// Rows of views, each with its share of the height.
fn tree(rows: &[(f32, &[ViewKind])]) -> Tree<ViewKind> {
    let mut tiles = Tiles::default();
    let mut column = egui_tiles::Linear::new(LinearDir::Vertical, Vec::new());
    for (share, views) in rows {
        let panes: Vec<TileId> = views.iter().map(|view| tiles.insert_pane(*view)).collect();
        let row = if let [pane] = panes[..] { pane } else { tiles.insert_horizontal_tile(panes) };
        column.add_child(row);
        column.shares.set_share(row, *share);
    }
    let root = tiles.insert_container(column);
    Tree::new(Id::unique("views"), root, tiles)
}

/// The views on screen.
#[derive(Serialize, Deserialize)]
pub struct Layout {
    tree: Tree<ViewKind>,
    #[serde(skip)]
    enlarged: Option<ViewKind>,
}

impl Default for Layout {
    fn default() -> Self {
        Self::of(Arrangement::default())
    }
}

impl Layout {
    /// A ready-made arrangement.
    pub fn of(arrangement: Arrangement) -> Self {
        Self { tree: tree(arrangement.rows()), enlarged: None }
    }

    /// Some views one below the other, the first with the most room; a plane is beside the view before it.
    pub fn column(views: &[ViewKind]) -> Self {
        let share = |i: usize, row: &[ViewKind]| match row {
            [ViewKind::Oscillator] => 0.5,
            _ if i == 0 => 1.3,
            _ => 1.0,
        };
        let rows = views.chunk_by(|before, view| view.is_plane() && !before.is_plane()).enumerate();
        let rows: Vec<(f32, &[ViewKind])> = rows.map(|(i, row)| (share(i, row), row)).collect();
        Self { tree: tree(&rows), enlarged: None }
    }

    /// The views that are shown.
    pub fn shown(&self) -> Vec<ViewKind> {
        let shown: Vec<ViewKind> = self.tree.tiles.tiles().filter_map(pane).collect();
        ViewKind::ALL.into_iter().filter(|view| shown.contains(view)).collect()
    }

    /// What the views that are shown need.
    pub fn wanted(&self) -> Wanted {
        let shown = self.shown();
        Wanted {
            bounds: shown.contains(&ViewKind::Errors),
            diagnostics: shown.iter().filter_map(|view| view.depth()).max(),
        }
    }

    /// The views that are shown, from top to bottom and left to right.
    fn in_order(&self) -> Vec<ViewKind> {
        let mut to_come: Vec<TileId> = self.tree.root().into_iter().collect();
        let mut views = Vec::new();
        while let Some(id) = to_come.pop() {
            match self.tree.tiles.get(id) {
                Some(Tile::Pane(view)) => views.push(*view),
                Some(Tile::Container(container)) => to_come.extend(container.children_vec().into_iter().rev()),
                None => {}
            }
        }
        views
    }

    /// Leaves the enlarged view. Returns whether there was one.
    pub fn leave_enlarged(&mut self) -> bool {
        self.enlarged.take().is_some()
    }

    /// Shows a view or hides it.
    pub fn toggle(&mut self, view: ViewKind) {
        let Self { tree, enlarged } = self;
        *enlarged = None;
        if let Some(tile) = tree.tiles.find_pane(&view) {
            tree.remove_recursively(tile);
            return;
        }
        let tile = tree.tiles.insert_pane(view);
        match tree.root() {
            Some(root) if tree.tiles.get_container(root).is_some() => {
                tree.move_tile_to_container(tile, root, usize::MAX, true);
            }
            // A single view is alone, without a container.
            Some(root) => {
                let both = tree.tiles.insert_vertical_tile(vec![root, tile]);
                *tree = Tree::new(Id::unique("views"), both, std::mem::take(&mut tree.tiles));
            }
            None => *tree = Tree::new(Id::unique("views"), tile, std::mem::take(&mut tree.tiles)),
        }
    }

    /// Fills the rest of `ui` with the views: as tiles, or one below the other where it is narrow.
    pub fn ui(&mut self, ui: &mut Ui, context: &ViewContext<'_>, commands: &mut Vec<Command>, narrow: bool) {
        let area = ui.available_size();
        if area.x < 1.0 || area.y < 1.0 {
            return;
        }
        let mut panes = Panes { context, commands, pointed: None, closed: None, enlarge: None, draggable: !narrow };
        if let Some(view) = self.enlarged {
            panes.draggable = false;
            panes.show(ui, view);
        } else if narrow {
            let shown = self.in_order();
            let scrolls = area.y <= ENOUGH * shown.len() as f32;
            let least = if scrolls { 300.0 } else { 1.0 };
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                let share = |view: &ViewKind| if *view == ViewKind::Oscillator { 0.3 } else { 1.0 };
                let all: f32 = shown.iter().map(share).sum();
                let gaps = ui.spacing().item_spacing.y * shown.len() as f32;
                let width = ui.available_width() - if scrolls { ui.spacing().scroll.bar_width } else { 0.0 };
                for view in shown {
                    let height = ((area.y - gaps) * share(&view) / all).max(least * share(&view));
                    let (rect, _) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
                    let mut child = ui.new_child(egui::UiBuilder::new().id_salt(view.view().name()).max_rect(rect));
                    panes.show(&mut child, view);
                }
            });
        } else if self.tree.is_empty() {
            ui.weak("No view is shown: choose some in the menu above.");
        } else {
            self.tree.ui(&mut panes, ui);
        }
        let Panes { pointed, closed, enlarge, .. } = panes;
        if let Some(view) = closed {
            self.toggle(view);
        }
        if let Some(view) = enlarge {
            self.enlarged = if self.enlarged.is_some() { None } else { Some(view) };
        }
        if pointed != context.axis.pointed {
            commands.push(Command::PointAt(pointed));
        }
    }
}

fn pane(tile: &Tile<ViewKind>) -> Option<ViewKind> {
    match tile {
        Tile::Pane(view) => Some(*view),
        Tile::Container(_) => None,
    }
}

/// Shows each view under its bar.
struct Panes<'a> {
    context: &'a ViewContext<'a>,
    commands: &'a mut Vec<Command>,
    pointed: Option<f64>,
    closed: Option<ViewKind>,
    enlarge: Option<ViewKind>,
    draggable: bool,
}

impl Panes<'_> {
    /// Returns whether the user begins to drag the view.
    fn show(&mut self, ui: &mut Ui, kind: ViewKind) -> bool {
        let view = kind.view();
        let dragged = self.bar_ui(ui, kind);
        self.pointed = view.ui(ui, self.context, self.commands).or(self.pointed);
        dragged
    }

    /// Name, explanation, enlarging and closing.
    fn bar_ui(&mut self, ui: &mut Ui, kind: ViewKind) -> bool {
        let view = kind.view();
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            ui.spacing_mut().interact_size.y = 16.0;
            let name = RichText::new(view.name()).small().weak();
            let sense = if self.draggable { Sense::click_and_drag() } else { Sense::click() };
            let title = ui.add(egui::Label::new(name).selectable(false).sense(sense));
            let title = if self.draggable { title.on_hover_text("Drag to move") } else { title };
            let [what, good, then] = view.help();
            let small = |icon: &str| Button::new(RichText::new(icon).small().weak()).frame(false);
            let help = ui.add(small("?")).on_hover_ui(|ui| {
                ui.set_max_width(380.0);
                for line in [what, good, then] {
                    ui.label(line);
                }
            });
            help.ctx.accesskit_node_builder(help.id, |node| node.set_label(format!("About {}", view.name())));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                let close = ui.add(small("×")).on_hover_text("Hide this view");
                close.ctx.accesskit_node_builder(close.id, |node| node.set_label(format!("Hide {}", view.name())));
                if close.clicked() {
                    self.closed = Some(kind);
                }
                let enlarge = ui.add(small("⛶")).on_hover_text("As large as can be, and back");
                enlarge.ctx.accesskit_node_builder(enlarge.id, |node| {
                    node.set_label(format!("Enlarge {}", view.name()));
                });
                if enlarge.clicked() || title.double_clicked() {
                    self.enlarge = Some(kind);
                }
            });
            title.drag_started()
        })
        .inner
    }
}

impl Behavior<ViewKind> for Panes<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _: TileId, view: &mut ViewKind) -> UiResponse {
        if self.show(ui, *view) { UiResponse::DragStarted } else { UiResponse::None }
    }

    fn tab_title_for_pane(&mut self, view: &ViewKind) -> WidgetText {
        view.view().name().into()
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions { all_panes_must_have_tabs: false, ..SimplificationOptions::default() }
    }

    fn gap_width(&self, _: &egui::Style) -> f32 {
        14.0
    }

    fn tab_bar_color(&self, _: &egui::Visuals) -> Color32 {
        self.context.palette.ground
    }

    /// The gap between views shows the ground; only while it is moved it shows that.
    fn resize_stroke(&self, style: &egui::Style, state: ResizeState) -> Stroke {
        match state {
            ResizeState::Idle => Stroke::NONE,
            ResizeState::Hovering => style.visuals.widgets.hovered.fg_stroke,
            ResizeState::Dragging => style.visuals.widgets.active.fg_stroke,
        }
    }
}
