//! The places of views as the files of older programs have them: tiles that name each other. Such a file may be made by
//! hand, so it is converted to an [`Outline`] and checked before it is shown.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use egui_tiles::{Container, Tile, TileId, Tiles, Tree};
use kalmanscope_core::Document;

use super::Outline;
use super::outline::{DEEPEST, SHARES};
use crate::request::ViewKind;

/// The heights and widths of all tiles together that a file may fix \[points\].
const SIZES: RangeInclusive<f64> = 1.0..=1e5;

/// The outline of the tiles in a document. `None` if no view is shown.
///
/// # Errors
/// A sentence that says what is wrong: a ring, a tile that is missing, containers too deep in each other, sizes and shares that
/// no screen has.
pub(crate) fn outline_of_tiles(document: &Document) -> Result<Option<Outline>, String> {
    for key in ["height", "width"] {
        let size: Option<f64> =
            document.get(key).map_or(Ok(None), Document::read).map_err(|error| format!("{key}: {error}"))?;
        if let Some(size) = size.filter(|size| !SIZES.contains(size)) {
            return Err(format!("its {key} is {size:e}, but must be from {:e} to {:e}", SIZES.start(), SIZES.end()));
        }
    }
    let tree: Tree<ViewKind> = document.read().map_err(|error| error.to_string())?;
    let Some(root) = tree.root() else { return Ok(None) };
    check(&tree.tiles, root, 0, &mut BTreeSet::new())?;
    let outline = Outline::of(&tree);
    outline.as_ref().map_or(Ok(()), Outline::validate)?;
    Ok(outline)
}

/// Checks a tile and those in it.
fn check(tiles: &Tiles<ViewKind>, tile: TileId, depth: usize, met: &mut BTreeSet<u64>) -> Result<(), String> {
    if depth > DEEPEST {
        return Err(format!("more than {DEEPEST} containers are inside each other"));
    }
    if !met.insert(tile.0) {
        return Err("a view of its layout has two places".to_owned());
    }
    let Some(found) = tiles.get(tile) else { return Err("a view of its layout is missing".to_owned()) };
    let Tile::Container(container) = found else { return Ok(()) };
    let shares: Vec<f32> = match container {
        Container::Linear(linear) => linear.children.iter().map(|child| linear.shares[*child]).collect(),
        Container::Grid(grid) => grid.col_shares.iter().chain(&grid.row_shares).copied().collect(),
        Container::Tabs(_) => Vec::new(),
    };
    // Small ones are enlarged, as those of a link are when it is made.
    let high = *SHARES.end();
    if let Some(share) = shares.iter().find(|share| !(0.0..=high).contains(*share)) {
        return Err(format!("a share is {share:e}, but must be from 0 to {high}"));
    }
    container.children().try_for_each(|child| check(tiles, *child, depth + 1, met))
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::layout::Layout;
    use crate::request::Arrangement;

    /// The tiles of an arrangement, as an older program has written them.
    fn tiles(arrangement: Arrangement) -> Value {
        serde_json::to_value(Layout::of(arrangement).tree()).expect("a tree is data")
    }

    fn read(tiles: &Value) -> Result<Option<Outline>, String> {
        outline_of_tiles(&Document::from_json(&tiles.to_string()).expect("it is JSON"))
    }

    /// The tiles with a change at a place.
    fn changed(pointer: &str, value: Value) -> Value {
        let mut tiles = tiles(Arrangement::Compare);
        let root = format!("/tiles/tiles/{}/Container/Linear", tiles["root"]);
        let place = tiles.pointer_mut(&pointer.replace("ROOT", &root));
        *place.unwrap_or_else(|| panic!("{pointer}")) = value;
        tiles
    }

    /// Containers inside each other, with one view in the innermost.
    fn nested(depth: usize) -> Value {
        let tabs = |child: usize| json!({ "Container": { "Tabs": { "children": [child], "active": child } } });
        let mut tiles: serde_json::Map<String, Value> = (0..depth).map(|id| (id.to_string(), tabs(id + 1))).collect();
        tiles.insert(depth.to_string(), json!({ "Pane": "States" }));
        let tiles = json!({ "next_tile_id": depth + 1, "tiles": tiles, "invisible": [] });
        json!({ "id": 1, "root": 0, "tiles": tiles, "height": null, "width": null })
    }

    #[test]
    fn tiles_of_older_programs_keep_their_places() {
        for arrangement in Arrangement::ALL {
            let expected = Outline::of(Layout::of(arrangement).tree());
            assert_eq!(read(&tiles(arrangement)), Ok(expected), "{arrangement:?}");
        }
        assert!(read(&nested(DEEPEST)).is_ok_and(|outline| outline.is_some()));
        assert_eq!(read(&changed("/root", Value::Null)), Ok(None));
    }

    #[test]
    fn tiles_that_nobody_can_show_are_refused_in_words() {
        let root = tiles(Arrangement::Compare)["root"].clone();
        let mut twice = changed("/height", Value::Null);
        let panes = twice["tiles"]["tiles"].as_object_mut().expect("they are named");
        panes.values_mut().filter(|tile| tile.get("Pane").is_some()).for_each(|tile| *tile = json!({ "Pane": "Map" }));
        for (tiles, reason) in [
            (changed("/height", json!(1e38)), "its height is 1e38, but must be from 1e0 to 1e5"),
            (changed("/width", json!(-1.0)), "its width is -1e0"),
            (changed("/width", json!("wide")), "width: "),
            (changed("ROOT/children", json!([root])), "a view of its layout has two places"),
            (changed("ROOT/children", json!([999_999])), "a view of its layout is missing"),
            (changed("ROOT/children", json!([])), "a container is empty"),
            (changed("ROOT/shares/shares", json!({ "1": 1e38, "2": 1e38, "3": 1e38 })), "a share is 1e38"),
            (changed("ROOT/shares/shares", json!({ "1": -1, "2": -1, "3": -1 })), "a share is -1e0"),
            (twice, "Map is there twice"),
            (nested(DEEPEST + 1), "more than 16 containers are inside each other"),
            (nested(20_000), "more than 16 containers are inside each other"),
            (json!({ "tiles": [] }), "expected"),
            (json!(5), "expected"),
        ] {
            let refused = read(&tiles).expect_err(reason);
            assert!(refused.contains(reason), "{refused}, not {reason}");
        }
    }
}
