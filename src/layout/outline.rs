//! The places of the views as a tree that cannot have rings, for texts from outside.

use egui_tiles::{Container, Grid, Linear, LinearDir, Tabs, Tile, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};

use crate::kinds::ViewKind;

/// Limits the containers inside each other: a text from outside must not overflow the stack.
pub(super) const DEEPEST: usize = 16;

pub(super) const SHARES: std::ops::RangeInclusive<f32> = 1e-3..=1e3;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outline {
    View(ViewKind),
    Rows(Vec<(f32, Outline)>),
    Columns(Vec<(f32, Outline)>),
    Tabs(usize, Vec<Outline>),
    Grid(Vec<Outline>),
}

impl Outline {
    pub(crate) fn of(tree: &Tree<ViewKind>) -> Option<Self> {
        Self::of_tile(&tree.tiles, tree.root()?, 0)
    }

    fn of_tile(tiles: &Tiles<ViewKind>, tile: TileId, depth: usize) -> Option<Self> {
        if depth > DEEPEST {
            return None;
        }
        let below = |tile: &TileId| Self::of_tile(tiles, *tile, depth + 1);
        Some(match tiles.get(tile)? {
            Tile::Pane(view) => Self::View(*view),
            Tile::Container(Container::Linear(linear)) => {
                let share = |tile: &TileId| linear.shares[*tile].clamp(*SHARES.start(), *SHARES.end());
                let children = linear.children.iter().filter_map(|tile| Some((share(tile), below(tile)?))).collect();
                if linear.dir == LinearDir::Vertical { Self::Rows(children) } else { Self::Columns(children) }
            }
            Tile::Container(Container::Tabs(tabs)) => {
                let active = tabs.children.iter().position(|tile| Some(*tile) == tabs.active);
                Self::Tabs(active.unwrap_or(0), tabs.children.iter().filter_map(below).collect())
            }
            Tile::Container(Container::Grid(grid)) => Self::Grid(grid.children().filter_map(below).collect()),
        })
    }

    pub(crate) fn insert_into(&self, tiles: &mut Tiles<ViewKind>) -> TileId {
        let linear = |dir, children: &[(f32, Self)], tiles: &mut Tiles<ViewKind>| {
            let mut linear = Linear::new(dir, Vec::new());
            for (share, child) in children {
                let tile = child.insert_into(tiles);
                linear.add_child(tile);
                linear.shares.set_share(tile, *share);
            }
            linear
        };
        let container = match self {
            Self::View(view) => return tiles.insert_pane(*view),
            Self::Rows(children) => Container::Linear(linear(LinearDir::Vertical, children, tiles)),
            Self::Columns(children) => Container::Linear(linear(LinearDir::Horizontal, children, tiles)),
            Self::Tabs(active, children) => {
                let mut tabs = Tabs::new(children.iter().map(|child| child.insert_into(tiles)).collect());
                tabs.active = tabs.children.get(*active).copied();
                Container::Tabs(tabs)
            }
            Self::Grid(children) => {
                Container::Grid(Grid::new(children.iter().map(|child| child.insert_into(tiles)).collect()))
            }
        };
        tiles.insert_container(container)
    }

    pub(crate) fn has(&self, view: ViewKind) -> bool {
        self.views().contains(&view)
    }

    pub(crate) fn validate(&self) -> Result<(), String> {
        let views = self.views();
        let twice = views.iter().enumerate().find(|(place, view)| views[..*place].contains(view));
        twice.map_or_else(|| self.validate_tile(0), |(_, view)| Err(format!("{view:?} is there twice")))
    }

    fn validate_tile(&self, depth: usize) -> Result<(), String> {
        if depth > DEEPEST {
            return Err(format!("more than {DEEPEST} containers are inside each other"));
        }
        if let Self::Rows(children) | Self::Columns(children) = self
            && let Some((share, _)) = children.iter().find(|(share, _)| !SHARES.contains(share))
        {
            let (low, high) = SHARES.into_inner();
            return Err(format!("a share is {share}, but must be from {low} to {high}"));
        }
        let children = self.children();
        if children.is_empty() && !matches!(self, Self::View(_)) {
            return Err("a container is empty".to_owned());
        }
        children.into_iter().try_for_each(|child| child.validate_tile(depth + 1))
    }

    fn children(&self) -> Vec<&Self> {
        match self {
            Self::View(_) => Vec::new(),
            Self::Rows(children) | Self::Columns(children) => children.iter().map(|(_, child)| child).collect(),
            Self::Tabs(_, children) | Self::Grid(children) => children.iter().collect(),
        }
    }

    fn views(&self) -> Vec<ViewKind> {
        match self {
            Self::View(view) => vec![*view],
            _ => self.children().into_iter().flat_map(Self::views).collect(),
        }
    }
}
