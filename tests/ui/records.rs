//! Measured records: dropped on the window, with as few choices as possible.

use std::fmt::Write as _;

use super::files::drop_file;
use super::*;

/// An oscillator of 6 rad/s with a damping ratio of 5 %, driven by a force that is linear between samples, as a table of
/// time, force and displacement in millimetres.
pub(super) fn rows() -> Vec<[f64; 3]> {
    let text = "duration = 40.0\ndt = 0.05\nhold = \"first\"\n[plant]\nnatural_frequency = 6.0\n[[sensors]]\n\
                measures = \"displacement\"\nnoise_std = 0.002\n";
    let mut run = kalmanscope_core::Run::new(&Scenario::from_toml(text).expect("a scenario")).expect("a run");
    run.finish();
    let record = run.record();
    let row = |k: usize| [record.time(k), record.input()[k], 1000.0 * record.measured(0)[k]];
    (0..record.len()).map(row).collect()
}

pub(super) fn dialects() -> [(&'static str, Vec<u8>); 6] {
    let table = |header: &str, line: &dyn Fn(&[f64; 3]) -> String| {
        let mut text = header.to_owned();
        rows().iter().for_each(|row| writeln!(text, "{}", line(row)).expect("memory"));
        text
    };
    let plain = |[t, f, x]: &[f64; 3]| format!("{t:.3},{f:.5},{x:.5},");
    let german = |[t, f, x]: &[f64; 3]| format!("{t:.3};{f:.5};{x:.5}").replace('.', ",");
    let tabs = |[t, f, x]: &[f64; 3]| format!("{:.1}\t{f:.5}\t{x:.5}", 1000.0 * t);
    let blanks = |[t, f, x]: &[f64; 3]| format!("  {t:.4e}   {f:.6e}   {:.6e}", x / 1000.0);
    let no_time = |[_, f, x]: &[f64; 3]| format!("\"{f:.5}\",\"{x:.5}\"");
    let utf16: Vec<u8> =
        table("\u{FEFF}Zeit [s];Kraft;Weg [mm]\r\n", &german).encode_utf16().flat_map(u16::to_le_bytes).collect();
    [
        ("trailing.csv", table("time,force,x (mm),\n", &plain).into_bytes()),
        ("leading.csv", table("Logger 7\nStart: 12.05.2024\n\nZeit;Kraft;Weg\ns;m/s²;mm\n", &german).into_bytes()),
        ("tabs.tsv", table("t in ms\tForce\tdisp_mm\n", &tabs).into_bytes()),
        ("blanks.txt", table("% t f x\n", &blanks).into_bytes()),
        ("volts.csv", table("\"V1\",\"V2 (mm)\"\n", &no_time).into_bytes()),
        ("wide.csv", utf16),
    ]
}

pub(super) fn open_record(screen: &mut Screen) {
    click(screen, "Open the record");
    screen.run_steps(30);
}

pub(super) fn drop_record(screen: &mut Screen, name: &str, contents: &[u8]) {
    drop_file(screen, name, contents);
    screen.run_steps(10);
    open_record(screen);
}

#[test]
fn a_record_too_long_for_the_screen_is_thinned_and_says_so() {
    let mut screen = screen(DESKTOP, Theme::Light);
    let mut text = "t,force,displacement\n".to_owned();
    (0..401_000).for_each(|k| writeln!(text, "{:.2},{},1", 0.01 * f64::from(k), k % 40 / 20).expect("memory"));
    drop_file(&mut screen, "long.csv", text.as_bytes());
    let is_there = |screen: &Screen, words: &str| screen.query_by_label_contains(words).is_some();
    let waits = (0..5000).take_while(|_| {
        screen.step();
        !is_there(&screen, "133,667 samples")
    });
    assert!(waits.count() < 5000 && is_there(&screen, "One of 3 samples is kept: at most 200,000 are shown."));
}

#[track_caller]
pub(super) fn check_result(screen: &Screen, name: &str) {
    let session = screen.state().session();
    assert!(session.is_measured(), "{name}: {:?}", session.problem());
    let estimates = &session.run().estimates()[0];
    let last = estimates.len() - 1;
    let wn = estimates.mean(last)[estimates.place(Channel::NATURAL_FREQUENCY).expect("it is estimated")];
    assert!((wn / 6.0 - 1.0).abs() < 0.01, "{name}: {wn}");
}

#[test]
fn six_dialects_open_by_drop_with_at_most_three_choices() {
    for (name, bytes) in dialects() {
        let mut screen = screen(DESKTOP, Theme::Light);
        screen.state_mut().session_mut().seek(7.5);
        drop_file(&mut screen, name, &bytes);
        screen.run_steps(3);
        screen.get_by_label("Open a measured record");
        if name == "volts.csv" {
            screen.get_by_label("the file has no column of times: state the sample rate");
            set(&mut screen, "Sample rate", 20.0);
        }
        let is_german = ["leading.csv", "wide.csv"].contains(&name);
        if screen.query_by_label("Meaning of V1").is_none() {
            click(&mut screen, "Columns…");
        }
        assert_eq!(screen.query_by_label("Meaning of Kraft").is_some(), is_german);
        open_record(&mut screen);
        check_result(&screen, name);
        assert_eq!(screen.state().session().mode(), Mode::Whole);
        let session = screen.state().session();
        assert_eq!((session.position(), session.playing()), (session.run().samples() - 1, false));
        screen.get_by_label("Plot of the displacement measured and predicted");
        let free = screen.state().session().free_run(0).expect("the free run is made").fits[0].expect("a fit");
        assert!(free.percent > 80.0, "{name}: {free:?}");
    }
}

#[test]
fn what_cannot_be_read_is_said_and_nothing_is_lost() {
    let mut screen = screen(DESKTOP, Theme::Light);
    let before = scenario(&screen).clone();
    for (contents, sentence, button) in [
        (&b"\x7FELF\x01\x02\x03\x00\x00\x00"[..], "the file is not text with columns of numbers", "Close"),
        (b"PK\x03\x04...", "this is a ZIP; it is damaged or cut short", "Close"),
        (b"t,force,x\n0,1,2\n1,2,oops\n2,3,4\n", "line 3, column `x`: `oops` is not a number", "Cancel the import"),
        (
            b"t,force,x\n0,1,2\n1,2,3\n1,3,4\n2,3,4\n",
            "line 4: the time in `t` stands still from 1 s to 1 s: choose a part by its times, or state the sample rate to count the rows as \
             even",
            "Cancel the import",
        ),
    ] {
        drop_file(&mut screen, "bad.csv", contents);
        let of_file = format!("“bad.csv” cannot be opened: {sentence}.");
        screen.get_by_label(if button == "Close" { &of_file } else { sentence });
        click(&mut screen, button);
        assert_eq!(scenario(&screen), &before);
    }
}

#[test]
fn the_meaning_of_a_column_can_be_changed_before_and_after() {
    let mut screen = screen(DESKTOP, Theme::Light);
    drop_file(&mut screen, "volts.csv", &dialects()[4].1);
    set(&mut screen, "Sample rate", 20.0);
    choose(&mut screen, "Meaning of V2", "velocity");
    screen.run_steps(10);
    open_record(&mut screen);
    // A change that lasts for a second is one that can be taken back.
    screen.run_steps(60);
    assert_eq!(screen.state().session().problem(), None);
    assert_eq!(screen.state().session().sensors(), [Quantity::VELOCITY]);
    click(&mut screen, "Columns…");
    choose(&mut screen, "Meaning of V2", "displacement");
    screen.run_steps(10);
    open_record(&mut screen);
    screen.run_steps(60);
    assert_eq!(screen.state().session().sensors(), [Quantity::DISPLACEMENT]);
    // Each change can be taken back.
    undo(&mut screen);
    assert_eq!(screen.state().session().sensors(), [Quantity::VELOCITY]);
}

/// The window shows these sentences for a file, and unfolds the choices of engineers where something is in doubt.
#[test]
fn a_file_is_summed_up_and_what_is_in_doubt_is_unfolded() {
    let table = |header: &str, lost: usize| {
        let mut text = format!("{header}\n");
        for (k, [t, f, x]) in rows().into_iter().enumerate() {
            let x = if k % 12 == 5 && k / 12 < lost { String::new() } else { format!("{x:.5}") };
            writeln!(text, "{t:.3},{f:.5},{x}").expect("memory");
        }
        text.into_bytes()
    };
    let lines = |lost: usize| {
        let text = String::from_utf8(table("t,force,x (mm)", 0)).expect("text");
        let lines = text.lines().enumerate().filter(|(k, _)| k % 12 != 5 || k / 12 >= lost);
        lines.map(|(_, line)| format!("{line}\n")).collect::<String>().into_bytes()
    };
    let text = String::from_utf8(table("t,force,x", 2)).expect("text");
    let sentinel = text.lines().map(|line| format!("{line}{}\n", if line.ends_with(',') { "-9999" } else { "" }));
    let sentinel = sentinel.collect::<String>().into_bytes();
    for (bytes, is_unfolded, said) in [
        (table("t [s],Force [N],Acc [m/s²]", 63), false, "63 of 801 readings of Acc are missing: left out."),
        (table("t [s],Force [N],Acc [m/s²]", 63), false, "force [N]; its mass is estimated"),
        (table("t,Force [m/s²],x (mm)", 1), false, "1 of 801 readings of x is missing: left out."),
        (table("t,Force [m/s²],x (mm)", 1), false, "force over mass [m/s²]"),
        (table("t,Force [m/s²],x (mm)", 1), false, "displacement [mm]"),
        (lines(20), false, "20 of 801 readings of x are missing: left out."),
        (lines(20), false, "801 samples over 40 s at 20 Hz"),
        (sentinel, false, "2 of 801 readings of x are missing: left out."),
        (table("t,force [kgf],x (mm)", 0), true, "“kgf” is no known unit: the numbers of force stay."),
        (table("t,foo,baz", 0), true, "foo: guessed: the first column without a meaning, and no other is one."),
        (dialects()[4].1.clone(), true, "the file has no column of times: state the sample rate"),
    ] {
        let mut screen = screen(DESKTOP, Theme::Light);
        drop_file(&mut screen, "record.csv", &bytes);
        screen.run_steps(3);
        assert!(screen.query_by_label_contains(said).is_some(), "{said}");
        assert_eq!(screen.query_by_label("Plant of the record").is_some(), is_unfolded, "{said}");
    }
}

#[test]
fn a_scenario_waits_for_its_file_and_goes_on_when_it_comes() {
    let (name, bytes) = &dialects()[0];
    let mut first = screen(DESKTOP, Theme::Light);
    drop_record(&mut first, name, bytes);
    let scenario = first.state().session().scenario().to_toml().expect("it can be written");
    let checksum = first.state().session().run().checksum();
    let mut second = screen(DESKTOP, Theme::Light);
    drop_file(&mut second, "scenario.toml", scenario.as_bytes());
    let problem = second.state().session().problem().expect("the file is missing").to_owned();
    assert!(problem.contains(name) && problem.contains("drop"), "{problem}");
    second.state_mut().session_mut().set_mode(Mode::Whole);
    drop_file(&mut second, "another name.csv", bytes);
    second.run_steps(6);
    assert!(second.query_by_label("Open a measured record").is_none(), "nothing is to be asked");
    assert_eq!(second.state().session().problem(), None);
    assert_eq!(second.state().session().run().checksum(), checksum);

    let restored = restored(&saved(&mut first));
    assert!(!restored.session().is_measured(), "another picture is shown until the file is here");
    assert!(restored.session().problem().is_some_and(|problem| problem.contains(name)));
    assert_eq!(restored.session().scenario(), first.state().session().scenario());
}

#[test]
fn models_are_tested_on_a_record_that_they_have_not_seen() {
    let mut screen = screen(DESKTOP, Theme::Light);
    let (name, bytes) = &dialects()[0];
    drop_file(&mut screen, name, bytes);
    assert!(screen.query_by_label("Test the models on it").is_none(), "there is nothing to test yet");
    open_record(&mut screen);
    // The second half of the same record, as another file.
    let text = String::from_utf8(bytes.clone()).expect("text");
    let lines: Vec<&str> = text.lines().collect();
    let half = [&lines[..1], &lines[401..]].concat().join("\n");
    drop_file(&mut screen, "other.csv", half.as_bytes());
    screen.get_by_label("Test the models on it").click();
    screen.run_steps(6);
    assert!(screen.query_by_label("Open a measured record").is_none());
    let session = screen.state().session();
    let fit = session.held_out_fit(0, 0).expect("a fit");
    assert!(fit.percent > 80.0 && fit.readings < 401, "{fit:?}");
    assert_eq!(session.library().held_out().map(|(name, _)| name), Some("other.csv"));
    // A file of another kind is refused in a sentence.
    drop_file(&mut screen, "strange.csv", b"a,b\n1,2\n2,1\n3,3\n");
    screen.get_by_label("Test the models on it").click();
    screen.run_steps(6);
    assert!(screen.state().notice().is_some_and(|notice| notice.contains("there is no column")));
}

#[test]
fn a_band_pass_and_decimation_are_applied() {
    let mut screen = screen(Vec2::new(1280.0, 1000.0), Theme::Light);
    drop_file(&mut screen, "trailing.csv", &dialects()[0].1);
    click(&mut screen, "Columns…");
    screen.get_by_label("Part, band and rate").click();
    screen.run_steps(30);
    set(&mut screen, "Keep one of every", 2.0);
    click(&mut screen, "band-pass");
    set(&mut screen, "Band to [Hz]", 3.0);
    screen.get_by_label("401 samples over 40 s at 10 Hz");
    open_record(&mut screen);
    check_result(&screen, "decimated");
}

fn file_with_losses(is_lost: impl Fn(usize) -> bool) -> String {
    let mut text = "time,force,x (mm)\n".to_owned();
    for (k, [t, f, x]) in rows().into_iter().enumerate() {
        let reading = if is_lost(k) { String::new() } else { format!("{x:.5}") };
        writeln!(text, "{t:.3},{f:.5},{reading}").expect("memory");
    }
    text
}

fn with_losses(is_lost: impl Fn(usize) -> bool) -> Screen {
    let mut screen = screen(DESKTOP, Theme::Light);
    drop_record(&mut screen, "gaps.csv", file_with_losses(is_lost).as_bytes());
    screen
}

#[test]
fn a_phone_opens_a_record_at_once_and_says_what_is_missing() {
    let mut screen = screen(PHONE, Theme::Light);
    drop_file(&mut screen, "gaps.csv", file_with_losses(|k| [30, 31, 70].contains(&k)).as_bytes());
    screen.run_steps(120);
    let notice = screen.state().notice().expect("it says what was opened");
    let said = "“gaps.csv”: 801 samples over 40 s at 20 Hz. 3 of 801 readings of x are missing: left out.";
    assert!(notice.starts_with(said), "{notice}");
    assert!(screen.state().session().is_measured() && screen.query_by_label("Columns…").is_some());
}

#[test]
fn a_gap_that_is_over_is_a_mark_on_the_axis_and_no_row() {
    let top = |screen: &Screen| screen.get_by_label("About Measured and predicted").rect().top();
    let without = top(&with_losses(|_| false));
    let mut screen = with_losses(|k| (500..=520).contains(&k));
    assert!(screen.query_by_label_contains("delivers nothing").is_none());
    assert_eq!(top(&screen), without, "it takes no row");
    let words = "no displacement from 25 to 26 s";
    let told = screen.state().screen_text().messages;
    assert_eq!(told, ["No displacement from 25 to 26 s."], "readers of the tables learn of it");
    // A pointer over the gap tells it.
    assert!(screen.query_by_label(words).is_none());
    let plot = screen.get_by_label("Plot of the natural frequency").rect();
    let axis = screen.state().axis().followed(screen.state().session());
    let share = (25.5 - axis.0) / (axis.1 - axis.0);
    screen.hover_at(egui::pos2(plot.left() + share as f32 * plot.width(), plot.center().y));
    screen.run_steps(90);
    screen.get_by_label(words);
}

#[test]
fn a_sensor_that_is_silent_to_the_end_is_said_once_until_another_record_is_there() {
    let mut screen = with_losses(|k| k >= 700);
    let said = |screen: &Screen| screen.query_all_by_label("No displacement since 35 s.").count();
    assert_eq!(said(&screen), 1, "once, for all filters");
    drop_record(&mut screen, "trailing.csv", &dialects()[0].1);
    assert_eq!(said(&screen), 0);
}

#[test]
fn start_values_that_are_not_found_are_said_in_red_and_r_is_not_inflated() {
    let screen = with_losses(|k| k % 29 != 0);
    let notice = screen.state().notice().expect("a notice");
    assert!(notice.starts_with("No start values of ωₙ and ζ could be found, because"), "{notice}");
    assert_eq!(screen.query_all_by_label(notice).count(), 2, "as a notice, and where the start values are explained");
    let std = scenario(&screen).filters[0].sensor_std[0];
    assert!(std <= 0.01, "R is larger than its default: {std}");
    assert!(screen.query_by_label_contains("R as large").is_none());
}

#[test]
fn the_window_of_an_import_has_the_keys() {
    let mut screen = screen(DESKTOP, Theme::Light);
    drop_file(&mut screen, "bad.csv", b"");
    screen.get_by_label("“bad.csv” cannot be opened: the file is empty.");
    // No key acts behind the window.
    let mode = screen.state().session().mode();
    for key in [Key::L, Key::Space, Key::C] {
        press(&mut screen, key);
    }
    assert_eq!((screen.state().session().mode(), screen.state().notice()), (mode, None));
    press(&mut screen, Key::Escape);
    assert!(screen.query_by_label("Close").is_none());
    drop_file(&mut screen, "trailing.csv", &dialects()[0].1);
    screen.run_steps(3);
    screen.key_press(Key::Enter);
    screen.run_steps(6);
    check_result(&screen, "trailing.csv");
}

fn irregular() -> Screen {
    let mut screen = screen(Vec2::new(1280.0, 1000.0), Theme::Light);
    let mut text = "time,force,x (mm)\n".to_owned();
    for (k, [t, f, x]) in rows().into_iter().enumerate().filter(|(k, _)| k % 3 > 0) {
        writeln!(text, "{:.4},{f:.5},{x:.5}", t + 0.001 * (k * 7 % 13) as f64).expect("memory");
    }
    drop_file(&mut screen, "irregular.csv", text.as_bytes());
    screen.run_steps(3);
    click(&mut screen, "Columns…");
    screen.get_by_label("Part, band and rate").click();
    screen.run_steps(30);
    screen
}

#[test]
fn irregular_times_are_kept_unless_even_steps_are_asked_for() {
    let mut screen = irregular();
    screen.get_by_label_contains("the filters use each reading at its own time");
    screen.get_by_label("at even steps").click();
    screen.run_steps(30);
    screen.get_by_label_contains("even steps of");
    screen.get_by_label("at even steps").click();
    screen.run_steps(30);
    open_record(&mut screen);
    let session = screen.state_mut().session_mut();
    assert!(session.run().record().clocks().is_some());
    let said =
        |screen: &Screen| screen.query_all_by_label_contains("each reading counts at the sample after it").count();
    let mut scenario = session.scenario().clone();
    scenario.filters[0].jump = true;
    session.set_scenario(scenario);
    screen.run_steps(6);
    assert_eq!(said(&screen), 1);
}

/// The steps at which filters tell what they know are the user's choice, where readings keep their times.
#[test]
fn the_steps_of_a_record_with_its_own_times_are_chosen() {
    let mut screen = irregular();
    screen.get_by_label("steps of").click();
    screen.run_steps(30);
    // Steps that are too short are refused, and can be made longer.
    set(&mut screen, "steps of [s]", 0.0);
    screen.run_steps(30);
    screen.get_by_label_contains("samples, but at most");
    set(&mut screen, "steps of [s]", 0.25);
    screen.run_steps(30);
    open_record(&mut screen);
    let record = screen.state().session().run().record();
    let readings = record.clocks().expect("it keeps its times").readings[0].times.len();
    assert!((record.dt() - 0.25).abs() < 1e-12 && readings > record.len(), "{readings} in {}", record.len());
}
