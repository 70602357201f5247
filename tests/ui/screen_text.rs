//! The screen in words and tables: the numbers of the plots, verdicts and news.

use kalmanscope::screen_text::{ScreenPart, ScreenTable, ScreenText};
use kalmanscope::text::significant;
use kalmanscope_core::ModelClasses;

use super::records::drop_record;
use super::*;

fn at_rest() -> Screen {
    let mut screen = screen(DESKTOP, Theme::Light);
    let session = screen.state_mut().session_mut();
    session.toggle_play();
    session.set_mode(Mode::Whole);
    session.seek(session.end());
    screen.run_steps(20);
    screen
}

fn part<'a>(text: &'a ScreenText, name: &str) -> &'a ScreenPart {
    text.parts.iter().find(|part| part.name == name).unwrap_or_else(|| panic!("there is no {name} in {text:?}"))
}

fn cell<'a>(table: &'a ScreenTable, row: &str, column: &str) -> &'a str {
    let column = table.columns.iter().position(|name| name == column).expect("the column exists");
    &table.rows.iter().find(|cells| cells[0] == row).expect("the row exists")[column]
}

#[test]
fn a_table_has_the_numbers_of_its_plot() {
    let screen = at_rest();
    let text = screen.state().screen_text();
    let parameters = part(&text, "Parameters");
    let table = &parameters.tables[0];
    assert_eq!(table.caption, "natural frequency [rad/s]");
    assert_eq!(table.columns, ["Time", "truth", "EKF", "UKF"]);
    assert_eq!(table.rows.len(), 12);
    assert!(table.rows.iter().all(|row| row.len() == 4));
    let run = screen.state().session().run();
    let frequency = run.channels().into_iter().find(|channel| channel.name() == "natural frequency").unwrap();
    let at = run.estimates()[0].place(frequency).unwrap();
    for (row, k) in [("At playback, 60 s", 6000), ("0 s", 0), ("6 s", 600), ("60 s", 6000)] {
        let [mean, band] = [run.estimates()[0].canonical_mean(k, at), 2.0 * run.estimates()[0].std(k, at)];
        let hertz = significant(mean / std::f64::consts::TAU, 4);
        assert_eq!(cell(table, row, "EKF"), format!("{mean:.3} ±{band:.3} ({hertz} Hz)"), "{row}");
    }
    let truths = [cell(table, "24 s", "truth"), cell(table, "30 s", "truth")];
    assert_eq!(truths, ["6.000 (0.9549 Hz)", "4.800 (0.7639 Hz)"], "the truth changes");
    let oscillator = part(&text, "Oscillator");
    assert!(oscillator.tables.is_empty() && oscillator.about.ends_with("No numbers by time."), "{oscillator:?}");
}

#[test]
fn every_view_over_time_has_tables() {
    let mut screen = at_rest();
    for (kind, caption) in [
        (ViewKind::Parameters, "damping ratio"),
        (ViewKind::States, "displacement [m]"),
        (ViewKind::Errors, "error of the natural frequency [rad/s]"),
        (ViewKind::Innovations, "innovations of the displacement sensor [m]"),
        (ViewKind::Consistency, "NIS, normalised innovation squared, over expectation, mean of 2 s"),
        (ViewKind::Classes, "probabilities of the model classes"),
        (ViewKind::Gain, "gain of the displacement by the displacement sensor"),
    ] {
        *screen.state_mut().layout_mut() = ViewLayout::column(&[kind]);
        screen.run_steps(20);
        let text = screen.state().screen_text();
        let part = part(&text, view(kind).name);
        let captions: Vec<&str> = part.tables.iter().map(|table| table.caption.as_str()).collect();
        assert!(captions.contains(&caption), "{captions:?}");
        // The first sample has no innovation.
        for row in part.tables.iter().flat_map(|table| &table.rows).filter(|row| row[0] != "0 s") {
            assert!(row[1..].iter().all(|text| text.chars().any(|c| c.is_ascii_digit())), "{kind:?}: {row:?}");
        }
    }
}

#[test]
fn filters_that_learn_their_noise_show_it_under_the_innovations() {
    let mut screen = at_rest();
    show(&mut screen, &[ViewKind::Innovations]);
    assert!(screen.query_by_label("Plot of the learnt noise of the displacement sensor").is_none());
    let mut learning = scenario(&screen).clone();
    learning.filters[1].adaptation.sensor_noise = true;
    screen.state_mut().session_mut().set_scenario(learning);
    screen.run_steps(60);
    screen.get_by_label("Plot of the learnt noise of the displacement sensor");
    let text = screen.state().screen_text();
    let captions = &part(&text, "Innovations").tables;
    let table = captions.iter().find(|table| table.caption == "learnt noise of the displacement sensor [m]");
    let text = cell(table.expect("it is there"), "60 s", "UKF");
    let (std, band) = text.split_once(" ±").expect("it has a band");
    let [std, band] = [std, band].map(|text| text.parse::<f64>().expect("a number"));
    assert!((std - 0.01).abs() < 1.5 * band && (0.0005..0.002).contains(&band), "{text}");
}

/// The probabilities of the filters that are shown add up to one, and one that is hidden is no class.
#[test]
fn filters_that_are_shown_are_model_classes() {
    let mut screen = at_rest();
    *screen.state_mut().layout_mut() = ViewLayout::column(&[ViewKind::Classes]);
    screen.run_steps(20);
    let text = screen.state().screen_text();
    let table = &part(&text, "Which model").tables[0];
    let evidence = screen.state().session().evidence();
    for (row, k) in [("0 s", 0), ("6 s", 600), ("60 s", 6000)] {
        let classes = ModelClasses::new(evidence.iter().map(|of| of.at(k).unwrap()));
        for (name, p) in ["EKF", "UKF"].iter().zip(&classes.probabilities) {
            let text = cell(table, row, name);
            match 100.0 * p {
                p if p > 99.99 => assert_eq!(text, "> 99.99 %"),
                p if p < 0.01 => assert_eq!(text, "< 0.01 %"),
                p => assert_eq!(text, format!("{p:.2} %")),
            }
        }
    }
    screen.get_by_label("Plot of the probabilities of the model classes");
    screen.get_by_label("Plot of the average natural frequency");
    click(&mut screen, "Show UKF");
    assert!(screen.query_by_label("Plot of the probabilities of the model classes").is_none(), "one is no choice");
    assert!(screen.query_by_label_contains("Show at least two filters").is_some());
}

#[test]
fn hidden_filters_and_verdicts_are_hidden_here_too() {
    let mut screen = at_rest();
    let text = screen.state().screen_text();
    let verdicts = &part(&text, ScreenText::VERDICTS).tables[0];
    assert_eq!(verdicts.rows.len(), 2);
    assert_eq!(cell(verdicts, "EKF", "Verdict"), "recovered");
    assert!(cell(verdicts, "EKF", "Reason").len() > 20);
    click(&mut screen, "Show UKF");
    let text = screen.state().screen_text();
    assert_eq!(part(&text, "Parameters").tables[0].columns, ["Time", "truth", "EKF"]);
    click(&mut screen, "Show verdicts");
    let text = screen.state().screen_text();
    assert!(text.parts.iter().all(|part| part.name != ScreenText::VERDICTS));
}

#[test]
fn news_are_verdicts_that_change_and_messages_that_are_new() {
    let mut screen = at_rest();
    let before = screen.state().screen_text();
    assert!(before.news(&before).is_empty());
    assert_eq!(before.news(&ScreenText::default()).len(), 2, "one verdict for each filter");
    let mut scenario = scenario(&screen).clone();
    scenario.filters[0].sensor_std = scenario.filters[0].sensor_std.iter().map(|std| 0.1 * std).collect();
    screen.state_mut().session_mut().set_scenario(scenario.clone());
    screen.run_steps(20);
    let now = screen.state().screen_text();
    assert_eq!(now.news(&before), ["EKF is overconfident."]);
    scenario.dt = -1.0;
    set_scenario(&mut screen, scenario);
    let news = screen.state().screen_text().news(&now);
    assert_eq!(news, [screen.state().session().problem().expect("a negative time step is impossible")]);
}

/// A measured record may have more sensors than the filters are told, and in another order.
#[test]
fn numbers_of_a_measured_record_are_those_of_their_own_sensor() {
    let mut file = Vec::new();
    let mut run =
        kalmanscope_core::Run::new(&Scenario { duration: 20.0, ..Scenario::default() }).expect("it can be run");
    run.finish();
    run.record().write_csv(&mut file).expect("memory");
    let mut screen = screen(DESKTOP, Theme::Light);
    drop_record(&mut screen, "record.csv", &file);
    *screen.state_mut().layout_mut() = ViewLayout::column(&[ViewKind::Measured, ViewKind::Innovations, ViewKind::Gain]);
    let mut swapped = scenario(&screen).clone();
    assert_eq!(swapped.sensors.len(), 2);
    swapped.sensors.reverse();
    swapped.filters.iter_mut().for_each(|filter| filter.sensor_std.reverse());
    let mut alone = swapped.clone();
    alone.remove_sensor(Quantity::DISPLACEMENT);
    for scenario in [swapped, alone] {
        let displacement = scenario.sensors.iter().any(|sensor| sensor.measures == Quantity::DISPLACEMENT);
        set_scenario(&mut screen, scenario);
        let (text, session) = (screen.state().screen_text(), screen.state().session());
        let (estimates, k) = (&session.run().estimates()[0], session.index());
        let innovation = estimates.innovation(k)[0];
        let find = |view: &str, caption: &str| {
            let part = part(&text, view);
            part.tables.iter().find(|table| table.caption.starts_with(caption)).cloned()
        };
        let shown = find("Innovations", "innovations of the velocity sensor").expect("a table");
        let now = shown.rows[0][1].clone();
        assert!(now.starts_with(&significant(innovation, 3)), "{now} in place of {innovation}");
        let measured = session.run().record().measured_quantity(Quantity::VELOCITY).expect("a column")[k];
        let shown = find("Measured and predicted", "velocity measured and predicted").expect("a table");
        assert_eq!(shown.rows[0][2], significant(measured - innovation, 4));
        let shown = find("Measured and predicted", "displacement measured and predicted").expect("a table");
        assert_eq!(shown.columns.len(), if displacement { 2 + session.run().estimates().len() } else { 2 });
    }
}
