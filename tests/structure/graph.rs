//! The modules of a crate and what each imports.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path as FilePath;

use crate::imports::{Imports, Path};
use crate::items::{Item, Items};
use crate::rings::rings;
use crate::tokens::product;

/// The modules of a crate, each a file, with its imports. The root of the crate is the empty path.
#[derive(Default)]
pub(crate) struct Graph {
    modules: BTreeMap<Path, Imports>,
    /// The full path of each name that a module uses.
    names: BTreeMap<Path, BTreeMap<String, Path>>,
    /// The public items of each module.
    items: BTreeMap<Path, Items>,
}

impl Graph {
    /// The modules of the files in a folder, those for tests left out.
    pub(crate) fn of(folder: &FilePath) -> Self {
        let mut sources = Vec::new();
        read(folder, &[], &mut sources);
        Self::from_sources(sources)
    }

    /// The modules of these texts, by their names.
    pub(crate) fn from_texts(sources: &[(&str, &str)]) -> Self {
        let module = |path: &str| path.split('/').filter(|word| !word.is_empty()).map(str::to_owned).collect();
        Self::from_sources(sources.iter().map(|(path, text)| (module(path), (*text).to_owned())).collect())
    }

    /// The modules of these texts.
    fn from_sources(sources: Vec<(Path, String)>) -> Self {
        let mut graph = Self::default();
        let mut tests = BTreeSet::new();
        for (module, source) in sources {
            let (tokens, of_tests) = product(&source);
            tests.extend(of_tests.into_iter().map(|name| [&module[..], &[name]].concat()));
            graph.items.insert(module.clone(), Items::of(&tokens));
            let Imports { paths, names, exported } = Imports::of(&tokens);
            // A library and a program of one crate share the root.
            let known = graph.modules.entry(module).or_default();
            known.paths.extend(paths);
            known.names.extend(names);
            known.exported.extend(exported);
        }
        graph.modules.retain(|module, _| !tests.iter().any(|test| module.starts_with(test)));
        for (module, imports) in &graph.modules {
            let named =
                imports.names.iter().filter_map(|(name, path)| Some((name.clone(), graph.absolute(module, path)?)));
            let named: BTreeMap<String, Path> = named.collect();
            graph.names.insert(module.clone(), named);
        }
        graph
    }

    /// A path from the crate's root, if it leads into the crate.
    fn absolute(&self, module: &[String], path: &[String]) -> Option<Path> {
        let first = path.first()?;
        let up = path.iter().take_while(|word| *word == "super").count();
        match first.as_str() {
            "crate" => Some(path[1..].to_vec()),
            "self" => Some([module, &path[1..]].concat()),
            "super" => Some([&module[..module.len().checked_sub(up)?], &path[up..]].concat()),
            // A child of the module, or a name from elsewhere.
            _ => {
                let child = [module, std::slice::from_ref(first)].concat();
                self.modules.contains_key(&child).then(|| [module, path].concat())
            }
        }
    }

    /// The module that a path from the root leads into.
    fn owner(&self, path: &[String]) -> &[String] {
        let longest = (0..=path.len()).rev().find_map(|length| self.modules.get_key_value(&path[..length]));
        longest.map_or(&[], |(module, _)| module)
    }

    /// The path to where an item stands that a path from the root names: re-exports are followed.
    fn home(&self, path: &[String]) -> Path {
        let mut path = path.to_vec();
        // A name that stands for itself would be followed for ever.
        let mut seen = BTreeSet::new();
        loop {
            let module = self.owner(&path);
            let rest = &path[module.len()..];
            let target = rest.first().and_then(|name| self.names.get(module)?.get(name));
            match target {
                Some(target) if seen.insert(path.clone()) => path = [target, &rest[1..]].concat(),
                _ => return path,
            }
        }
    }

    /// The modules that each module imports. A module and those inside it are one thing.
    fn edges(&self) -> BTreeMap<&[String], BTreeSet<&[String]>> {
        let of = |(module, imports): (&'_ Path, &'_ Imports)| {
            let owners =
                imports.paths.iter().filter_map(|path| Some(self.owner(&self.home(&self.absolute(module, path)?))));
            let is_other = |owner: &&[String]| !owner.starts_with(module) && !module.starts_with(owner);
            owners.filter(is_other).collect()
        };
        self.modules.iter().map(|entry| (entry.0.as_slice(), of(entry))).collect()
    }

    /// The rings of modules, each in the order of their names.
    pub(crate) fn rings(&self) -> Vec<Vec<String>> {
        let name = |module: &[String]| module.join("/");
        rings(&self.edges()).into_iter().map(|ring| ring.into_iter().map(name).collect()).collect()
    }

    /// The modules that each module imports, by their names.
    pub(crate) fn imports(&self) -> BTreeMap<String, BTreeSet<String>> {
        let name = |module: &[String]| module.join("/");
        self.edges().into_iter().map(|(module, to)| (name(module), to.into_iter().map(name).collect())).collect()
    }

    /// The public items that stand in a module, with their places.
    pub(crate) fn own(&self, module: &[String]) -> Vec<(String, Path)> {
        let items = self.items.get(module).into_iter().flat_map(|items| &items.own);
        items.map(|(name, _)| (name.clone(), [module, std::slice::from_ref(name)].concat())).collect()
    }

    /// The names that a module exports from elsewhere in the crate, with the places of what they stand for.
    pub(crate) fn exported(&self, module: &[String]) -> Vec<(String, Path)> {
        let (Some(imports), Some(names)) = (self.modules.get(module), self.names.get(module)) else {
            return Vec::new();
        };
        imports.exported.iter().filter_map(|name| Some((name.clone(), self.home(names.get(name)?)))).collect()
    }

    /// The kinds of the public items at a place: a module and a function may have one name.
    pub(crate) fn kinds(&self, place: &[String]) -> Vec<&str> {
        let Some((name, module)) = place.split_last() else { return Vec::new() };
        let items = self.items.get(module).into_iter().flat_map(|items| &items.own);
        items.filter(|item| item.0 == *name).map(|item| item.1.as_str()).collect()
    }

    /// The public members of types and traits, by the places of these.
    pub(crate) fn members(&self) -> BTreeMap<Path, Vec<Item>> {
        let mut members: BTreeMap<Path, Vec<Item>> = BTreeMap::new();
        for (module, items) in &self.items {
            for (of, item) in &items.members {
                let home = self.home(&[&module[..], std::slice::from_ref(of)].concat());
                members.entry(home).or_default().push(item.clone());
            }
        }
        members
    }
}

/// Reads the sources of a folder with the paths of their modules.
fn read(folder: &FilePath, module: &[String], sources: &mut Vec<(Path, String)>) {
    for entry in fs::read_dir(folder).expect("a folder can be read") {
        let path = entry.expect("an entry").path();
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            read(&path, &[module, &[stem]].concat(), sources);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let is_root = ["lib", "main", "mod"].contains(&stem.as_str());
            let module = if is_root { module.to_vec() } else { [module, &[stem]].concat() };
            sources.push((module, fs::read_to_string(&path).expect("a source can be read")));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(sources: &[(&str, &str)]) -> Vec<Vec<String>> {
        Graph::from_texts(sources).rings()
    }

    #[test]
    fn a_ring_through_a_re_export_is_found() {
        let root = ("", "mod a; mod b; mod c; pub use b::inner::Thing;");
        let b = ("b", "pub mod inner;");
        let a = ("a", "use crate::Thing;");
        assert_eq!(found(&[root, a, b, ("b/inner", "use crate::a::Other;")]), [["a", "b/inner"]]);
        assert_eq!(found(&[root, a, b, ("b/inner", "use crate::c::Other;"), ("c", "")]).len(), 0);
    }

    #[test]
    fn a_ring_through_what_a_parent_imports_is_found() {
        let parent = ("a", "mod child; use crate::b::Thing;");
        let child = ("a/child", "use super::Thing;");
        assert_eq!(found(&[("", "mod a; mod b;"), parent, child, ("b", "fn f() { crate::a::child::f() }")]).len(), 1);
    }

    #[test]
    fn tests_may_import_anything() {
        let a = ("a", "use crate::b::B; #[cfg(test)] mod tests;");
        let b = ("b", "#[cfg(test)] mod tests { use crate::a::A; }");
        assert_eq!(found(&[("", "mod a; mod b;"), a, ("a/tests", "use crate::c;"), b]).len(), 0);
    }
}
