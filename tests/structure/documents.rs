//! The documents: links lead somewhere, the book has all its pages, the first page is short.

use std::fs;
use std::path::{Path, PathBuf};

use crate::root;

/// The lines that a visitor reads at most.
const FIRST_PAGE: usize = 120;

/// The documents of a folder and those below it, but for what is built.
fn documents(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in folder.read_dir().expect("a folder can be read") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() && !name.starts_with('.') && !["target", "dist", "shared"].contains(&&*name) {
            documents(&path, found);
        } else if name.ends_with(".md") {
            found.push(path);
        }
    }
}

/// The text of a document without its blocks of code and without code in lines.
fn prose(path: &Path) -> String {
    let text = fs::read_to_string(path).expect("a document can be read");
    let outside: String = text.split("```").step_by(2).collect();
    outside.split('`').step_by(2).collect()
}

/// The targets of the links and pictures in a document.
fn targets(path: &Path) -> Vec<String> {
    let text = prose(path);
    let parts = text.split("](").skip(1).filter_map(|part| part.split_once(')'));
    parts.map(|(target, _)| target.to_owned()).collect()
}

/// The anchors of a document's headings, as web pages of Markdown have them.
fn anchors(path: &Path) -> Vec<String> {
    let text = fs::read_to_string(path).expect("a document can be read");
    let outside: String = text.split("```").step_by(2).collect();
    let headings = outside.lines().filter(|line| line.starts_with('#')).map(|line| line.trim_start_matches('#').trim());
    let kept = |c: &char| c.is_alphanumeric() || " -_".contains(*c);
    headings.map(|heading| heading.to_lowercase().chars().filter(kept).collect::<String>().replace(' ', "-")).collect()
}

fn is_elsewhere(target: &str) -> bool {
    target.starts_with("https://") || target.starts_with("mailto:")
}

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let mut pages = Vec::new();
    documents(root(), &mut pages);
    assert!(pages.len() > 20, "{pages:?}");
    let mut links = 0;
    for page in &pages {
        for target in targets(page).into_iter().filter(|target| !is_elsewhere(target)) {
            let (file, anchor) =
                target.split_once('#').map_or((target.as_str(), None), |(file, anchor)| (file, Some(anchor)));
            let path = if file.is_empty() { page.clone() } else { page.with_file_name(file) };
            assert!(path.exists(), "{}: `{target}` leads nowhere", page.display());
            if let Some(anchor) = anchor {
                assert!(
                    anchors(&path).iter().any(|one| one == anchor),
                    "{}: `{target}` has no heading",
                    page.display()
                );
            }
            links += 1;
        }
    }
    assert!(links > 60, "{links}");
}

/// As web pages the book stands alone, with the pictures of the tests beside it.
#[test]
fn the_book_lists_its_pages_and_links_only_to_them_and_to_pictures() {
    let book = root().join("docs");
    let listed = targets(&book.join("SUMMARY.md"));
    let mut pages = Vec::new();
    documents(&book, &mut pages);
    for page in pages {
        let name = page.file_name().unwrap_or_default().to_string_lossy().into_owned();
        assert!(name == "SUMMARY.md" || listed.contains(&name), "{name} is not in the summary");
        for target in targets(&page).into_iter().filter(|target| !is_elsewhere(target)) {
            let is_picture = target.starts_with("../tests/snapshots/") && target.ends_with(".png");
            assert!(is_picture || !target.contains('/'), "{name}: `{target}` is not part of the book");
        }
    }
}

#[test]
fn the_first_page_is_short() {
    let lines = fs::read_to_string(root().join("README.md")).expect("there is a first page").lines().count();
    assert!(lines <= FIRST_PAGE, "{lines} lines");
}

#[test]
fn every_crate_has_a_page() {
    let mut folders = Vec::new();
    crate::crates(root(), &mut folders);
    for folder in folders {
        assert!(folder.join("README.md").is_file(), "{} has no README.md", folder.display());
    }
}

/// The paths that `CONTRIBUTING.md` and the first page name are there.
#[test]
fn named_paths_exist() {
    let mut named = 0;
    for page in ["CONTRIBUTING.md", "README.md", "ARCHITECTURE.md"] {
        let text = fs::read_to_string(root().join(page)).expect("a document can be read");
        let outside: String = text.split("```").step_by(2).collect();
        for path in outside.split('`').skip(1).step_by(2).filter(|code| code.contains('/') && !code.contains(' ')) {
            let path = path.replace("NEW.rs", "").replace("NEW.toml", "");
            let is_path = ["core/", "src/", "lab/", "lessons/", "assets/", "tests/", "docs/"]
                .iter()
                .any(|top| path.starts_with(top));
            if is_path {
                assert!(root().join(&path).exists(), "{page}: there is no `{path}`");
                named += 1;
            }
        }
    }
    assert!(named > 40, "{named}");
}
