//! The floors of the core: a folder imports from those below it.

use crate::graph::Graph;
use crate::root;

/// The folders of `core/src`, from the lowest on. `internals` hands parts of them out.
const FLOORS: [&str; 6] = ["mathematics", "data", "samples", "numbers", "judgement", "internals"];

/// The place of a module's floor. The root of the crate stands on none.
fn floor(module: &str) -> Option<usize> {
    let first = module.split('/').next().unwrap_or_default();
    FLOORS.iter().position(|floor| *floor == first)
}

/// The imports of a crate that lead from a floor to a higher one.
fn upward(graph: &Graph) -> Vec<String> {
    let mut found = Vec::new();
    for (module, imports) in graph.imports() {
        for import in imports {
            if floor(&module).is_some_and(|below| floor(&import).is_some_and(|above| below < above)) {
                found.push(format!("{module} imports {import}"));
            }
        }
    }
    found
}

#[test]
fn floors_of_the_core_import_downwards() {
    let graph = Graph::of(&root().join("core/src"));
    let homeless: Vec<String> =
        graph.imports().into_keys().filter(|module| !module.is_empty() && floor(module).is_none()).collect();
    assert!(homeless.is_empty(), "on no floor: {homeless:?}");
    let found = upward(&graph);
    assert!(found.is_empty(), "imports of a higher floor; move what both need to the lower one: {found:#?}");
}

#[test]
fn an_import_of_a_higher_floor_is_found() {
    let of = |sources: &[(&str, &str)]| upward(&Graph::from_texts(sources));
    let root = ("", "mod mathematics; mod samples; pub use samples::inner::Run;");
    let samples = [("samples", "pub mod inner;"), ("samples/inner", "use crate::mathematics::Filter;")];
    let with = |text| [root, samples[0], samples[1], ("mathematics", text)];
    assert_eq!(of(&with("fn f(run: crate::Run) {}")), ["mathematics imports samples/inner"]);
    assert_eq!(of(&with("#[cfg(test)] mod tests { use crate::Run; }")).len(), 0);
}
