//! Links, and broken links.

use kalmanscope_lessons::{BUILT_IN, EQUATIONS};

use super::*;
use crate::kinds::{Arrangement, ViewKind};
use crate::layout::{Outline, ViewLayout};
use crate::session::Mode;

fn picture() -> SavedPicture {
    let scenario = BUILT_IN[0].scenario().expect("it is valid");
    SavedPicture::new(scenario, &ViewLayout::of(Arrangement::Compare), Mode::Whole, 12.34)
}

fn text() -> String {
    picture().line().expect("it can be written")
}

fn read(fragment: &str) -> Result<SavedPicture, LinkError> {
    SavedPicture::read(fragment.strip_prefix(MARK).expect("it is a link"))
}

#[test]
fn a_link_gives_its_picture_back_and_fits_into_a_letter() {
    for built_in in BUILT_IN.iter().chain(EQUATIONS) {
        let scenario = built_in.scenario().expect("it is valid");
        let picture = SavedPicture { scenario, ..picture() };
        let fragment = picture.fragment().expect("it is short");
        println!("{:>4} characters: {}", fragment.len(), built_in.file);
        assert_eq!(read(&fragment).expect("it is whole"), picture, "{}", built_in.file);
        assert!(fragment.len() < 1000, "{}: {fragment}", built_in.file);
        let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"#=.-_".contains(&byte);
        assert!(fragment.bytes().all(is_plain), "mail programs end a link at other characters: {fragment}");
    }
}

#[test]
fn every_damage_is_found() {
    let fragment = picture().fragment().expect("it is short");
    let link = fragment.strip_prefix(MARK).expect("it is a link");
    for end in 0..link.len() {
        assert!(SavedPicture::read(&link[..end]).is_err(), "cut after {end}");
    }
    for place in 0..link.len() {
        let mut changed = link.as_bytes().to_vec();
        changed[place] = if changed[place] == b'b' { b'c' } else { b'b' };
        let changed = String::from_utf8(changed).expect("it is ASCII");
        assert!(SavedPicture::read(&changed).is_err(), "changed at {place}");
    }
    for text in ["", ".", "1", "1.", "1.A", "x.AAAA", "-1.AAAA", "0.AAAA", "1.AA=", "1.ä", "99999999999999999999.A"] {
        assert!(matches!(SavedPicture::read(text), Err(LinkError::Damaged)), "{text}");
    }
    let newer = SavedPicture::read("2.anything").expect_err("it is newer").to_string();
    assert_eq!(newer, "it is of version 2, and this program reads links of version 1");
}

#[test]
fn the_size_is_bounded_before_and_while_decoding() {
    let error = SavedPicture::read(&"A".repeat(LONGEST + 1)).expect_err("it is too long");
    assert!(matches!(error, LinkError::TooLong(characters) if characters == LONGEST + 1));
    // Zeros are packed a thousandfold.
    for size in [60_000, 70_000, 10_000_000] {
        let bomb = packed(&format!("{}{}", text(), " ".repeat(size)));
        assert!(bomb.len() < LONGEST, "{size}: {}", bomb.len());
        let is_read = SavedPicture::read(&bomb).is_ok();
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
fn tiles_of_every_kind_keep_their_places() {
    use Outline::{Columns, Grid, Rows, Tabs, View};
    let kinds = ViewKind::ALL.map(View);
    let [a, b, c, d, e, f, ..] = kinds;
    let outline =
        Rows(vec![(0.25, Columns(vec![(3.0, a), (1.5, b)])), (1.0, Tabs(1, vec![c, d])), (2.0, Grid(vec![e, f]))]);
    let picture = SavedPicture { views: Some(outline), ..picture() };
    let layout = picture.layout();
    assert_eq!(Outline::of(layout.tree()), picture.views);
    assert_eq!(read(&picture.fragment().expect("it is short")).expect("it is whole"), picture);
}
