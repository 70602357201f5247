//! The public items that a source writes down. Those that a macro makes are not seen.

use crate::tokens::Token;

/// A public item: its name, and `fn`, `struct`, ….
pub(crate) type Item = (String, String);

/// The public items of a module.
#[derive(Default)]
pub(crate) struct Items {
    /// Those of the module itself.
    pub(crate) own: Vec<Item>,
    /// Those of its types and traits, by their names here.
    pub(crate) members: Vec<(String, Item)>,
}

/// The body of braces around a place.
#[derive(Clone, PartialEq)]
enum Body {
    /// Of a type's `impl`, with the name of the type.
    Type(String),
    /// Of a public trait, with its name.
    Trait(String),
    Other,
}

impl Items {
    /// The public items of a module with these tokens.
    pub(crate) fn of(tokens: &[Token]) -> Self {
        let mut items = Self::default();
        let mut bodies: Vec<Body> = Vec::new();
        // That of the next brace.
        let mut next = Body::Other;
        for at in 0..tokens.len() {
            match (tokens[at].as_str(), bodies.as_slice()) {
                ("{", _) => bodies.push(std::mem::replace(&mut next, Body::Other)),
                ("}", _) => drop(bodies.pop()),
                ("impl", []) if begins_item(tokens, at) => next = implemented(&tokens[at + 1..]),
                ("pub", []) => {
                    if let Some((name, kind)) = declared(&tokens[at + 1..]) {
                        if kind == "trait" {
                            next = Body::Trait(name.clone());
                        }
                        items.own.push((name, kind));
                    }
                }
                ("pub", [Body::Type(name)]) => {
                    items.members.extend(declared(&tokens[at + 1..]).map(|item| (name.clone(), item)));
                }
                ("fn" | "const" | "type", [Body::Trait(name)]) if begins_item(tokens, at) => {
                    items.members.extend(declared(&tokens[at..]).map(|item| (name.clone(), item)));
                }
                _ => {}
            }
        }
        items
    }
}

/// Whether an item, with its attributes, may begin at a place.
fn begins_item(tokens: &[Token], at: usize) -> bool {
    at == 0 || [";", "{", "}", "]", "unsafe"].contains(&tokens[at - 1].as_str())
}

/// The item that these tokens begin with, its visibility left out.
fn declared(tokens: &[Token]) -> Option<Item> {
    const KINDS: [&str; 9] = ["const", "enum", "fn", "mod", "static", "struct", "trait", "type", "union"];
    let is_function = |at: usize| tokens.get(at + 1).is_some_and(|next| ["fn", "unsafe", "async"].contains(&&**next));
    let begin = (0..tokens.len()).find(|at| !["unsafe", "async"].contains(&&*tokens[*at]) && !is_function(*at))?;
    let kind = KINDS.iter().find(|kind| **kind == tokens[begin])?;
    let name = tokens.get(begin + 1).filter(|name| name.starts_with(|c: char| c.is_alphabetic()))?;
    Some((name.clone(), (*kind).to_owned()))
}

/// The body of an `impl`, from the tokens behind this word.
fn implemented(tokens: &[Token]) -> Body {
    let (mut depth, mut name) = (0_usize, None);
    for (at, token) in tokens.iter().enumerate() {
        match token.as_str() {
            "<" => depth += 1,
            ">" if tokens[at - 1] != "-" => depth = depth.saturating_sub(1),
            "for" if depth == 0 => return Body::Other,
            "{" | "where" if depth == 0 => break,
            word if depth == 0 && word.starts_with(|c: char| c.is_alphabetic()) => name = Some(word.to_owned()),
            _ => {}
        }
    }
    name.map_or(Body::Other, Body::Type)
}

#[test]
fn public_items_and_members_are_found() {
    let (tokens, _) = crate::tokens::product(
        "pub struct A<T> { pub a: T } impl<T: Fn(u8) -> u8> A<T> { pub const fn b() { pub fn no() {} } fn no() {} pub const C: u8 = 0; } \
         impl D for A { pub fn no() {} } #[doc(hidden)] pub trait E { fn f(); } pub(crate) fn no() {} mod no {} pub mod g;",
    );
    let Items { own, members } = Items::of(&tokens);
    let own: Vec<String> = own.iter().map(|(name, kind)| format!("{kind} {name}")).collect();
    assert_eq!(own, ["struct A", "trait E", "mod g"]);
    let members: Vec<String> = members.iter().map(|(of, (name, kind))| format!("{kind} {of}::{name}")).collect();
    assert_eq!(members, ["fn A::b", "const A::C", "fn E::f"]);
}
