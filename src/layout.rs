//! The views on screen and their places: a tree of tiles, as data.

mod outline;

use egui::Id;
use egui_tiles::{Container, LinearDir, SimplificationOptions, Tile, TileId, Tiles, Tree};

use crate::kinds::{Arrangement, Proportions, ViewKind};

pub use outline::Outline;

/// The height of a tall view that is added, over the mean height of the others.
const TALL: f32 = 1.7;

pub struct ViewLayout {
    tree: Tree<ViewKind>,
    enlarged: Option<ViewKind>,
}

impl Default for ViewLayout {
    fn default() -> Self {
        let rows: LayoutRows<'_> = &[(0.34, &[ViewKind::Oscillator]), (0.66, &[ViewKind::Parameters])];
        Self { tree: tree(rows), enlarged: None }
    }
}

impl ViewLayout {
    pub fn of(arrangement: Arrangement) -> Self {
        Self { tree: tree(rows(arrangement)), enlarged: None }
    }

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

    pub(crate) fn of_outline(outline: Option<&Outline>, enlarged: Option<ViewKind>) -> Self {
        let mut tiles = Tiles::default();
        let tree = match outline.map(|outline| outline.insert_into(&mut tiles)) {
            Some(root) => Tree::new(Id::unique("views"), root, tiles),
            None => Tree::empty(Id::unique("views")),
        };
        Self { tree, enlarged }
    }

    pub fn shown(&self) -> Vec<ViewKind> {
        shown(&self.tree)
    }

    pub(crate) fn in_order(&self) -> Vec<ViewKind> {
        self.tree.root().map_or_else(Vec::new, |root| self.panes(root))
    }

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

    /// The tiles and their height, so that each view has at least the height that `least` returns: they fill the room or are
    /// higher. `gap` is the distance between rows \[points\].
    pub(crate) fn fitted(&self, room: f32, gap: f32, least: &dyn Fn(ViewKind) -> f32) -> (Tree<ViewKind>, f32) {
        let mut tree = self.tree.clone();
        let Some(root) = tree.root() else { return (tree, room) };
        let height = height_of(&tree.tiles, root, gap, least).max(room);
        fit(&mut tree.tiles, root, height, gap, least);
        (tree, height)
    }

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

    pub(crate) fn tree(&self) -> &Tree<ViewKind> {
        &self.tree
    }

    pub(crate) fn enlarged(&self) -> Option<ViewKind> {
        self.enlarged
    }

    pub(crate) fn rearrange(&mut self, tree: Tree<ViewKind>) {
        // The tree is a copy of the last frame's: a view that was closed since then must not come back.
        if shown(&tree) == self.shown() {
            self.tree = tree;
        }
    }

    pub(crate) fn toggle_enlarged(&mut self, view: ViewKind) {
        self.enlarged = if self.enlarged.is_some() { None } else { Some(view) };
    }

    pub(crate) fn enlarge(&mut self, view: ViewKind) {
        self.enlarged = Some(view);
    }

    pub(crate) fn show(&mut self, view: ViewKind) {
        let shown = self.shown();
        match view.tabs().iter().find(|tab| shown.contains(tab)) {
            _ if shown.contains(&view) => {}
            Some(tab) => self.choose_tab(*tab, view),
            None => self.toggle(view),
        }
        self.enlarged = self.enlarged.filter(|enlarged| *enlarged == view);
    }

    pub(crate) fn choose_tab(&mut self, shown: ViewKind, wanted: ViewKind) {
        // Both places are found before either changes: where both tabs are on screen, they exchange places.
        let places = [shown, wanted].map(|view| self.tree.tiles.find_pane(&view));
        for (place, view) in places.into_iter().zip([wanted, shown]) {
            if let Some(Tile::Pane(pane)) = place.and_then(|place| self.tree.tiles.get_mut(place)) {
                *pane = view;
            }
        }
        self.enlarged = self.enlarged.map(|view| if view == shown { wanted } else { view });
    }

    pub(crate) fn in_sight(&self) -> Vec<ViewKind> {
        self.enlarged.map_or_else(|| self.shown(), |view| vec![view])
    }

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

    pub fn leave_enlarged(&mut self) -> bool {
        self.enlarged.take().is_some()
    }

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

type LayoutRows<'a> = &'a [(f32, &'a [ViewKind])];

const fn rows(arrangement: Arrangement) -> LayoutRows<'static> {
    use ViewKind::{
        Autocorrelation, Consistency, Errors, Filters, Innovations, Map, Oscillator, ParameterPlane, Parameters,
        Scores, States,
    };
    match arrangement {
        Arrangement::Teach => &[(0.19, &[Oscillator]), (0.44, &[Parameters]), (0.37, &[States])],
        Arrangement::Tune => &[(0.5, &[Parameters, Consistency]), (0.5, &[Innovations, Autocorrelation])],
        Arrangement::Compare => &[(0.5, &[Parameters, Scores]), (0.5, &[Errors, Filters, ParameterPlane])],
        Arrangement::Laboratory => &[(0.62, &[Map]), (0.38, &[States])],
    }
}

fn tree(rows: LayoutRows<'_>) -> Tree<ViewKind> {
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

fn height_of(tiles: &Tiles<ViewKind>, tile: TileId, gap: f32, least: &dyn Fn(ViewKind) -> f32) -> f32 {
    let container = match tiles.get(tile) {
        None => return 0.0,
        Some(Tile::Pane(view)) => return least(*view),
        Some(Tile::Container(container)) => container,
    };
    let heights = container.children_vec().into_iter().map(|child| height_of(tiles, child, gap, least));
    match container {
        Container::Linear(linear) if linear.dir == LinearDir::Vertical => {
            heights.sum::<f32>() + gap * linear.children.len().saturating_sub(1) as f32
        }
        _ => heights.fold(0.0, f32::max),
    }
}

fn fit(tiles: &mut Tiles<ViewKind>, tile: TileId, height: f32, gap: f32, least: &dyn Fn(ViewKind) -> f32) {
    let Some(Tile::Container(container)) = tiles.get(tile) else { return };
    let children = container.children_vec();
    let mut heights = vec![height; children.len()];
    if let Container::Linear(linear) = container
        && linear.dir == LinearDir::Vertical
    {
        let leasts: Vec<f32> = children.iter().map(|row| height_of(tiles, *row, gap, least)).collect();
        let shares: Vec<f32> = children.iter().map(|row| linear.shares[*row]).collect();
        heights = shared(height - gap * children.len().saturating_sub(1) as f32, &shares, &leasts);
        let is_raised = heights.iter().zip(&leasts).any(|(height, least)| height == least);
        if let Some(Tile::Container(Container::Linear(linear))) = tiles.get_mut(tile).filter(|_| is_raised) {
            children.iter().zip(&heights).for_each(|(row, height)| linear.shares.set_share(*row, *height));
        }
    }
    for (child, height) in children.into_iter().zip(heights) {
        fit(tiles, child, height, gap, least);
    }
}

fn shared(height: f32, shares: &[f32], leasts: &[f32]) -> Vec<f32> {
    let mut is_least = vec![false; shares.len()];
    loop {
        let sum = |of: &[f32], least: bool| -> f32 {
            of.iter().zip(&is_least).filter(|(_, is)| **is == least).map(|(x, _)| x).sum()
        };
        let unit = (height - sum(leasts, true)) / sum(shares, false).max(f32::MIN_POSITIVE);
        // One row at a time: raising it lowers all others, which may then be too low themselves.
        let low = (0..shares.len()).find(|&at| !is_least[at] && shares[at] * unit < leasts[at]);
        let Some(low) = low else {
            let part = |at: usize| if is_least[at] { leasts[at] } else { shares[at] * unit };
            return (0..shares.len()).map(part).collect();
        };
        is_least[low] = true;
    }
}

pub(crate) fn simplification() -> SimplificationOptions {
    SimplificationOptions { all_panes_must_have_tabs: false, ..SimplificationOptions::default() }
}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn low_rows_are_raised_and_the_others_share_the_rest() {
        assert_eq!(shared(100.0, &[1.0, 3.0], &[10.0, 10.0]), [25.0, 75.0]);
        assert_eq!(shared(100.0, &[1.0, 30.0, 9.0], &[20.0, 20.0, 20.0]), [20.0, 60.0, 20.0]);
        assert_eq!(shared(60.0, &[0.0, 1.0, 1.0], &[20.0, 20.0, 20.0]), [20.0, 20.0, 20.0]);
    }

    #[test]
    fn views_that_were_dragged_together_have_their_least_height() {
        use ViewKind::{Map, Parameters, States};
        for shares in [[0.98, 0.01, 0.01], [0.01, 0.5, 0.49]] {
            let rows: Vec<(f32, &[ViewKind])> =
                shares.into_iter().zip([&[Map][..], &[Parameters], &[States]]).collect();
            let layout = ViewLayout { tree: tree(&rows), enlarged: None };
            for (room, height) in [(300.0, 440.0), (700.0, 700.0)] {
                let (tree, needed) = layout.fitted(room, 10.0, &|_| 140.0);
                assert_eq!(needed, height);
                let Some(Tile::Container(Container::Linear(rows))) = tree.root().and_then(|root| tree.tiles.get(root))
                else {
                    panic!("rows")
                };
                let shares: Vec<f32> = rows.children.iter().map(|row| rows.shares[*row]).collect();
                let unit = (height - 20.0) / shares.iter().sum::<f32>();
                assert!(shares.iter().all(|share| share * unit > 139.9), "{shares:?}");
            }
        }
        // Nothing changes where there is room.
        let usual = ViewLayout::of(Arrangement::Teach);
        assert!(usual.fitted(900.0, 10.0, &|_| 140.0).0 == usual.tree);
    }
}
