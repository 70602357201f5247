//! The heights of views in one column, for windows that are narrow or low.

use egui::Vec2;

use crate::request::{Proportions, ViewKind};

/// Limits the height per view above which all views fit on screen; below it they scroll \[points\].
const ENOUGH: f32 = 250.0;

/// The least height of views that are not flat, if views scroll \[points\].
const LEAST: f32 = 300.0;

const TALL: f32 = 1.7;

/// The least height of a tall view that is higher than the column \[points\].
const LEAST_TALL: f32 = 240.0;

/// The height of a flat view without its bar, as a share of the column's width.
const FLAT: f32 = 0.3;

/// Limits the height of a flat view without its bar, as a share of the column's height for each of the other views; and
/// the least heights if all views fit and if they scroll \[points\].
const FLAT_SHARE: f32 = 0.2;
const LEAST_FLAT: f32 = 64.0;
const LEAST_FLAT_SCROLLING: f32 = 84.0;

/// The heights of views in one column \[points\].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Column {
    pub(crate) heights: Vec<f32>,
    pub(crate) scrolls: bool,
}

impl Column {
    /// Views in a room, each under a bar of the height `bar` and above a `gap`. A flat view has the height of its picture; the
    /// others share the rest.
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
        let flat = bar + picture.max(LEAST_FLAT);
        let rest = room.y - flat * (kinds.len() - sharing) as f32 - gap * kinds.len() as f32;
        let scrolls = rest <= ENOUGH * all.max(sharing as f32);
        let least = if scrolls { LEAST.min(room.y) } else { 1.0 };
        // A tall view can be seen as a whole.
        let most = room.y.max(LEAST_TALL);
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
    fn the_plant_keeps_its_height_whatever_else_is_shown() {
        use ViewKind::{Errors, Innovations, Oscillator, Parameters, States};
        let others = [Parameters, States, Errors, Innovations];
        for room in [vec2(370.0, 660.0), vec2(370.0, 340.0), vec2(824.0, 290.0)] {
            for count in 1..=others.len() {
                let kinds: Vec<ViewKind> = [Oscillator].into_iter().chain(others).take(1 + count).collect();
                let Column { heights, scrolls } = Column::new(&kinds, room, 44.0, 5.0);
                let sum: f32 = heights.iter().map(|height| height + 5.0).sum();
                assert!(heights[0] >= 44.0 + LEAST_FLAT, "{room} {count}: {heights:?}");
                assert!(heights[1..].iter().all(|height| *height >= 160.0), "{room} {count}: {heights:?}");
                assert!(scrolls || sum <= room.y, "{room} {count}: {heights:?}");
            }
        }
    }

    #[test]
    fn a_tall_view_is_not_cut_off() {
        for room in [vec2(370.0, 320.0), vec2(824.0, 230.0)] {
            let Column { heights, .. } = Column::new(&[ViewKind::Map, ViewKind::Parameters], room, 44.0, 5.0);
            assert!(heights[0] == room.y.max(LEAST_TALL), "{room}: {heights:?}");
        }
    }

    #[test]
    fn a_view_alone_has_all_the_room() {
        for kind in ViewKind::ALL {
            let Column { heights, scrolls } = Column::new(&[kind], vec2(370.0, 660.0), 44.0, 5.0);
            assert!(!scrolls && heights[0] > 640.0, "{kind:?}: {heights:?}");
        }
    }
}
