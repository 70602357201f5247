use kalmanscope_core::Scenario;
use kalmanscope_lessons::{Lesson, LessonError, Presentation};

const HEAD: &str = "title = \"T\"\ncourse = \"Practice\"\nsummary = \"s\"\nscenario = \"stiffness-loss\"\n";
const STEP: &str = "[[steps]]\nlook = \"l\"\nhappens = \"h\"\nwhy = \"w\"\n";

#[test]
fn changes_accumulate_from_step_to_step() {
    let change = |set: &str| format!("{STEP}change = {{ label = \"x\", set = {{ {set} }} }}\n");
    let text = format!(
        "{HEAD}adjust = {{ set = {{ duration = 5.0 }} }}\n{STEP}{}{}",
        change("\"filters.EKF.fading\" = 1.1"),
        change("seed = 9, \"filters.EKF.eta\" = 0.5")
    );
    let lesson = Lesson::from_toml(&text).unwrap();
    let of = |s: &Scenario| (s.duration, s.filters[0].fading, s.seed, s.filters[0].eta);
    let steps: Vec<_> = lesson.scenarios().unwrap().iter().map(of).collect();
    assert_eq!(steps, [(5.0, 1.005, 1, 0.0), (5.0, 1.1, 1, 0.0), (5.0, 1.1, 9, 0.5)]);
    assert_eq!(of(&lesson.scenario_at(99).unwrap()), steps[2]);
    assert_eq!(of(&lesson.first_scenario().unwrap()), steps[0]);
    assert_eq!((lesson.steps[0].mode, &lesson.steps[0].change), (Presentation::Whole, &None));
}

#[test]
fn errors_name_their_step() {
    let check = |check: &str| format!("{HEAD}{STEP}{STEP}checks = [{{ filter = \"EKF\", {check} }}]");
    for (text, message) in [
        (format!("{HEAD}steps = []"), "the lesson has no step"),
        (
            format!("{HEAD}{STEP}question = {{ ask = \"a\", choices = [], answer = 1, because = \"b\" }}"),
            "step 1: the question has 0 `choices`, but must have 2 to 4",
        ),
        (HEAD.replace("stiffness-loss", "x") + STEP, "there is no built-in scenario `x`"),
        (
            format!("{HEAD}{STEP}{STEP}change = {{ label = \"x\", set = {{ \"plant.x\" = 1 }} }}"),
            "step 2: `plant.x`: unknown field `x`, expected `kind`, `equation`",
        ),
        (check("measure = \"rmse\", below = 1"), "step 2: the check of `rmse` lacks a `channel`"),
        (check("measure = \"nis\""), "step 2: the check of `nis` needs `above` or `below`"),
        (
            check("measure = \"verdict\", below = 1"),
            "step 2: the check of `verdict` needs `is`, and nothing to compare with",
        ),
        (
            check("measure = \"nis\", below = 1, before = true"),
            "step 2: the check of `nis` compares with what was before, but the step changes nothing",
        ),
        (format!("{HEAD}{STEP}change = {{ set = {{ seed = 1 }} }}"), "step 1: the change has no `label`"),
    ] {
        let error = Lesson::from_toml(&text).unwrap_err().to_string();
        assert!(error.starts_with(message), "{error}");
    }
    let no_score = Lesson::from_toml(&check("measure = \"speed\", below = 1")).unwrap_err().to_string();
    assert!(no_score.contains("`speed` is no score; there are nis"), "{no_score}");
    let unknown = Lesson::from_toml(&check("measure = \"nis\", belov = 1")).unwrap_err().to_string();
    assert!(unknown.contains("belov") && unknown.contains("below"), "{unknown}");
}

#[test]
fn axes_of_cells_are_numbers_that_the_scenario_has() {
    let error = |axis: &str| {
        let cells = format!("cells = {{ x = \"{axis}\", above = 0 }}");
        let check = format!("{{ filter = \"EKF\", measure = \"nis\", above = 0.5, {cells} }}");
        Lesson::from_toml(&format!("{HEAD}{STEP}checks = [{check}]")).unwrap_err().to_string()
    };
    for axis in ["x", "x=0:1:1", "x=0:1:257", "x=0:1:5:log", "seed=1:2:2"] {
        assert!(error(axis).contains(&LessonError::Axis(axis.to_owned()).to_string()), "{}", error(axis));
    }
    let missing = "the scenario has no number `filters.KF.fading` to vary; its filters are `EKF` and `UKF`";
    assert!(error("filters.KF.fading=1:2:2").contains(missing));
    assert!(error("filters.EKF.fading=0.5:2:9").contains("filters[0].fading"));
}
