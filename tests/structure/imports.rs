//! The paths that a module names: those of its `use` lines, and others that begin with `crate`, `self` or `super`.

use crate::tokens::Token;

/// A path, word by word.
pub(crate) type Path = Vec<String>;

/// What a module imports.
#[derive(Default)]
pub(crate) struct Imports {
    /// The paths that it names, relative to itself; of a glob without the `*`.
    pub(crate) paths: Vec<Path>,
    /// The names that `use` gives it, with what they stand for. Children see them, and others where they are public.
    pub(crate) names: Vec<(String, Path)>,
    /// Those of them that it gives to other crates, if these can name the module.
    pub(crate) exported: Vec<String>,
}

impl Imports {
    /// The imports of a module with these tokens. Those of its inline modules count as its own.
    pub(crate) fn of(tokens: &[Token]) -> Self {
        let mut imports = Self::default();
        // The inline modules around the present place, with the depths of braces inside them.
        let mut inline: Vec<(String, usize)> = Vec::new();
        let (mut depth, mut at) = (0_usize, 0);
        while at < tokens.len() {
            let rest = &tokens[at..];
            let word = |place: usize| rest.get(place).map_or("", String::as_str);
            let is_path = at == 0 || tokens[at - 1] != "::";
            let mut length = 1;
            match word(0) {
                "{" => depth += 1,
                "}" => {
                    depth = depth.saturating_sub(1);
                    inline.pop_if(|(_, inside)| *inside > depth);
                }
                "mod" if word(2) == "{" => {
                    depth += 1;
                    inline.push((word(1).to_owned(), depth));
                    length = 3;
                }
                "use" => {
                    length = rest.iter().position(|token| token == ";").unwrap_or(rest.len());
                    let known = imports.names.len();
                    imports.add_tree(&rest[1..length], &scope(&inline), &[]);
                    if inline.is_empty() && at > 0 && tokens[at - 1] == "pub" {
                        imports.exported.extend(imports.names[known..].iter().map(|(name, _)| name.clone()));
                    }
                }
                "crate" | "super" | "self" if is_path && word(1) == "::" => {
                    let words = rest.chunks(2).take_while(|pair| is_word(&pair[0]));
                    let joined = rest.chunks(2).take_while(|pair| pair.get(1).is_some_and(|sign| sign == "::")).count();
                    let path: Path = words.take(joined + 1).map(|pair| pair[0].clone()).collect();
                    length = 2 * path.len() - 1;
                    imports.paths.push(placed(&scope(&inline), path));
                }
                _ => {}
            }
            at += length;
        }
        imports
    }

    /// Takes in a tree of `use`: paths with braces inside.
    fn add_tree(&mut self, tree: &[Token], scope: &[String], prefix: &[String]) {
        let mut depth = 0_usize;
        let branches = tree.split(|token| {
            match token.as_str() {
                "{" => depth += 1,
                "}" => depth = depth.saturating_sub(1),
                _ => {}
            }
            depth == 0 && token == ","
        });
        for branch in branches.filter(|branch| !branch.is_empty()) {
            let head = branch.iter().take_while(|token| *token != "{" && *token != "as");
            let mut path: Path = prefix.iter().chain(head.filter(|token| *token != "::")).cloned().collect();
            if let Some(open) = branch.iter().position(|token| token == "{") {
                self.add_tree(&branch[open + 1..branch.len() - 1], scope, &path);
                continue;
            }
            let is_glob = path.pop_if(|last| last == "*").is_some();
            // `{self}` stands for the module itself.
            if path.len() > 1 {
                path.pop_if(|last| last == "self");
            }
            let name = branch.last().filter(|name| !is_glob && **name != "self").or(path.last()).cloned();
            let path = placed(scope, path);
            if !is_glob {
                self.names.extend(name.map(|name| (name, path.clone())));
            }
            self.paths.push(path);
        }
    }
}

fn is_word(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphanumeric() || c == '_')
}

/// The names of the inline modules.
fn scope(inline: &[(String, usize)]) -> Vec<String> {
    inline.iter().map(|(name, _)| name.clone()).collect()
}

/// A path in inline modules as one in their file: `self` and `super` refer to the innermost.
fn placed(scope: &[String], path: Path) -> Path {
    let mut around = scope.to_vec();
    let mut rest = path.as_slice();
    if around.is_empty() {
        return path;
    }
    match rest.first().map(String::as_str) {
        Some("self") => rest = &rest[1..],
        Some("super") => {
            while rest.first().is_some_and(|word| word == "super") && around.pop().is_some() {
                rest = &rest[1..];
            }
        }
        _ => return path,
    }
    // Further `super` are those of the file.
    let begin = if rest.first().is_some_and(|word| word == "super") { None } else { Some("self".to_owned()) };
    begin.into_iter().chain(around).chain(rest.iter().cloned()).collect()
}

#[test]
fn trees_names_and_inline_modules_are_followed() {
    let (tokens, _) = crate::tokens::product(
        "pub use crate::a::{self, b::{C, D as E}}; use super::f::*; fn g() { crate::h::i(); } mod j { use super::k::L; use super::super::m; }",
    );
    let Imports { paths, names, exported } = Imports::of(&tokens);
    let paths: Vec<String> = paths.iter().map(|path| path.join("::")).collect();
    let expected =
        ["crate::a", "crate::a::b::C", "crate::a::b::D", "super::f", "crate::h::i", "self::k::L", "super::m"];
    assert_eq!(paths, expected);
    let names: Vec<&str> = names.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["a", "C", "E", "L", "m"]);
    assert_eq!(exported, ["a", "C", "E"]);
}
