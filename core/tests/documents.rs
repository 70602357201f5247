//! Documents as TOML, JSON and values of types.

use std::collections::BTreeMap;

use kalmanscope_core::Scenario;
use kalmanscope_core::document::*;
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
enum Shape {
    Point,
    Circle(f64),
    Segment(f64, f64),
    Box { width: f32, height: Option<f32> },
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Length(u8);

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Everything {
    flag: bool,
    count: u64,
    balance: i32,
    ratio: f32,
    number: f64,
    word: String,
    missing: Option<f64>,
    length: Length,
    pair: (f64, bool),
    shapes: Vec<Shape>,
    by_place: BTreeMap<u16, Shape>,
    by_level: BTreeMap<i8, f64>,
}

fn everything() -> Everything {
    let shapes = [
        Shape::Point,
        Shape::Circle(0.1),
        Shape::Segment(-1e300, 5e-324),
        Shape::Box { width: 0.1, height: None },
        Shape::Box { width: 1e-7, height: Some(3.0) },
    ];
    Everything {
        flag: true,
        count: u64::MAX,
        balance: -7,
        ratio: 0.3,
        number: 0.3,
        word: "ωₙ \"quoted\"\n".to_owned(),
        missing: None,
        length: Length(200),
        pair: (-0.0, false),
        by_place: (1..).zip(shapes.clone()).collect(),
        by_level: [(-2, 1.0), (3, f64::MAX)].into(),
        shapes: shapes.to_vec(),
    }
}

#[test]
fn what_is_written_is_read_back() {
    let value = everything();
    assert_eq!(read::<Everything>(&of(&value).unwrap()).unwrap(), value);
    assert_eq!(read_json::<Everything>(&to_json(&value).unwrap()).unwrap(), value);
    assert_eq!(to_json(&[f64::NAN, 1.0]).unwrap(), "[null,1.0]");
    let of_toml = Everything { count: i64::MAX as u64, by_place: BTreeMap::new(), by_level: BTreeMap::new(), ..value };
    assert_eq!(read_toml::<Everything>(&to_toml(&of_toml).unwrap()).unwrap(), of_toml);
    assert!(to_toml(&Everything { count: u64::MAX, ..of_toml }).is_err(), "TOML has no such integer");
}

#[test]
fn a_document_keeps_its_format_s_values() {
    let text = r#"{"b":[null,true,-1,18446744073709551615,1.5],"a":{"x":"y"}}"#;
    assert_eq!(to_json(&from_json(text).unwrap()).unwrap(), text);
    assert_eq!(to_json_lines(&json!({ "b": 1, "a": 2 })).unwrap(), "{\n  \"b\": 1,\n  \"a\": 2\n}");
    let scenario = Scenario::default();
    assert_eq!(to_json(&scenario).unwrap(), serde_json::to_string(&scenario).unwrap());
}

#[test]
fn values_are_put_at_paths() {
    let mut document = json!({ "a": { "b": [1, 2] }, "x/y": { "z": 3 } });
    assert!(put(&mut document, "a.b.1", &json!(5)) && put(&mut document, "a.c", &json!(true)));
    assert!(put(&mut document, "x/y.z", &Document::Null) && put(&mut document, "new", &json!("w")));
    assert_eq!(document, json!({ "a": { "b": [1, 5], "c": true }, "x/y": {}, "new": "w" }));
    for path in ["a.b.2", "a.b.x", "a.d.e", "new.w", "a.b.0.c"] {
        assert!(!put(&mut document, path, &json!(1)), "{path}");
    }
}

#[test]
fn errors_name_the_path_and_the_line() {
    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields, expecting = "a table")]
    #[expect(dead_code, reason = "only errors are looked at")]
    struct Outer {
        shapes: Option<Vec<Shape>>,
        all: Option<Box<Everything>>,
        pair: Option<[f64; 2]>,
        by_place: Option<BTreeMap<u16, f64>>,
        within: Option<Box<Outer>>,
    }
    let cube = "line 1: `shapes[0]`: unknown variant `Cube`, expected one of `Point`, `Circle`, `Segment`, `Box`";
    let integer = "invalid type: integer";
    let word = "expected a word, or a table with exactly one key";
    for (text, expected) in [
        (
            "\nzzz = 1",
            "line 2: `zzz`: unknown field `zzz`, expected one of `shapes`, `all`, `pair`, `by_place`, `within`",
        ),
        (
            "[within]\n[within.within]\nwithin = 3",
            "line 3: `within.within.within`: invalid type: integer `3`, expected a table",
        ),
        (
            "[within.within]\nshapes = [\n'Point',\n3]",
            &format!("line 4: `within.within.shapes[1]`: {integer} `3`, {word}"),
        ),
        ("shapes = [{ Circle = 'x' }]", "line 1: `shapes[0].Circle`: invalid type: string \"x\", expected f64"),
        (
            "shapes = [{ Circle = 1, Point = {} }]",
            "line 1: `shapes[0]`: invalid value: map, expected a table with exactly one key",
        ),
        ("shapes = [{ Point = 1 }]", "line 1: `shapes[0].Point`: invalid type: integer `1`, expected unit"),
        ("shapes = ['Circle']", "line 1: `shapes[0].Circle`: invalid type: unit variant, expected newtype variant"),
        ("shapes = ['Cube']", cube),
        ("shapes = [{ Cube = 1 }]", cube),
        (
            "shapes = [{ Box = { width = 1, depth = 2 } }]",
            "line 1: `shapes[0].Box.depth`: unknown field `depth`, expected `width` or `height`",
        ),
        ("shapes = [{ Box = [1, 2] }]", "line 1: `shapes[0].Box`: invalid type: sequence, expected struct variant"),
        ("within = [[1]]", &format!("line 1: `within[0][0]`: {integer} `1`, {word}")),
        ("pair = [1, 2, 3]", "line 1: `pair`: invalid length 3, expected fewer elements in array"),
        ("pair = [1]", "line 1: `pair`: invalid length 1, expected an array of length 2"),
        (
            "[by_place]\n1 = 2\n70000 = 1",
            "line 3: `by_place.70000`: invalid value: integer `70000`, expected u16 at line 1 column 5",
        ),
        ("[by_place]\nx = 1", "line 1: `by_place`: invalid value: expected key to be a number in quotes"),
        ("\n[all]\nflag = true", "line 2: `all`: missing field `count`"),
    ] {
        assert_eq!(read_toml::<Outer>(text).unwrap_err().to_string(), expected, "{text}");
    }
    let whole = |text| read_toml::<Everything>(text).unwrap_err().to_string();
    assert_eq!(whole(""), "line 1: `.`: missing field `flag`");
    assert_eq!(whole("a = "), ::toml::from_str::<Everything>("a = ").unwrap_err().to_string().trim_end());
    let json = |text| read_json::<Outer>(text).unwrap_err().to_string();
    assert_eq!(json(r#"{"pair":[1,null]}"#), "`pair[1]`: invalid type: null, expected f64");
    assert_eq!(json("{"), "EOF while parsing an object at line 1 column 1");
}
