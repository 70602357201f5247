//! The page with a picture of every view.

use std::fs;

use kalmanscope::request::ViewKind;
use kalmanscope::views::view;

use crate::root;

/// The page that the views ask for.
fn expected() -> String {
    let part = |kind: ViewKind| {
        let (name, [first, ..]) = (view(kind).name(), view(kind).help());
        let file = name.replace(' ', "-").to_lowercase();
        format!("\n## {name}\n{first}\n\n![{name}](../tests/snapshots/view-{file}.png)\n")
    };
    let parts: String = ViewKind::ALL.into_iter().map(part).collect();
    format!(
        "# All views\n`UPDATE_SNAPSHOTS=1 cargo test --test looks --test structure` makes these pictures and this page anew. The sentence is \
         the first of those\nbehind the `?` of a view.\n{parts}"
    )
}

/// `UPDATE_SNAPSHOTS=1` writes the page, as it does pictures.
#[test]
fn the_gallery_has_every_view() {
    let path = root().join("docs/gallery.md");
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        fs::write(&path, expected()).expect("the page can be written");
    }
    assert_eq!(fs::read_to_string(path).expect("there is a gallery"), expected());
}
