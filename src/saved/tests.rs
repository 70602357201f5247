//! Saved sessions of this format and of older ones, and impossible ones.

use serde_json::{Value, json};

use super::*;
use crate::request::Arrangement;
use crate::ruler::End;

fn saved() -> Saved {
    let mut scenario = Scenario { seed: 5, ..Scenario::default() };
    scenario.number_filters();
    let mut saved = Saved { scenario, mode: Mode::Whole, speed: 0.5, dark: Some(true), ..Saved::default() };
    saved.views = Outline::of(Layout::of(Arrangement::Tune).tree());
    saved.enlarged = Some(ViewKind::Innovations);
    saved.ruler.place(End::B, 12.5);
    saved.hidden = vec![LegendEntry::Bands];
    saved
}

fn value(saved: &Saved) -> Value {
    serde_json::from_str(&saved.text().expect("it can be written")).expect("it is JSON")
}

#[test]
fn all_comes_back() {
    let (read, problems) = Saved::read(&saved().text().expect("it can be written"));
    assert_eq!((read, problems), (saved(), vec![]));
}

#[test]
fn older_formats_can_be_read() {
    let tree = serde_json::to_value(Layout::of(Arrangement::Tune).tree()).expect("a tree is data");
    let layout = json!({ "tree": tree });
    for version in [1, 2] {
        let mut old = value(&saved());
        let parts = old.as_object_mut().expect("it is an object");
        for key in ["views", "enlarged", "marks", "hidden"] {
            parts.remove(key);
        }
        parts.insert("version".to_owned(), version.into());
        parts.insert("layout".to_owned(), if version == 1 { layout.to_string().into() } else { layout.clone() });
        let (read, problems) = Saved::read(&old.to_string());
        let expected = Saved { enlarged: None, ruler: Ruler::default(), hidden: vec![], ..saved() };
        assert_eq!((read, problems), (expected, vec![]));
        // A layout that would end the program leaves the rest.
        let bad = old
            .to_string()
            .replace("\"height\":null", "\"height\":1e38")
            .replace("\\\"height\\\":null", "\\\"height\\\":1e38");
        let (read, problems) = Saved::read(&bad);
        assert_eq!((read.views, read.scenario.seed), (usual_views(), 5));
        assert!(problems[..].concat().contains("layout: its height is 1e38"), "{problems:?}");
    }
}

#[test]
fn views_that_nobody_can_show_leave_the_rest() {
    let deep = (0..20).fold(json!({ "view": "States" }), |inner, _| json!({ "tabs": [0, [inner]] }));
    for (views, reason) in [(deep, "more than 16 containers"), (json!({ "rows": [] }), "a container is empty")] {
        let mut bad = value(&saved());
        bad["views"] = views;
        let (read, problems) = Saved::read(&bad.to_string());
        assert_eq!((read.views, read.scenario.seed), (usual_views(), 5));
        assert!(problems[..].concat().contains(reason), "{problems:?}");
    }
}
