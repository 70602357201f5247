//! A phone: fingers are expected from the first frame, a swipe on a lesson leaves the plots in sight, and menus scroll.

use std::path::Path;
use std::time::Duration;

use crate::page::Page;

/// The size of the window \[CSS pixels\].
const SIZE: (u32, u32) = (390, 844);

/// The share of the window that a lesson leaves to the plots.
const FOR_PLOTS: f64 = 0.45;

/// The height of what a finger presses \[CSS pixels\].
const FINGER: f64 = 39.5;

/// Opens the page as a phone does.
pub(crate) async fn opens(page: &Page, address: &str) {
    page.become_phone(SIZE).await;
    page.go(address).await;
    let over = "!document.getElementById('loading') || !document.getElementById('failure').hidden";
    page.wait_until(over, Duration::from_secs(60)).await.expect("the page starts");
    assert_eq!(page.value("matchMedia('(pointer: coarse)').matches").await, true, "fingers point here");
    page.settle().await;
}

/// The first touch moves nothing: what is pressed has the size of a finger before it.
pub(crate) async fn fingers_are_expected(page: &Page, picture: &Path) {
    const CONTROLS: [&str; 5] = ["Settings", "Scenario", "Views", "Lessons", "Restart"];
    let mut before = Vec::new();
    for control in CONTROLS {
        before.push(page.rect(control).await);
    }
    assert!(before[4].height >= FINGER, "{before:?}");
    std::fs::write(picture, page.screenshot().await).expect("a picture can be written");
    page.touch((195.0, 830.0), (195.0, 830.0)).await;
    for (control, before) in CONTROLS.into_iter().zip(before) {
        assert_eq!(page.rect(control).await, before, "{control} has moved");
    }
}

/// A swipe on a lesson's text leaves the plots their room.
pub(crate) async fn a_lesson_leaves_the_plots_their_room(page: &Page, picture: &Path) {
    page.tap("First lesson").await;
    let before = page.rect("Handle of the lesson").await;
    let bar = page.rect("Scenario").await;
    let between = before.y - (bar.y + bar.height);
    assert!(between >= FOR_PLOTS * f64::from(SIZE.1), "{between} points between bar and lesson");
    let at = (150.0, before.y + 100.0);
    for way in [-250.0, -250.0, 150.0] {
        page.touch(at, (at.0, at.1 + way)).await;
        assert_eq!(page.rect("Handle of the lesson").await, before, "after a swipe by {way}");
    }
    std::fs::write(picture, page.screenshot().await).expect("a picture can be written");
}

/// The last view of the menu is reached by a swipe.
pub(crate) async fn the_menu_of_views_scrolls(page: &Page, picture: &Path) {
    page.tap("Views").await;
    let button = page.rect("Views").await;
    let last = "Tune for me";
    for _ in 0..6 {
        page.touch((button.x + 40.0, 700.0), (button.x + 40.0, 350.0)).await;
    }
    std::fs::write(picture, page.screenshot().await).expect("a picture can be written");
    let rect = page.rect(last).await;
    assert!(rect.y > button.y + button.height && rect.y + rect.height <= f64::from(SIZE.1), "{rect:?}");
    page.tap(last).await;
    page.tap("Views").await;
    page.settle().await;
}
