//! The public surface of the core: what other crates can name, an item a line.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fs;

use crate::graph::Graph;
use crate::imports::Path;
use crate::root;

/// The surface of a crate: each item under its shortest path, with its kind. The items of modules come after those of the root,
/// and an item that has been found is not listed again.
fn surface(graph: &Graph) -> String {
    let members = graph.members();
    let mut lines = BTreeSet::new();
    let (mut found, mut left) = (BTreeSet::new(), VecDeque::from([(Path::new(), Path::new())]));
    while let Some((public, module)) = left.pop_front() {
        let own = graph.own(&module).into_iter();
        for (name, home) in own.chain(graph.exported(&module)) {
            let public = [&public[..], &[name]].concat();
            let line = |path: &[String], kind: &str| format!("{} {kind}\n", path.join("::"));
            for kind in graph.kinds(&home) {
                if !found.insert((home.clone(), kind)) {
                    continue;
                }
                lines.insert(line(&public, kind));
                if kind == "mod" {
                    left.push_back((public.clone(), home.clone()));
                    continue;
                }
                for (name, kind) in members.get(&home).into_iter().flatten() {
                    lines.insert(line(&[&public[..], std::slice::from_ref(name)].concat(), kind));
                }
            }
        }
    }
    lines.into_iter().collect()
}

/// `UPDATE_SNAPSHOTS=1` writes the table, as it does pictures.
#[test]
fn the_public_surface_of_the_core_is_the_table() {
    let path = root().join("core/public.txt");
    let surface = surface(&Graph::of(&root().join("core/src")));
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        fs::write(&path, &surface).expect("the table can be written");
    }
    let table = fs::read_to_string(path).expect("there is a table");
    let [before, now] = [&table, &surface].map(|text| text.lines().collect::<BTreeSet<_>>());
    let (gone, new): (Vec<_>, Vec<_>) = (before.difference(&now).collect(), now.difference(&before).collect());
    assert!(table == surface, "core/public.txt is not up to date; gone: {gone:#?}, new: {new:#?}");
}

/// Limits the public modules of the core: its page explains each of them.
const MODULES: usize = 15;

#[test]
fn the_core_has_few_public_modules() {
    let graph = Graph::of(&root().join("core/src"));
    let names: BTreeMap<String, Path> = graph.own(&[]).into_iter().chain(graph.exported(&[])).collect();
    let is_module = |home: &Path| graph.kinds(home).contains(&"mod");
    let modules: Vec<&String> =
        names.iter().filter(|(name, home)| *name != "internals" && is_module(home)).map(|(name, _)| name).collect();
    assert!(modules.len() <= MODULES, "{modules:?}");
}

#[test]
fn an_item_has_its_shortest_path_and_its_members() {
    let sources = [
        ("", "mod a; pub mod b; pub use a::{Thing as Other, inner}; use a::Hidden;"),
        ("a", "pub mod inner; pub struct Thing; pub struct Hidden;"),
        ("a/inner", "use super::Thing; impl Thing { pub fn f() {} } pub fn g() {}"),
        ("b", "pub use crate::a::Thing; fn h() {}"),
    ];
    assert_eq!(surface(&Graph::from_texts(&sources)), "Other struct\nOther::f fn\nb mod\ninner mod\ninner::g fn\n");
}
