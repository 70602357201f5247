//! Whole tasks on a phone with a thumb alone: tuning, why a filter is wrong, a map, a record of one's own.

use egui::TouchPhase;
use kalmanscope::theme;

use super::export::exporting;
use super::files::drop_file;
use super::phone::{phone, swipe, tap, touch};
use super::records::{check_result, dialects};
use super::*;

fn reach(screen: &mut Screen, part: egui::Rect, label: &str) {
    let is_in_sight = |screen: &Screen| {
        let rect = screen.query_by_label(label).map(|node| node.rect());
        rect.is_some_and(|rect| part.contains_rect(rect))
    };
    for _ in 0..40 {
        if is_in_sight(screen) {
            break;
        }
        swipe(screen, part.center(), egui::vec2(0.0, -40.0));
    }
    assert!(is_in_sight(screen), "“{label}” cannot be reached");
    tap(screen, label);
}

/// Where a drawer's contents are, and where a menu or a dialog may be.
const DRAWER: egui::Rect = egui::Rect { min: egui::pos2(0.0, 660.0), max: egui::pos2(390.0, 756.0) };
const WINDOW: egui::Rect = egui::Rect { min: egui::pos2(0.0, 50.0), max: egui::pos2(390.0, 844.0) };

fn mistuned() -> Screen {
    let mut screen = phone(PHONE);
    let mut scenario = scenario(&screen).clone();
    scenario.filters[0].sensor_std = vec![0.002, 0.01];
    let session = screen.state_mut().session_mut();
    session.set_scenario(scenario);
    session.set_mode(Mode::Whole);
    screen.run_steps(30);
    screen
}

#[test]
fn a_wrong_filter_is_asked_why_and_cured() {
    let mut screen = mistuned();
    tap(&mut screen, "EKF is overconfident");
    screen.run_steps(120);
    let first = screen.get_by_label_contains("Apply the remedy of EKF").accesskit_node().label().unwrap();
    reach(&mut screen, DRAWER, &first);
    screen.run_steps(60);
    assert!(screen.query_by_label("EKF is overconfident").is_none());
    tap(&mut screen, "Close the diagnosis");
}

#[test]
fn a_map_is_opened_and_a_cell_of_it_taken() {
    let mut screen = mistuned();
    tap(&mut screen, "Views");
    tap(&mut screen, "Experiment");
    screen.run_steps(400);
    let before = scenario(&screen).filters[0].initial_mean[Channel::NATURAL_FREQUENCY];
    let map = screen.get_by_label_contains("Map of EKF").rect();
    assert!(map.width() > 0.6 * PHONE.x && WINDOW.contains_rect(map), "{map}");
    let at = map.left_top() + egui::vec2(0.2, 0.4) * map.size();
    touch(&mut screen, TouchPhase::Start, at);
    touch(&mut screen, TouchPhase::End, at);
    screen.run_steps(20);
    let after = scenario(&screen).filters[0].initial_mean[Channel::NATURAL_FREQUENCY];
    assert!(after < before, "the guess of the cell: {after}");
    tap(&mut screen, "Undo");
    assert_eq!(scenario(&screen).filters[0].initial_mean[Channel::NATURAL_FREQUENCY], before);
}

#[test]
fn a_record_of_ones_own_is_opened_judged_and_reported() {
    let (mut screen, files) = exporting(PHONE);
    theme::expect_fingers(&screen.ctx);
    let (name, bytes) = dialects().into_iter().next().expect("there is one");
    drop_file(&mut screen, name, &bytes);
    screen.run_steps(180);
    check_result(&screen, name);
    tap(&mut screen, "EKF is consistent");
    screen.get_by_label("About Diagnosis");
    tap(&mut screen, "Close the diagnosis");
    tap(&mut screen, "Export");
    reach(&mut screen, WINDOW, "Report (HTML)");
    let report = files.borrow_mut().pop().expect("a file is delivered");
    assert_eq!(report.name, "report.html");
}
