//! The views on screen and their places: a tree of tiles, as data.

use egui::Id;
use egui_tiles::{Container, LinearDir, SimplificationOptions, Tile, TileId, Tiles, Tree};

use crate::request::{Arrangement, Proportions, ViewKind};
use crate::share::Outline;

/// The height of a tall view that is added, over the mean height of the others.
const TALL: f32 = 1.7;

/// The views on screen.
pub struct Layout {
    tree: Tree<ViewKind>,
    enlarged: Option<ViewKind>,
}

/// The first screen: few, large views, so that a new user sees the mass and the estimates.
impl Default for Layout {
    fn default() -> Self {
        let rows: Rows<'_> = &[(0.34, &[ViewKind::Oscillator]), (0.66, &[ViewKind::Parameters])];
        Self { tree: tree(rows), enlarged: None }
    }
}

impl Layout {
    /// A ready-made arrangement.
    pub fn of(arrangement: Arrangement) -> Self {
        Self { tree: tree(rows(arrangement)), enlarged: None }
    }

    /// Views one below the other, the first with the most space; a plane is beside the view before it.
    pub fn column(views: &[ViewKind]) -> Self {
        let proportions = |kind: &ViewKind| kind.proportions();
        let share = |i: usize, row: &[ViewKind]| match row {
            [kind] if proportions(kind) == Proportions::Flat => 0.5,
            _ if i == 0 => 1.3,
            _ => 1.0,
        };
        let is_plane = |kind: &ViewKind| proportions(kind) == Proportions::Square;
        let rows = views.chunk_by(|before, next| is_plane(next) && !is_plane(before)).enumerate();
        let rows: Vec<(f32, &[ViewKind])> = rows.map(|(i, row)| (share(i, row), row)).collect();
        Self { tree: tree(&rows), enlarged: None }
    }

    /// The views of an outline, and that which is enlarged.
    pub(crate) fn of_outline(outline: Option<&Outline>, enlarged: Option<ViewKind>) -> Self {
        let mut tiles = Tiles::default();
        let tree = match outline.map(|outline| outline.insert_into(&mut tiles)) {
            Some(root) => Tree::new(Id::unique("views"), root, tiles),
            None => Tree::empty(Id::unique("views")),
        };
        Self { tree, enlarged }
    }

    /// The views that are shown.
    pub fn shown(&self) -> Vec<ViewKind> {
        shown(&self.tree)
    }

    /// The views that are shown, from top to bottom and left to right.
    pub(crate) fn in_order(&self) -> Vec<ViewKind> {
        self.tree.root().map_or_else(Vec::new, |root| self.panes(root))
    }

    /// The views on screen in rows, from top to bottom; those of a row from left to right.
    pub(crate) fn rows(&self) -> Vec<Vec<ViewKind>> {
        if let Some(view) = self.enlarged {
            return vec![vec![view]];
        }
        let Some(root) = self.tree.root() else { return Vec::new() };
        match self.tree.tiles.get(root) {
            Some(Tile::Container(Container::Linear(linear))) if linear.dir == LinearDir::Vertical => {
                linear.children.iter().map(|row| self.panes(*row)).collect()
            }
            _ => vec![self.panes(root)],
        }
    }

    /// The height that the views need where each has at least that which `least` says \[points\].
    pub(crate) fn height_for(&self, least: &dyn Fn(ViewKind) -> f32) -> f32 {
        self.tree.root().map_or(0.0, |root| self.height_of(root, least))
    }

    fn height_of(&self, tile: TileId, least: &dyn Fn(ViewKind) -> f32) -> f32 {
        let container = match self.tree.tiles.get(tile) {
            None => return 0.0,
            Some(Tile::Pane(view)) => return least(*view),
            Some(Tile::Container(container)) => container,
        };
        let heights = container.children_vec().into_iter().map(|child| self.height_of(child, least));
        match container {
            Container::Linear(linear) if linear.dir == LinearDir::Vertical => heights.sum(),
            _ => heights.fold(0.0, f32::max),
        }
    }

    /// The views of a tile, from left to right.
    fn panes(&self, tile: TileId) -> Vec<ViewKind> {
        let mut to_come = vec![tile];
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

    /// The tiles.
    pub(crate) fn tree(&self) -> &Tree<ViewKind> {
        &self.tree
    }

    /// The enlarged view, if any.
    pub(crate) fn enlarged(&self) -> Option<ViewKind> {
        self.enlarged
    }

    /// Takes over the tiles that the user has dragged or resized, unless the views have changed since.
    pub(crate) fn rearrange(&mut self, tree: Tree<ViewKind>) {
        if shown(&tree) == self.shown() {
            self.tree = tree;
        }
    }

    /// Enlarges one view, or shows all of them again.
    pub(crate) fn toggle_enlarged(&mut self, view: ViewKind) {
        self.enlarged = if self.enlarged.is_some() { None } else { Some(view) };
    }

    /// Enlarges one view.
    pub(crate) fn enlarge(&mut self, view: ViewKind) {
        self.enlarged = Some(view);
    }

    /// Shows a view; leaves another that is enlarged.
    pub(crate) fn show(&mut self, view: ViewKind) {
        if !self.shown().contains(&view) {
            self.toggle(view);
        }
        self.enlarged = self.enlarged.filter(|enlarged| *enlarged == view);
    }

    /// The views that are not behind an enlarged one.
    pub(crate) fn in_sight(&self) -> Vec<ViewKind> {
        self.enlarged.map_or_else(|| self.shown(), |view| vec![view])
    }

    /// Enlarges the next view, or the one before; after the last come all of them.
    pub fn turn(&mut self, forward: bool) {
        let views = self.in_order();
        let place = self.enlarged.and_then(|view| views.iter().position(|other| *other == view));
        let next = match (place, forward) {
            (None, true) => Some(0),
            (None, false) => views.len().checked_sub(1),
            (Some(place), true) => Some(place + 1),
            (Some(place), false) => place.checked_sub(1),
        };
        self.enlarged = next.and_then(|place| views.get(place)).copied();
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
            tree.simplify(&simplification());
            return;
        }
        let tile = tree.tiles.insert_pane(view);
        match tree.root() {
            Some(root) if tree.tiles.get_container(root).is_some() => {
                tree.move_tile_to_container(tile, root, usize::MAX, true);
                if let Some(Tile::Container(Container::Linear(rows))) = tree.tiles.get_mut(root) {
                    // The average room of the others, or more if it needs more.
                    let others: Vec<f32> =
                        rows.children.iter().filter(|row| **row != tile).map(|row| rows.shares[*row]).collect();
                    let mean = others.iter().sum::<f32>() / others.len().max(1) as f32;
                    let factor = if view.proportions() == Proportions::Tall { TALL } else { 1.0 };
                    rows.shares.set_share(tile, factor * mean);
                }
            }
            // A single view has no container.
            Some(root) => {
                let both = tree.tiles.insert_vertical_tile(vec![root, tile]);
                *tree = Tree::new(Id::unique("views"), both, std::mem::take(&mut tree.tiles));
            }
            None => *tree = Tree::new(Id::unique("views"), tile, std::mem::take(&mut tree.tiles)),
        }
    }
}

/// Rows of views, each with its share of the height.
type Rows<'a> = &'a [(f32, &'a [ViewKind])];

/// The rows of an arrangement.
const fn rows(arrangement: Arrangement) -> Rows<'static> {
    use ViewKind::{
        Autocorrelation, Consistency, Errors, Filters, Innovations, Map, Oscillator, ParameterPlane, Parameters,
        Scores, Slices, States,
    };
    match arrangement {
        Arrangement::Teach => &[(0.19, &[Oscillator]), (0.44, &[Parameters]), (0.37, &[States])],
        Arrangement::Tune => &[(0.5, &[Parameters, Consistency]), (0.5, &[Innovations, Autocorrelation])],
        Arrangement::Compare => &[(0.5, &[Parameters, Scores]), (0.5, &[Errors, Filters, ParameterPlane])],
        Arrangement::Laboratory => &[(0.62, &[Map]), (0.38, &[Slices, States])],
    }
}

/// The tiles of rows.
fn tree(rows: Rows<'_>) -> Tree<ViewKind> {
    let mut tiles = Tiles::default();
    let mut column = egui_tiles::Linear::new(LinearDir::Vertical, Vec::new());
    for (share, views) in rows {
        let panes: Vec<TileId> = views.iter().map(|view| tiles.insert_pane(*view)).collect();
        let row = if let [pane] = panes[..] { pane } else { tiles.insert_horizontal_tile(panes) };
        column.add_child(row);
        column.shares.set_share(row, *share);
    }
    let root = tiles.insert_container(column);
    let mut tree = Tree::new(Id::unique("views"), root, tiles);
    tree.simplify(&simplification());
    tree
}

/// Containers with one tile or none are removed.
pub(crate) fn simplification() -> SimplificationOptions {
    SimplificationOptions { all_panes_must_have_tabs: false, ..SimplificationOptions::default() }
}

/// The views of a tree.
fn shown(tree: &Tree<ViewKind>) -> Vec<ViewKind> {
    let shown: Vec<ViewKind> = tree.tiles.tiles().filter_map(pane).collect();
    ViewKind::ALL.into_iter().filter(|view| shown.contains(view)).collect()
}

fn pane(tile: &Tile<ViewKind>) -> Option<ViewKind> {
    match tile {
        Tile::Pane(view) => Some(*view),
        Tile::Container(_) => None,
    }
}
