//! The text of a picture, and impossible texts.

use serde_json::{Value, json};

use super::*;
use crate::laboratory::SeedChoice;
use crate::request::Arrangement;
use crate::ruler::RulerEnd;

fn picture() -> SavedPicture {
    let mut scenario = Scenario { seed: 5, ..Scenario::default() };
    scenario.number_filters();
    let mut picture = SavedPicture::new(scenario, &ViewLayout::of(Arrangement::Compare), Mode::Whole, 7.25);
    picture.ruler.place(RulerEnd::A, 1.5);
    picture.hidden = vec![LegendEntry::Truth, LegendEntry::Filter(picture.scenario.filters[1].id)];
    picture.enlarged = Some(ViewKind::Scores);
    picture.laboratory.seeds = Some(SeedChoice::default());
    let habits = Habits { presenting: true, dark: Some(false), all_settings: true, ..Habits::default() };
    SavedPicture { speed: 0.25, habits: Some(habits), ..picture }
}

fn text() -> Value {
    serde_json::from_str(&picture().lines().expect("it can be written")).expect("it is JSON")
}

fn read(text: &Value) -> Result<SavedPicture, String> {
    let text = text.to_string();
    let read = SavedPicture::of_text(&text).map_err(|error| error.to_string());
    let file = SavedPicture::of_file(text.as_bytes()).map(|read| read.map_err(|error| error.to_string()));
    assert!(file.is_none_or(|file| file == read), "a file is read as any text");
    read
}

#[test]
fn all_comes_back_from_a_line_from_lines_and_from_a_link() {
    let picture = picture();
    assert_eq!(read(&text()), Ok(picture.clone()));
    let line = picture.line().expect("it can be written");
    assert!(!line.contains('\n'));
    assert_eq!(SavedPicture::of_text(&line).expect("it can be read"), picture);
    let fragment = picture.fragment().expect("it is short");
    let link = fragment.strip_prefix(crate::share::MARK).expect("it is a link");
    assert_eq!(SavedPicture::read(link).expect("it can be read"), picture);
}

#[test]
fn usual_values_need_no_keys_and_missing_keys_have_usual_values() {
    let usual: Value = serde_json::from_str(&SavedPicture::default().line().expect("it can be written")).expect("JSON");
    let keys: Vec<&String> = usual.as_object().expect("it is an object").keys().collect();
    assert_eq!(keys, ["kalmanscope_session", "scenario", "views", "mode"]);
    assert_eq!(read(&json!({ "kalmanscope_session": 1 })), Ok(SavedPicture::default()));
    let nothing = SavedPicture { views: None, ..SavedPicture::default() };
    assert_eq!(SavedPicture::of_text(&nothing.line().expect("it can be written")).expect("it can be read"), nothing);
}

#[test]
fn impossible_texts_are_refused_in_one_sentence() {
    let with = |pointer: &str, value: Value| {
        let mut text = text();
        let (place, key) = pointer.rsplit_once('/').expect("it is a pointer");
        text.pointer_mut(place).expect("it is there").as_object_mut().expect("a table").insert(key.to_owned(), value);
        text
    };
    let deep = |depth: usize| (0..depth).fold(json!({ "view": "States" }), |inner, _| json!({ "tabs": [0, [inner]] }));
    // Without an enlarged view, which would not be among those.
    let of_views = |views: serde_json::Value| {
        let mut text = with("/views", views);
        text.as_object_mut().expect("a table").remove("enlarged");
        text
    };
    let nested = of_views(deep(20));
    let wide = of_views(json!({ "rows": [[1e38, { "view": "States" }]] }));
    let empty = of_views(json!({ "rows": [] }));
    for (text, reason) in [
        (with("/kalmanscope_session", 3.into()), "it has format 3, and this program reads format 1"),
        (with("/kalmanscope_session", "two".into()), "it has format \"two\""),
        (with("/more", 1.into()), "unknown field `more`"),
        (with("/habits/more", 1.into()), "unknown field `more`"),
        (with("/habits/lessons", json!({ "more": 1 })), "unknown field `more`"),
        (with("/laboratory/more", 1.into()), "unknown field `more`"),
        (with("/marks", json!([1, 2, 3])), "`marks`: invalid length 3"),
        (with("/hidden", json!(["all"])), "unknown variant `all`"),
        (of_views(json!({ "view": "Nothing" })), "unknown variant `Nothing`"),
        (of_views(json!({ "grid": [{ "view": "States" }, { "view": "States" }] })), "States is there twice"),
        (nested, "more than 16 containers"),
        (wide, "a share is 1"),
        (empty, "a container is empty"),
        (with("/enlarged", "Phase".into()), "enlarged is not shown"),
        (with("/mode", "Sideways".into()), "unknown variant `Sideways`"),
        (with("/time", (-1).into()), "the time is -1"),
        (with("/speed", 0.into()), "the speed is 0"),
        (with("/scenario", "dt = -1".into()), "`dt` is -1"),
        (with("/scenario", "need = 1".into()), "unknown field `need`"),
        (with("/scenario", 5.into()), "`scenario`: "),
        (json!({}), "it has no key `kalmanscope_session`"),
        (json!([1]), "it has no key"),
    ] {
        let refused = read(&text).expect_err(reason);
        assert!(refused.contains(reason) && !refused.contains('\n'), "{refused}, not {reason}");
    }
}

#[test]
fn other_files_are_no_pictures() {
    for bytes in ["t,x\n0,1\n", "{}", "{\"a\":1}", "[1]", "{", ""] {
        assert!(SavedPicture::of_file(bytes.as_bytes()).is_none(), "{bytes}");
    }
    // So deep that not even the text is read.
    let views = format!("{}null{}", r#"{"tabs":[0,["#.repeat(20_000), "]]}".repeat(20_000));
    let deep = text().to_string().replace(&text()["views"].to_string(), &views);
    assert!(deep.len() > 200_000 && SavedPicture::of_file(deep.as_bytes()).is_none());
}
