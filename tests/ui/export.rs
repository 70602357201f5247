//! Files that leave the explorer, and figures.

use std::cell::RefCell;
use std::rc::Rc;

use kalmanscope::export::ExportFile;
use kalmanscope::inbox::Done;
use kalmanscope::request::FigureFormat;
use serde_json::Value;

use super::files::{drop_file, drop_path};
use super::records::{dialects, drop_record};
use super::*;

pub(super) type Files = Rc<RefCell<Vec<ExportFile>>>;

pub(super) fn exporting(size: Vec2) -> (Screen, Files) {
    let files = Files::default();
    let kept = Rc::clone(&files);
    let deliver = move |file: ExportFile, done: Done| {
        done(Ok(file.name.clone()));
        kept.borrow_mut().push(file);
    };
    let mut screen = started(size, Theme::Light, |app, _| app.delivering(Box::new(deliver)));
    *screen.state_mut().layout_mut() = ViewLayout::of(Arrangement::Teach);
    show_whole(&mut screen, Scenario::from_toml("duration = 20.0").expect("it is valid"));
    screen.state_mut().session_mut().seek(10.0);
    screen.run_steps(4);
    (screen, files)
}

fn exported(screen: &mut Screen, files: &Files, entry: &str) -> ExportFile {
    click(screen, "Export");
    match entry.strip_suffix(" (SVG)") {
        Some(size) => {
            click(screen, "Figure…");
            click(screen, size);
            screen.get_by_label("Save as SVG").click();
        }
        None => {
            if screen.query_by_label(entry).is_none() {
                click(screen, "Data…");
            }
            screen.get_by_label(entry).click();
        }
    }
    frames_until_delivered(screen, files);
    screen.run_steps(2);
    let file = files.borrow_mut().pop().expect("a file is delivered");
    assert_eq!(screen.state().notice(), Some(format!("Written: {}", file.name).as_str()));
    file
}

fn frames_until_delivered(screen: &mut Screen, files: &Files) -> usize {
    let is_delivered = |_: &usize| {
        screen.step();
        !files.borrow().is_empty()
    };
    (1..100).find(is_delivered).expect("a file is delivered")
}

#[test]
fn no_frame_makes_a_whole_report_and_escape_stops_it() {
    let (mut screen, files) = exporting(DESKTOP);
    let choose = |screen: &mut Screen| {
        screen.get_by_label("Export").click();
        screen.run_steps(3);
        screen.get_by_label("Report (HTML)").click();
    };
    choose(&mut screen);
    let frames = frames_until_delivered(&mut screen, &files);
    assert!(frames > 6, "one frame for each of five figures, and one for the text: {frames}");
    files.borrow_mut().clear();
    choose(&mut screen);
    screen.run_steps(3);
    screen.key_press(egui::Key::Escape);
    screen.run_steps(20);
    assert!(files.borrow().is_empty());
}

fn text(file: ExportFile) -> String {
    String::from_utf8(file.contents).expect("it is text")
}

#[test]
fn the_report_has_the_story_the_verdicts_and_the_figures() {
    let (mut screen, files) = exporting(DESKTOP);
    let file = exported(&mut screen, &files, "Report (HTML)");
    assert_eq!((file.name.as_str(), file.kind), ("report.html", "text/html"));
    let page = text(file);
    for part in ["A linear oscillator with", "its parameters stay constant", "kalmanscope-cli run"] {
        assert!(page.contains(part), "no {part}");
    }
    // Oscillator, parameters, states; innovations and predictions.
    assert_eq!(page.matches("<figure>").count(), 5);
    assert!(!page.contains("<script"), "nothing runs in it");
}

#[test]
fn results_are_exported_by_the_menu() {
    let (mut screen, files) = exporting(DESKTOP);
    let estimates = text(exported(&mut screen, &files, "Estimates (CSV)"));
    let mut lines = estimates.lines();
    let header = lines.next().expect("there is a header");
    assert!(header.starts_with("filter,k,t,displacement,") && header.contains(",predicted_velocity"), "{header}");
    let filters = scenario(&screen).filters.len();
    assert_eq!(lines.count(), filters * 2001);

    let record = text(exported(&mut screen, &files, "Record (CSV)"));
    assert!(record.starts_with("t,force,displacement,velocity,true_displacement"));
    assert_eq!(record.lines().count(), 2002);

    let toml = text(exported(&mut screen, &files, "Scenario (TOML)"));
    let mut read = Scenario::from_toml(&toml).expect("it can be read again");
    read.number_filters();
    assert_eq!(&read, scenario(&screen));
}

#[test]
fn the_map_of_the_laboratory_is_exported_as_numbers_and_as_a_figure() {
    let (mut screen, files) = exporting(DESKTOP);
    screen.state_mut().layout_mut().toggle(ViewKind::Map);
    screen.run_steps(3);
    let table = text(exported(&mut screen, &files, "Map (CSV)"));
    let mut lines = table.lines();
    let header = lines.next().expect("there is a header");
    assert!(header.starts_with("filters.EKF.initial_mean.natural_frequency,filters.EKF.process_std,EKF.nis,"));
    let width = header.split(',').count();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 32 * 32);
    assert!(rows.iter().all(|row| row.len() == width));
    assert!(rows.iter().any(|row| row[2].parse().is_ok_and(|nis: f64| nis > 0.0)), "some cells are known");
    let figure = text(exported(&mut screen, &files, "Paper, 174 mm (SVG)"));
    for label in ["guess of", "factor on", "setting on screen"] {
        assert!(figure.contains(label), "{label}");
    }
}

#[test]
fn everything_is_one_json() {
    let (mut screen, files) = exporting(DESKTOP);
    let all: Value =
        serde_json::from_str(&text(exported(&mut screen, &files, "Everything (JSON)"))).expect("it is JSON");
    assert_eq!(all["kalmanscope"], env!("CARGO_PKG_VERSION"));
    assert_eq!(all["scenario"]["duration"], 20.0);
    assert_eq!(all["record"]["series"]["measured"]["velocity"].as_array().map(Vec::len), Some(2001));
    let session = screen.state().session();
    for (place, estimates) in session.run().estimates().iter().enumerate() {
        let filter = &all["filters"][place];
        assert_eq!(filter["name"], estimates.name());
        let at = estimates.place(Channel::NATURAL_FREQUENCY).expect("it is estimated");
        let series = &filter["series"];
        assert_eq!(series["mean"]["natural_frequency"][2000], estimates.canonical_mean(2000, at));
        assert_eq!(series["innovation"]["velocity"][7], estimates.innovation(7)[1]);
        assert!(series["innovation"]["velocity"][0].is_null(), "the first sample has none");
        let verdict = session.diagnosis(place).and_then(|diagnosis| diagnosis.verdict.as_ref());
        let kind = verdict.expect("there is a verdict").kind;
        assert_eq!(filter["verdict"]["kind"], kind.key());
        assert!(filter["evidence"].as_array().is_some_and(|evidence| !evidence.is_empty()));
    }
}

#[test]
fn a_session_is_opened_again_by_drop() {
    let (mut screen, files) = exporting(DESKTOP);
    screen.state_mut().layout_mut().toggle(ViewKind::Phase);
    press(&mut screen, Key::A);
    screen.state_mut().session_mut().seek(12.0);
    press(&mut screen, Key::B);
    screen.state_mut().session_mut().seek(10.0);
    click(&mut screen, "Show truth");
    press(&mut screen, Key::PageDown);
    let views = screen.state_mut().layout_mut().shown();
    let (expected, picture) = (scenario(&screen).clone(), screen.state().picture());
    assert!(picture.ruler.is_used() && !picture.hidden.is_empty() && picture.enlarged.is_some());
    let file = exported(&mut screen, &files, "Session file");

    let mut other = super::screen(DESKTOP, Theme::Light);
    assert_ne!(scenario(&other), &expected);
    drop_file(&mut other, "session.json", &file.contents);
    assert_eq!(other.state().notice(), None);
    assert_eq!(scenario(&other), &expected);
    let session = other.state().session();
    assert_eq!((session.mode(), session.time(), session.playing()), (Mode::Whole, 10.0, false));
    assert_eq!(other.state_mut().layout_mut().shown(), views);
    assert_eq!(other.state().picture(), picture, "marks, hidden entries and the enlarged view are there too");
}

#[test]
fn figures_are_exported_by_keyboard_too() {
    let (mut screen, files) = exporting(DESKTOP);
    press(&mut screen, Key::E);
    click(&mut screen, "Figure…");
    press(&mut screen, Key::Escape);
    assert!(screen.query_by_label("Save as SVG").is_none());
    press(&mut screen, Key::E);
    click(&mut screen, "Figure…");
    click(&mut screen, "Paper, 84 mm");
    click(&mut screen, "Save as SVG");
    let svg = text(files.borrow_mut().pop().expect("a file is delivered"));
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
    assert!(svg.contains("width=\"84mm\"") && svg.contains("natural frequency"), "{}", &svg[..300]);
    let slide = exported(&mut screen, &files, "Slide, 16:9 (SVG)");
    assert_eq!(slide.name, "kalmanscope-slide.svg");
    let svg = text(slide);
    let [width, height] = ["width", "height"].map(|name| attribute(&svg, name));
    assert!((width / height - 16.0 / 9.0).abs() < 1e-3, "{width} {height}");
}

/// The number of an attribute, such as `width="84mm"`.
fn attribute(element: &str, name: &str) -> f32 {
    let (_, rest) = element.split_once(&format!(" {name}=\"")).expect("it has the attribute");
    let end = rest.find(|letter: char| !(letter.is_ascii_digit() || letter == '.' || letter == '-')).unwrap_or(0);
    rest[..end].parse().expect("it is a number")
}

#[test]
fn figures_have_the_size_type_and_lines_of_a_paper() {
    let (screen, _) = exporting(DESKTOP);
    for (format, width) in [(FigureFormat::Column, 84.0), (FigureFormat::Page, 174.0)] {
        let figure = screen.state().figure(format);
        let svg = figure.svg();
        assert!((figure.millimetres()[0] - width).abs() < 0.01, "{:?}", figure.millimetres());
        // Points of 1/72 inch per unit of the drawing.
        let scale = width / 25.4 * 72.0 / viewed(&svg)[0];
        let sizes: Vec<f32> =
            svg.lines().filter(|l| l.contains("<text ")).map(|l| scale * attribute(l, "font-size")).collect();
        // Only the picture of the plant has labels of its own size.
        let of_type = sizes.iter().filter(|size| (7.99..8.01).contains(*size)).count();
        assert!(sizes.iter().all(|size| (6.0..10.0).contains(size)), "{sizes:?}");
        assert!(of_type > 20 && 10 * of_type > 8 * sizes.len(), "{sizes:?}");
        let curves = svg.lines().filter(|line| line.matches('L').count() > 50 && line.contains("stroke-width"));
        let widths: Vec<f32> = curves.map(|line| scale * attribute(line, "stroke-width")).collect();
        let is_thin = |width: &f32| (0.2..=0.755).contains(width);
        assert!(widths.iter().any(|width| *width >= 0.5) && widths.iter().all(is_thin), "{widths:?}");
        // No part of the screen's triangles, no dark ground, nothing that only a hand needs.
        for part in ["NaN", "inf", "UV", "Drag"] {
            assert!(!svg.contains(part), "{part}");
        }
        assert!(svg.matches("<path ").count() > 30 && svg.contains("fill=\"#fff\""));
    }
}

#[test]
fn nothing_of_a_figure_is_cut_off_at_its_edges() {
    for views in [
        vec![ViewKind::States, ViewKind::Innovations],
        vec![ViewKind::Autocorrelation, ViewKind::Phase, ViewKind::Consistency],
        vec![ViewKind::Scores, ViewKind::Matrices],
    ] {
        let (mut screen, _) = exporting(DESKTOP);
        show(&mut screen, &views);
        for format in FigureFormat::ALL {
            let figure = screen.state().figure(format);
            let svg = figure.svg();
            let [width, height] = viewed(&svg);
            let boxes = text_boxes(&svg);
            let is_inside = |&[left, top, right, bottom]: &[f32; 4]| {
                left >= 0.0 && top >= 0.0 && right <= width && bottom <= height
            };
            assert!(
                boxes.len() > 10 && boxes.iter().all(is_inside),
                "{views:?}, {format:?}: {width} {height} {boxes:?}"
            );
            let last = ["log likelihood", "time [s]"].iter().any(|text| svg.contains(text));
            assert!(last, "{views:?}, {format:?}: tables are there that scroll on a screen");
            let lines: Vec<&str> = svg.lines().collect();
            let is_cut = |pair: &[&str]| pair[0].starts_with("<g clip-path") && pair[1].starts_with("<text");
            assert!(!lines.windows(2).any(is_cut), "{views:?}, {format:?}: a text is cut off");
        }
    }
}

fn viewed(svg: &str) -> [f32; 2] {
    let (_, rest) = svg.split_once("viewBox=\"0 0 ").expect("it has a box");
    let mut numbers = rest.split([' ', '"']).map(|number| number.parse().expect("it is a number"));
    [(); 2].map(|()| numbers.next().expect("there are two"))
}

/// Left, top, right and bottom of each text of a figure, from the top of its capitals to below its baseline.
fn text_boxes(svg: &str) -> Vec<[f32; 4]> {
    let numbers = |line: &str, from: &str| -> Vec<f32> {
        let Some((_, rest)) = line.split_once(from) else { return Vec::new() };
        rest.split(')')
            .next()
            .into_iter()
            .flat_map(|inside| inside.split(' '))
            .map(|number| number.parse().expect("a number"))
            .collect()
    };
    let (mut place, mut boxes) = ([0.0, 0.0, 1.0], Vec::new());
    for line in svg.lines() {
        if line.starts_with("<g transform") {
            let (moved, scale) = (numbers(line, "translate("), numbers(line, "scale("));
            place = [moved[0], moved[1], scale[0]];
        }
        if line.starts_with("<text") {
            let [x, y, size, length] = ["x", "y", "font-size", "textLength"].map(|name| attribute(line, name));
            let (origin, turn) =
                (numbers(line, "translate("), numbers(line, "rotate(").first().copied().unwrap_or(0.0));
            let turn = turn.to_radians();
            let corners = [[x, y - 0.75 * size], [x + length, y + 0.2 * size]].map(|[x, y]| {
                let turned = [turn.cos() * x - turn.sin() * y, turn.sin() * x + turn.cos() * y];
                [0, 1].map(|axis: usize| place[axis] + place[2] * (origin[axis] + turned[axis]))
            });
            let [a, b] = corners;
            boxes.push([a[0].min(b[0]), a[1].min(b[1]), a[0].max(b[0]), a[1].max(b[1])]);
        }
    }
    boxes
}

#[test]
fn a_file_that_cannot_be_written_or_delivered_is_reported() {
    let is_full = |app: App, _: &egui::Context| {
        app.delivering(Box::new(|file, done| done(Err(format!("{}: the disk is full", file.name)))))
    };
    for (mut screen, reason) in [
        (started(DESKTOP, Theme::Light, is_full), "record.csv: the disk is full."),
        (screen(DESKTOP, Theme::Light), "there is no place for files here."),
    ] {
        screen.run_steps(3);
        for button in ["Export", "Data…", "Record (CSV)"] {
            click(&mut screen, button);
        }
        assert_eq!(screen.state().notice(), Some(format!("The file cannot be written: {reason}").as_str()));
    }
}

#[test]
fn a_session_asks_for_its_record_only_where_that_is_missing() {
    let asks = |screen: &Screen| screen.state().notice().is_some_and(|notice| notice.contains("drop that file too"));
    // The records of the menu are built in.
    let (mut screen, files) = exporting(DESKTOP);
    screen.state_mut().session_mut().set_scenario(
        kalmanscope_lessons::BuiltIn::named("circuit").expect("it is there").scenario().expect("it is valid"),
    );
    screen.run_steps(4);
    assert!(screen.state().session().is_measured());
    let session = exported(&mut screen, &files, "Session file");
    let mut other = super::screen(DESKTOP, Theme::Light);
    drop_file(&mut other, "session.json", &session.contents);
    assert!(other.state().session().is_measured() && !asks(&other), "{:?}", other.state().notice());
    // A user's record is not.
    let (name, bytes) = dialects()[0].clone();
    drop_record(&mut screen, name, &bytes);
    let session = exported(&mut screen, &files, "Session file");
    drop_file(&mut screen, "session.json", &session.contents);
    assert!(!asks(&screen), "the record is here: {:?}", screen.state().notice());
    drop_file(&mut other, "session.json", &session.contents);
    assert!(asks(&other), "{:?}", other.state().notice());
    // Nothing of another run takes its place: no story, no plot, no playback.
    let place = format!("The record “{name}” is not here. Drop the file on the window, or choose it.");
    other.get_by_label(&place);
    for of_another in ["Believe", "About Parameters", "Restart", "The sentence above the plots"] {
        assert!(other.query_by_label_contains(of_another).is_none(), "{of_another}");
    }
    // It is found beside the session's file.
    let folder = std::env::temp_dir().join(format!("kalmanscope-beside-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder can be made");
    std::fs::write(folder.join(name), &bytes).expect("a file can be written");
    std::fs::write(folder.join("session.json"), &session.contents).expect("a file can be written");
    let mut third = super::screen(DESKTOP, Theme::Light);
    drop_path(&mut third, folder.join("session.json"));
    third.run_steps(30);
    std::fs::remove_dir_all(folder).expect("the folder can be removed");
    assert!(third.state().session().is_measured(), "{:?}", third.state().session().problem());
    assert!(third.query_by_label(&place).is_none() && third.query_by_label("Open the record").is_none());
}

/// A film of a view alone from a time on, and the delays \[0.01 s\] and the widths of its frames.
fn film(screen: &mut Screen, files: &Files, kind: ViewKind, time: f64) -> (ExportFile, Vec<u16>, Vec<u16>) {
    show(screen, &[kind]);
    screen.state_mut().session_mut().seek(time);
    click(screen, "Export");
    screen.get_by_label("Film…").click();
    frames_until_delivered(screen, files);
    screen.run_steps(2);
    let file = files.borrow_mut().pop().expect("a film is delivered");
    assert_eq!(screen.state().session().time(), time, "playback is where it was");
    assert_eq!(screen.state().notice(), Some(format!("Written: {}", file.name).as_str()));
    assert!(file.contents.len() <= kalmanscope::film::LARGEST, "{}", file.contents.len());
    let mut decoder = gif::DecodeOptions::new().read_info(&file.contents[..]).expect("it is a GIF");
    let (mut delays, mut widths) = (Vec::new(), Vec::new());
    while let Some(frame) = decoder.read_next_frame().expect("every frame can be read") {
        delays.push(frame.delay);
        widths.push(frame.width);
    }
    (file, delays, widths)
}

#[test]
fn five_seconds_of_any_view_are_a_film() {
    let (mut screen, files) = exporting(DESKTOP);
    // At 18 s of 20 s a second of the film is left: it begins earlier.
    let (file, delays, widths) = film(&mut screen, &files, ViewKind::Oscillator, 18.0);
    assert_eq!((file.name.as_str(), file.kind), ("oscillator.gif", "image/gif"));
    assert_eq!((delays.len(), delays.iter().sum::<u16>(), widths[0]), (60, 500, 800));
    assert!(widths.iter().all(|width| *width > 1), "the mass moves in each picture");
    assert_eq!(film(&mut screen, &files, ViewKind::Oscillator, 18.0).0, file, "the same film again");
    let (_, delays, widths) = film(&mut screen, &files, ViewKind::Matrices, 1.0);
    assert_eq!(delays.len(), 60);
    assert!(widths.iter().all(|width| *width > 20), "each sample has other numbers");
}

#[test]
fn escape_stops_a_film_of_one_of_several_views_and_playback_returns() {
    let (mut screen, files) = exporting(DESKTOP);
    click(&mut screen, "Export");
    click(&mut screen, "Film…");
    screen.get_by_role_and_label(egui::accesskit::Role::Button, "Parameters").click();
    screen.run_steps(10);
    assert!(screen.state().notice().is_some_and(|notice| notice.starts_with("Film of Parameters: ")));
    assert_ne!(screen.state().session().time(), 10.0);
    press(&mut screen, Key::Escape);
    screen.run_steps(100);
    assert!(files.borrow().is_empty());
    assert_eq!((screen.state().session().time(), screen.state().notice()), (10.0, None));
}
