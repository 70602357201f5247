//! Links that programs have written, and broken links.

use kalmanscope_core::Quantity;
use kalmanscope_lab::tune::Goal;
use kalmanscope_lessons::{BUILT_IN, EQUATIONS};

use super::*;
use crate::laboratory::TuneChoice;
use crate::request::{Arrangement, LegendEntry, ViewKind};

fn picture() -> Picture {
    let scenario = BUILT_IN[0].scenario().expect("it is valid");
    Picture::new(scenario, &Layout::of(Arrangement::Compare), Mode::Whole, 12.34)
}

/// The link of a text, with the check that belongs to it.
fn link(text: &str) -> String {
    format!("{VERSION}.{}", base64url::encode(&packed::pack(text)))
}

/// The two parts of a picture's text.
fn text() -> (String, String) {
    let fragment = picture().fragment().expect("it is short");
    let (_, data) = fragment.split_once("1.").expect("it has a version");
    let text = packed::unpack(&base64url::decode(data).expect("it is base64url")).expect("it is packed");
    let (screen, scenario) = text.split_once('\n').expect("it has two parts");
    (screen.to_owned(), scenario.to_owned())
}

fn read(fragment: &str) -> Result<Picture, LinkError> {
    Picture::read(fragment.strip_prefix(MARK).expect("it is a link"))
}

#[test]
fn a_link_gives_its_picture_back_and_fits_into_a_letter() {
    for built_in in BUILT_IN.iter().chain(EQUATIONS) {
        let scenario = built_in.scenario().expect("it is valid");
        let picture = Picture { scenario, ..picture() };
        let fragment = picture.fragment().expect("it is short");
        println!("{:>4} characters: {}", fragment.len(), built_in.file);
        assert_eq!(read(&fragment).expect("it is whole"), picture, "{}", built_in.file);
        assert!(fragment.len() < 1000, "{}: {fragment}", built_in.file);
        let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"#=.-_".contains(&byte);
        assert!(fragment.bytes().all(is_plain), "mail programs end a link at other characters: {fragment}");
    }
}

/// A link of the first version, from a program of November 2026: whoever changes the format has to read it as before.
#[test]
fn an_old_link_can_be_read() {
    let picture = read(include_str!("old-link.txt").trim_end()).expect("it is whole");
    let views = Outline::Rows(vec![
        (0.5, Outline::View(ViewKind::Parameters)),
        (1.5, Outline::Columns(vec![(1.0, Outline::View(ViewKind::Scores)), (2.0, Outline::View(ViewKind::States))])),
    ]);
    assert_eq!((picture.mode, picture.time, picture.enlarged), (Mode::Live, 7.25, Some(ViewKind::Scores)));
    assert_eq!((picture.views, picture.scenario.seed), (Some(views), 2026));
    assert_eq!(picture.scenario.filters[0].fading, 1.0375);
    let rest = (picture.speed, picture.ruler, picture.hidden);
    assert_eq!(rest, (Session::DEFAULT_SPEED, Ruler::default(), Vec::new()), "it says nothing of these");
}

#[test]
fn marks_speed_and_hidden_entries_come_along_and_cost_nothing_where_they_are_not_used() {
    let plain = picture();
    let (screen, _) = text();
    assert!(["speed", "marks", "hidden"].iter().all(|field| !screen.contains(field)), "{screen}");
    let mut ruler = Ruler::default();
    ruler.place(crate::ruler::End::B, 2.5);
    let hidden = vec![LegendEntry::Truth, LegendEntry::Verdicts, LegendEntry::Filter(2)];
    let marked = Picture { speed: 0.25, ruler, hidden, ..plain };
    assert_eq!(read(&marked.fragment().expect("it is short")).expect("it is whole"), marked);
}

#[test]
fn the_choices_of_the_laboratory_come_along_and_impossible_ones_are_told() {
    let mut plain = picture();
    plain.scenario.number_filters();
    let usual = TuneChoice::usual(&plain.scenario, None).expect("there is a filter");
    for goal in [Goal::Likelihood, Goal::Consistency, Goal::FreeRun(Quantity::DISPLACEMENT)] {
        let laboratory = Choices { tuning: Some(TuneChoice { goal, ..usual.clone() }), ..Choices::default() };
        let tuned = Picture { laboratory, ..plain.clone() };
        let fragment = tuned.fragment().expect("it is short");
        assert_eq!(read(&fragment).expect("it is whole").laboratory, tuned.laboratory);
    }
    let laboratory = Choices { tuning: Some(TuneChoice { filter: 99, ..usual }), ..Choices::default() };
    let wrong = Picture { laboratory, ..plain }.fragment().expect("it is short");
    assert!(read(&wrong).unwrap_err().to_string().contains("Tune for me: it is about filter number 99"));
}

#[test]
fn every_damage_is_found() {
    let fragment = picture().fragment().expect("it is short");
    let link = fragment.strip_prefix(MARK).expect("it is a link");
    for end in 0..link.len() {
        assert!(Picture::read(&link[..end]).is_err(), "cut after {end}");
    }
    for place in 0..link.len() {
        let mut changed = link.as_bytes().to_vec();
        changed[place] = if changed[place] == b'b' { b'c' } else { b'b' };
        let changed = String::from_utf8(changed).expect("it is ASCII");
        assert!(Picture::read(&changed).is_err(), "changed at {place}");
    }
    for text in ["", ".", "1", "1.", "1.A", "x.AAAA", "-1.AAAA", "0.AAAA", "1.AA=", "1.ä", "99999999999999999999.A"] {
        assert!(matches!(Picture::read(text), Err(LinkError::Damaged)), "{text}");
    }
}

#[test]
fn a_newer_link_is_told_apart_from_a_damaged_one() {
    let error = Picture::read("2.anything").expect_err("it is newer").to_string();
    assert_eq!(error, "it is of version 2, and this program reads links up to version 1");
}

#[test]
fn the_size_is_bounded_before_and_while_decoding() {
    let error = Picture::read(&"A".repeat(LONGEST + 1)).expect_err("it is too long");
    assert!(matches!(error, LinkError::TooLong(characters) if characters == LONGEST + 1));
    // Zeros are packed a thousandfold.
    let (screen, _) = text();
    for size in [60_000, 70_000, 10_000_000] {
        let bomb = link(&format!("{screen}\n#{}\n", "0".repeat(size)));
        assert!(bomb.len() < LONGEST, "{size}: {}", bomb.len());
        let is_read = Picture::read(&bomb).is_ok();
        assert_eq!(is_read, size == 60_000, "{size} bytes, with limit 65536");
    }
}

#[test]
fn a_long_scenario_has_no_link() {
    let mut long = picture();
    // Names that do not compress.
    for (place, filter) in long.scenario.filters.iter_mut().enumerate() {
        let mut state = place as u64 + 1;
        filter.name = (0..20_000)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                char::from(b'a' + ((state >> 33) % 26) as u8)
            })
            .collect();
    }
    assert!(matches!(long.fragment(), Err(LinkError::TooLong(_))));
}

#[test]
fn impossible_pictures_are_refused_with_their_reason() {
    let (screen, scenario) = text();
    let nested = |depth: usize| {
        let view = r#"{"view":"States"}"#.to_owned();
        let views = (0..depth).fold(view, |inner, _| format!(r#"{{"rows":[[1.0,{inner}]]}}"#));
        format!(r#"{{"views":{views},"mode":"Live","time":1}}"#)
    };
    let views = |views: &str| format!(r#"{{"views":{views},"mode":"Live","time":1}}"#);
    let good = |screen: &str| Picture::read(&link(&format!("{screen}\n{scenario}")));
    assert!(good(&screen).is_ok() && good(&nested(10)).is_ok() && good(&views("null")).is_ok());
    for (screen, reason) in [
        (views(r#"{"rows":[[1.0,{"view":"States"}],[1.0,{"view":"States"}]]}"#), "States is there twice"),
        (views(r#"{"rows":[]}"#), "a container is empty"),
        (views(r#"{"rows":[[-1.0,{"view":"States"}]]}"#), "a share is -1"),
        (views(r#"{"rows":[[1e300,{"view":"States"}]]}"#), "a share is inf"),
        (views(r#"{"view":"Nothing"}"#), "unknown variant `Nothing`"),
        (nested(20), "containers are inside each other"),
        (nested(1000), "recursion limit"),
        (screen.replace("12.34", "-1"), "the time is -1"),
        (screen.replace("12.34", "1e999"), "number out of range"),
        (screen.replace("12.34", "1,\"speed\":-1"), "the speed is -1"),
        (screen.replace("12.34", "1,\"marks\":[1,2,3]"), "`marks`: invalid length 3"),
        (screen.replace("12.34", "1,\"hidden\":[\"all\"]"), "unknown variant `all`"),
        (screen.replace("12.34", "1,\"enlarged\":\"Phase\""), "enlarged is not shown"),
        (screen.replace("12.34", "1,\"more\":1"), "unknown field `more`"),
    ] {
        let error = good(&screen).expect_err(&screen).to_string();
        assert!(error.contains(reason) && !error.contains('\n'), "{screen}: {error}");
    }
    for (from, to, reason) in
        [("dt = 0.01", "dt = -1.0", "`dt` is -1"), ("seed", "need", "unknown field `need`"), ("seed", "[", "TOML")]
    {
        let text = format!("{screen}\n{}", scenario.replacen(from, to, 1));
        let error = Picture::read(&link(&text)).expect_err(to).to_string();
        assert!(error.contains(reason), "{to}: {error}");
    }
}

#[test]
fn tiles_of_every_kind_keep_their_places() {
    use Outline::{Columns, Grid, Rows, Tabs, View};
    let kinds = ViewKind::ALL.map(View);
    let [a, b, c, d, e, f, ..] = kinds;
    let outline =
        Rows(vec![(0.25, Columns(vec![(3.0, a), (1.5, b)])), (1.0, Tabs(1, vec![c, d])), (2.0, Grid(vec![e, f]))]);
    let picture = Picture { views: Some(outline), ..picture() };
    let layout = picture.layout();
    assert_eq!(Outline::of(layout.tree()), picture.views);
    assert_eq!(read(&picture.fragment().expect("it is short")).expect("it is whole"), picture);
}

#[test]
fn base64url_is_that_of_the_standard() {
    // RFC 4648, section 10, with the digits of section 5.
    for (bytes, text) in
        [("", ""), ("f", "Zg"), ("fo", "Zm8"), ("foo", "Zm9v"), ("foob", "Zm9vYg"), ("fooba", "Zm9vYmE")]
    {
        assert_eq!(base64url::encode(bytes.as_bytes()), text);
        assert_eq!(base64url::decode(text).as_deref(), Some(bytes.as_bytes()));
    }
    assert_eq!(base64url::encode(&[0xfb, 0xff]), "-_8");
    for text in ["Z", "Zh", "Zg==", "Zm9v+", "Zm 9"] {
        assert_eq!(base64url::decode(text), None, "{text}");
    }
}
