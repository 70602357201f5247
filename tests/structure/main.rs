//! The structure of the workspace: which module imports which, and whether the documents fit each other and the program.

mod documents;
mod floors;
mod gallery;
mod graph;
mod imports;
mod items;
mod public;
mod rings;
mod tokens;

use std::path::{Path, PathBuf};

use graph::Graph;

/// The folder of the workspace.
fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folders of the crates, relative to that of the workspace: those with a `Cargo.toml` and a folder `src`.
fn crates(folder: &Path, found: &mut Vec<PathBuf>) {
    if folder.join("Cargo.toml").is_file() && folder.join("src").is_dir() {
        found.push(folder.to_owned());
    }
    let entries = folder.read_dir().expect("a folder can be read").map(|entry| entry.expect("an entry").path());
    for inner in entries.filter(|path| path.is_dir()) {
        let name = inner.file_name().unwrap_or_default().to_string_lossy();
        if !name.starts_with('.') && !["target", "src", "tests", "fuzz", "dist"].contains(&&*name) {
            crates(&inner, found);
        }
    }
}

#[test]
fn no_module_imports_one_that_imports_it() {
    let root = root();
    let mut folders = Vec::new();
    crates(root, &mut folders);
    assert!(folders.len() >= 8, "{folders:?}");
    let mut found = Vec::new();
    for folder in &folders {
        let name = folder.strip_prefix(root).expect("it is below the root").to_string_lossy().replace('\\', "/");
        let graph = Graph::of(&folder.join("src"));
        found.extend(graph.rings().into_iter().map(|ring| (name.clone(), ring)));
    }
    assert!(found.is_empty(), "rings of imports; move what both sides need below them: {found:#?}");
}
