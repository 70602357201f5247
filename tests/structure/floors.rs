//! Floors: a module imports from those below it and from its own floor.

use crate::graph::Graph;
use crate::root;

/// The folders of `core/src`, from the lowest on. `internals` hands parts of them out.
const CORE: &[&[&str]] = &[&["mathematics"], &["data"], &["samples"], &["numbers"], &["judgement"], &["internals"]];

/// The modules of `src`, from the lowest floor on.
const EXPLORER: &[&[&str]] = &[
    // What every part of a screen needs, and which knows no run.
    &["focus", "hover", "inbox", "menu", "ruler", "sensor", "spark", "steady", "text", "theme", "verdict"],
    // What is on screen, as data: the run, the laboratory, the places of views, requests.
    &[
        "comparison",
        "gap",
        "laboratory",
        "layout",
        "probe",
        "request",
        "session",
        "share",
        "team",
        "trouble",
        "visibility",
    ],
    // Drawing over time, and controls.
    &["controls", "equation", "plot", "sheet", "thumbnail"],
    &["view", "views"],
    // Panels and dialogs around the views.
    &[
        "bar",
        "column",
        "drawer",
        "export_menu",
        "finder",
        "import",
        "keys",
        "legend",
        "measure",
        "notice",
        "panes",
        "reading",
        "shelf",
        "story",
        "timeline",
        "transport",
        "tutor",
        "twin",
    ],
    // Files that leave and files that come.
    &["drop", "export", "figure", "saved", "session_file"],
    &["app"],
];

/// The place of a module's floor. The root of the crate stands on none.
fn floor(floors: &[&[&str]], module: &str) -> Option<usize> {
    let first = module.split('/').next().unwrap_or_default();
    floors.iter().position(|floor| floor.contains(&first))
}

/// The imports of a crate that lead from a floor to a higher one.
fn upward(floors: &[&[&str]], graph: &Graph) -> Vec<String> {
    let mut found = Vec::new();
    for (module, imports) in graph.imports() {
        for import in imports {
            let of = |module: &str| floor(floors, module);
            if of(&module).is_some_and(|below| of(&import).is_some_and(|above| below < above)) {
                found.push(format!("{module} imports {import}"));
            }
        }
    }
    found
}

/// Asserts that all modules of a crate stand on floors and import downwards. Some modules may import anything.
fn assert_downwards(floors: &[&[&str]], graph: &Graph, free: &[&str]) {
    let is_free = |module: &str| free.iter().any(|one| module.split('/').next() == Some(one));
    let homeless: Vec<String> = graph
        .imports()
        .into_keys()
        .filter(|module| !module.is_empty() && !is_free(module) && floor(floors, module).is_none())
        .collect();
    assert!(homeless.is_empty(), "on no floor: {homeless:?}");
    let found = upward(floors, graph);
    assert!(found.is_empty(), "imports of a higher floor; move what both need to the lower one: {found:#?}");
}

#[test]
fn floors_of_the_core_import_downwards() {
    assert_downwards(CORE, &Graph::of(&root().join("core/src")), &[]);
}

/// The programs, native and of the page, use the library as anyone does.
#[test]
fn floors_of_the_explorer_import_downwards() {
    assert_downwards(EXPLORER, &Graph::of(&root().join("src")), &["native", "web"]);
}

#[test]
fn an_import_of_a_higher_floor_is_found() {
    let of = |sources: &[(&str, &str)]| upward(CORE, &Graph::from_texts(sources));
    let root = ("", "mod mathematics; mod samples; pub use samples::inner::Run;");
    let samples = [("samples", "pub mod inner;"), ("samples/inner", "use crate::mathematics::Filter;")];
    let with = |text| [root, samples[0], samples[1], ("mathematics", text)];
    assert_eq!(of(&with("fn f(run: crate::Run) {}")), ["mathematics imports samples/inner"]);
    assert_eq!(of(&with("#[cfg(test)] mod tests { use crate::Run; }")).len(), 0);
}
