//! Every view at any size, with and without contents.

use super::*;

const SIZES: [Vec2; 6] =
    [DESKTOP, PHONE, Vec2::new(1920.0, 1080.0), Vec2::new(200.0, 120.0), Vec2::new(1.0, 1.0), Vec2::ZERO];

#[test]
fn plots_of_the_first_arrangement_have_room_at_any_size() {
    for size in SIZES {
        for theme in [Theme::Light, Theme::Dark] {
            for mode in [Mode::Live, Mode::Whole] {
                let mut screen = screen(size, theme);
                screen.state_mut().session_mut().set_mode(mode);
                screen.state_mut().session_mut().seek(31.0);
                screen.run_steps(5);
                if size.min_elem() > 300.0 {
                    for plot in PlantKind::SDOF.channels() {
                        let name = format!("Plot of the {}", plot.name());
                        let rect = screen.get_by_label(&name).rect();
                        assert!(rect.width() > 250.0 && rect.height() > 80.0, "{name} has only {rect} of {size}");
                        // Where they are in one column, they scroll with the story above them.
                        let is_in_column = size.x < 720.0;
                        assert!(
                            rect.right() <= size.x && (is_in_column || rect.bottom() <= size.y),
                            "{name} is cut off: {rect} of {size}"
                        );
                    }
                }
            }
        }
    }
}

fn scenarios() -> [Scenario; 4] {
    let usual = Scenario { duration: 10.0, ..Scenario::default() };
    let unmeasured = {
        let mut unmeasured = usual.clone();
        Quantity::all().iter().for_each(|&quantity| unmeasured.remove_sensor(quantity));
        unmeasured
    };
    let without_filters = Scenario { filters: Vec::new(), ..usual.clone() };
    let empty = Scenario { filters: Vec::new(), duration: usual.dt, ..unmeasured.clone() };
    [usual, unmeasured, without_filters, empty]
}

#[test]
fn five_frames_of_every_view_at_any_size() {
    for (size, theme) in SIZES.into_iter().zip([Theme::Light, Theme::Dark].into_iter().cycle()) {
        let mut screen = screen(size, theme);
        for (scenario, mode) in scenarios().into_iter().zip([Mode::Whole, Mode::Live].into_iter().cycle()) {
            let session = screen.state_mut().session_mut();
            session.set_scenario(scenario);
            session.set_mode(mode);
            session.pause();
            session.seek(5.0);
            for kind in ViewKind::ALL {
                show(&mut screen, &[kind]);
                let about = format!("About {}", view(kind).name);
                let has_room = size.min_elem() > 300.0;
                assert!(!has_room || screen.query_by_label(&about).is_some(), "{kind:?} at {size}");
            }
        }
    }
}

#[test]
fn a_stopped_filter_says_so_and_the_rest_goes_on() {
    let mut screen = workbench();
    let mut wild = Scenario::default();
    wild.filters[0].fading = 1e100;
    screen.state_mut().session_mut().set_scenario(wild);
    screen.state_mut().session_mut().set_mode(Mode::Whole);
    screen.run_steps(3);
    assert!(screen.query_by_label_contains("EKF stopped at").is_some());
    assert_eq!(screen.state().session().run().estimates()[1].len(), 6001);
}

#[test]
fn a_simulation_without_a_sample_leaves_every_view_standing() {
    let mut screen = workbench();
    let mut endless = Scenario { force: Force::ImpulseTrain { impulse: -1e308, period: 0.5 }, ..Scenario::default() };
    endless.filters.clear();
    let session = screen.state_mut().session_mut();
    session.set_scenario(endless);
    session.set_mode(Mode::Whole);
    for kind in ViewKind::ALL {
        show(&mut screen, &[kind]);
        assert!(screen.query_by_label(&format!("About {}", view(kind).name)).is_some(), "{kind:?}");
    }
}

#[test]
fn a_third_view_leaves_the_oscillator_its_height_on_a_phone() {
    let picture = "The oscillator: springs, dampers and masses, with each filter's estimate of the displacement";
    for size in [PHONE, Vec2::new(844.0, 390.0)] {
        for others in [&[ViewKind::Parameters][..], &[ViewKind::Parameters, ViewKind::States, ViewKind::Errors]] {
            let mut screen = screen(size, Theme::Light);
            show(&mut screen, &[&[ViewKind::Oscillator], others].concat());
            screen.get_by_label(picture).scroll_to_me();
            screen.run_steps(20);
            let rect = screen.get_by_label(picture).rect();
            assert!(rect.height() > 60.0 && rect.bottom() <= size.y, "{rect} of {size} beside {others:?}");
        }
    }
}

#[test]
fn views_have_a_least_height_and_the_rows_scroll() {
    let rows = [ViewKind::Measured, ViewKind::Parameters, ViewKind::Innovations, ViewKind::Scores];
    let mut screen = screen(DESKTOP, Theme::Light);
    *screen.state_mut().layout_mut() = ViewLayout::column(&rows);
    screen.state_mut().session_mut().set_mode(Mode::Whole);
    screen.run_steps(5);
    for plot in PlantKind::SDOF.channels().iter().filter(|channel| channel.is_parameter()) {
        let rect = screen.get_by_label(&format!("Plot of the {}", plot.name())).rect();
        assert!(rect.height() >= 60.0, "{rect}");
    }
    let tops = rows.map(|kind| screen.get_by_label(&format!("About {}", view(kind).name)).rect().top());
    let heights: Vec<f32> = tops.windows(2).map(|tops| tops[1] - tops[0]).collect();
    assert!(heights.iter().all(|height| *height >= 140.0), "{heights:?}");
    // The border between two rows stops where one would be lower.
    let border = egui::pos2(screen.get_by_label("About Parameters").rect().left() + 200.0, tops[1] - 8.0);
    screen.drag_at(border);
    screen.run_steps(1);
    for step in 1..12 {
        screen.hover_at(border - egui::vec2(0.0, 30.0 * step as f32));
        screen.run_steps(1);
    }
    screen.drop_at(border - egui::vec2(0.0, 360.0));
    screen.run_steps(3);
    let tops = rows.map(|kind| screen.get_by_label(&format!("About {}", view(kind).name)).rect().top());
    assert!(tops.windows(2).all(|tops| tops[1] - tops[0] >= 140.0), "{tops:?}");
}

#[test]
fn a_table_that_scrolls_leaves_the_timeline_alone() {
    let mut screen = screen(DESKTOP, Theme::Light);
    *screen.state_mut().layout_mut() = ViewLayout::column(&[ViewKind::Map, ViewKind::Tune, ViewKind::Filters]);
    screen.state_mut().session_mut().set_mode(Mode::Whole);
    screen.state_mut().session_mut().pause();
    screen.run_steps(5);
    let play = screen.get_by_label("Play").rect().center();
    click_on(&mut screen, play);
    assert!(screen.state().session().playing());
}

fn response(scenario: Scenario) -> Screen {
    let mut screen = workbench();
    show_whole(&mut screen, scenario);
    show(&mut screen, &[ViewKind::FrequencyResponse]);
    screen
}

#[test]
fn values_are_those_of_the_frequency_pointed_at_else_of_the_peak() {
    let mut screen = response(Scenario::default());
    // The truth at its peak, 1 / (2ζωₙ²√(1 - ζ²)).
    assert!(screen.query_by_label("0.278").is_some());
    let plot = screen.get_by_label("Plot of the frequency response").rect();
    screen.hover_at(plot.right_center() - Vec2::new(20.0, 0.0));
    screen.run_steps(3);
    assert!(screen.query_by_label("0.278").is_none());
    screen.hover_at(plot.right_bottom() + Vec2::new(-20.0, 30.0));
    screen.run_steps(3);
    screen.get_by_label("Show truth").click();
    screen.get_by_label("Show EKF").click();
    click(&mut screen, "Show UKF");
    assert!(screen.query_by_label("|H|").is_none(), "nothing is shown");
}

#[test]
fn every_scenario_has_a_response_and_strange_ones_do_no_harm() {
    let mut undamped = Scenario::default();
    undamped.plant.set(Channel::DAMPING_RATIO, Signal::Constant(0.0));
    undamped.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] = 0.0;
    undamped.filters[0].initial_std[Channel::DAMPING_RATIO] = 0.0;
    let loose = {
        let mut loose = undamped.clone();
        loose.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(1e-3));
        loose
    };
    let coarse = Scenario { dt: 0.5, ..Scenario::default() };
    let alone = Scenario { filters: vec![], force: Force::None, ..Scenario::default() };
    let strange = [undamped, loose, coarse, alone];
    let all = kalmanscope_lessons::BUILT_IN.iter().map(|entry| entry.scenario().unwrap()).chain(strange);
    let mut screen = response(Scenario::default());
    for scenario in all {
        screen.state_mut().session_mut().set_scenario(scenario);
        for time in [0.0, 3.0, 1e9] {
            screen.state_mut().session_mut().seek(time);
            screen.run_steps(2);
            assert!(screen.query_by_label("|H|").is_some(), "at {time} s");
        }
    }
}
