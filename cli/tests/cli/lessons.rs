//! Lessons and the test of their claims.

use std::process::Command;

use crate::{fails, file, folder, succeeds};

/// The page for authors, which has a lesson.
const AUTHORS: &str = include_str!("../../../lessons/README.md");

/// The command that checks a lesson, and the lesson of the page for authors.
fn lesson() -> (Command, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_kalmanscope-cli"));
    command.arg("lesson");
    let lesson = AUTHORS.split_once("```toml\n").and_then(|(_, rest)| rest.split_once("```")).unwrap().0;
    (command, lesson.to_owned())
}

#[test]
fn the_claims_of_a_lesson_are_tried() {
    let folder = folder();
    let (mut command, text) = lesson();
    let lines = succeeds(command.arg(file(&folder, "lesson.toml", &text)));
    let lines: Vec<&str> = lines.lines().collect();
    assert_eq!(lines.len(), 4, "{lines:?}");
    assert!(lines[..3].iter().all(|line| line.starts_with("holds ")), "{lines:?}");
    assert!(lines[0].contains("A filter that forgets, step 1: nis of EKF from 30 s to 35 s, above 20.0"), "{lines:?}");
    assert_eq!(lines[3], "3 claims on 10 seeds: 0 fail");
}

#[test]
fn a_claim_that_fails_is_printed_and_has_an_exit_code() {
    let folder = folder();
    let (mut command, text) = lesson();
    let wrong = file(&folder, "lesson.toml", &text.replace("above = 20.0", "below = 20.0"));
    let (lines, message) = fails(command.arg(wrong).args(["--seeds", "3"]), 1);
    assert_eq!(message, "");
    assert!(lines.starts_with("FAILS   0.0 % (98 %)  A filter that forgets, step 1"), "{lines}");
    assert!(lines.ends_with("3 claims on 3 seeds: 1 fail\n"), "{lines}");
}

#[test]
fn bad_lessons_are_refused_with_file_and_place() {
    let folder = folder();
    let text = lesson().1;
    for (part, other, message) in [
        ("look = ", "lok = ", "lok"),
        ("answer = 2", "answer = 3", "step 1: the question has the `answer` 3"),
        ("filters.EKF.fading\" = 1.02", "filters.EKF.fadng\" = 1.02", "step 2: the scenario has no setting"),
        ("above = 20.0", "", "step 1: the check of `nis` needs `above` or `below`"),
        ("stiffness-loss", "stiffness", "there is no built-in scenario `stiffness`"),
    ] {
        let path = file(&folder, "bad.toml", &text.replacen(part, other, 1));
        let (lines, error) = fails(lesson().0.arg(path), 2);
        assert_eq!(lines, "");
        assert!(error.contains("bad.toml: ") && error.contains(message), "{error}");
    }
    let (_, error) = fails(lesson().0.arg(folder.path().join("none.toml")), 2);
    assert!(error.contains("none.toml"), "{error}");
}
