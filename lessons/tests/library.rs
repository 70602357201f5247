use kalmanscope_core::Scenario;
use kalmanscope_lessons::{BUILT_IN, BuiltIn, EQUATIONS, LESSONS, Lesson, LibraryFile, lessons};

/// The names of the files in a folder of the assets, without their ending.
fn files(folder: &str) -> Vec<String> {
    let folder = format!("{}/assets/{folder}", env!("CARGO_MANIFEST_DIR"));
    let name = |file: std::io::Result<std::fs::DirEntry>| file.unwrap().file_name().into_string().unwrap();
    let mut names: Vec<String> = std::fs::read_dir(folder).unwrap().map(name).collect();
    names.sort();
    names.into_iter().map(|name| name.trim_end_matches(".toml").to_owned()).collect()
}

#[test]
fn each_file_is_in_its_list() {
    assert_eq!(files("lessons"), LESSONS.iter().map(|(name, _)| *name).collect::<Vec<_>>());
}

#[test]
fn five_courses_have_five_to_nine_lessons_and_the_first_lesson_asks() {
    let lessons: Vec<Lesson> = lessons().into_iter().filter_map(Result::ok).collect();
    let courses: Vec<&[Lesson]> = lessons.chunk_by(|one, next| one.course == next.course).collect();
    let names: Vec<&str> = courses.iter().map(|course| course[0].course.as_str()).collect();
    let expected = ["Start here", "Tune Q and R", "When things change", "Sensors and records", "Know when it lies"];
    assert_eq!(names, expected);
    assert!(courses.iter().all(|course| (5..=9).contains(&course.len())), "{names:?}");
    assert!(lessons[0].steps[0].question.is_some());
}

#[test]
fn every_lesson_is_valid_and_complete() {
    for (name, text) in LESSONS {
        let lesson = Lesson::from_toml(text).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(lesson.picture.is_some() && (2..=12).contains(&lesson.minutes()), "{name}: {}", lesson.minutes());
        assert!((2..=4).contains(&lesson.steps.len()), "{name}: {} steps", lesson.steps.len());
        assert!(lesson.summary.ends_with('.'), "{name}");
        let same = LESSONS.iter().filter(|(_, text)| text.contains(&format!("title = \"{}\"\n", lesson.title)));
        assert_eq!(same.count(), 1, "a lesson is known by its title: {name}");
        for (number, step) in lesson.steps.iter().enumerate() {
            let because = step.question.iter().map(|question| &question.because);
            let mut texts = [&step.look, &step.happens, &step.why].into_iter().chain(because);
            assert!(texts.all(|t| t.ends_with('.') && t.len() > 20), "{name}, step {}", number + 1);
            assert!(step.question.iter().all(|question| question.ask.ends_with('?')), "{name}, step {}", number + 1);
            assert!(!step.views.is_empty() && !step.checks.is_empty(), "{name}, step {}", number + 1);
        }
    }
}

#[test]
fn lessons_and_scenarios_are_told_apart() {
    assert!(matches!(LibraryFile::from_toml(LESSONS[0].1), Ok(LibraryFile::Lesson(_))));
    assert!(matches!(LibraryFile::from_toml(BUILT_IN[0].toml()), Ok(LibraryFile::Scenario(_))));
    assert_eq!(LibraryFile::from_toml("").unwrap(), LibraryFile::Scenario(Box::default()));
}

#[test]
fn errors_are_those_of_the_kind_of_file() {
    for (text, part) in
        [("title = 1", "invalid type"), ("steps = []", "missing field"), ("fading = 1", "fading"), ("=", "TOML")]
    {
        let error = LibraryFile::from_toml(text).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn each_file_is_in_the_list() {
    for (folder, list) in [("scenarios", BUILT_IN), ("equations", EQUATIONS)] {
        let mut built_in: Vec<&str> = list.iter().map(|scenario| scenario.file).collect();
        built_in.sort_unstable();
        assert_eq!(files(folder), built_in);
    }
}

#[test]
fn each_built_in_scenario_can_be_read_and_has_a_description() {
    for built_in in BUILT_IN.iter().chain(EQUATIONS) {
        assert!(built_in.scenario().is_ok(), "{}: {:?}", built_in.title, built_in.scenario());
        assert!(built_in.description().len() > 20, "{}: {}", built_in.title, built_in.description());
    }
    let of_core = BuiltIn::named("stiffness-loss").unwrap().scenario().unwrap();
    assert_eq!(of_core, Scenario::default(), "the core's default is one of them");
}
