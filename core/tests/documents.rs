//! Scenarios from documents of any format.

use kalmanscope_core::Scenario;
use kalmanscope_core::document;

/// A text of TOML as one of JSON.
fn json(toml: &str) -> String {
    document::to_json(&document::from_toml(toml).expect("it is TOML")).expect("JSON can express it")
}

fn from_json(text: &str) -> Result<Scenario, String> {
    let document = document::from_json(text).map_err(|error| error.to_string())?;
    Scenario::from_document(&document).map_err(|error| error.to_string())
}

#[test]
fn every_file_of_the_project_is_the_same_scenario_as_json() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/scenarios");
    let mut files = 0;
    for entry in std::fs::read_dir(folder).expect("there is a folder") {
        let path = entry.expect("it can be read").path();
        let text = std::fs::read_to_string(&path).expect("it can be read");
        let expected = Scenario::from_toml(&text).expect("it is a scenario");
        assert_eq!(from_json(&json(&text)).as_ref(), Ok(&expected), "{path:?}");
        let document = expected.to_document().expect("a document can express it");
        assert_eq!(Scenario::from_document(&document).as_ref(), Ok(&expected), "{path:?}");
        let written = document::to_json(&document).expect("JSON can express it");
        assert_eq!(from_json(&written).as_ref(), Ok(&expected), "{path:?}");
        files += 1;
    }
    assert!(files > 5, "{files}");
}

#[test]
fn what_a_file_may_leave_out_a_document_may_too() {
    assert_eq!(from_json("{}"), Scenario::from_toml("").map_err(|error| error.to_string()));
    let scenario = from_json(r#"{"sensors": [{"measures": "velocity", "noise_std": 1}], "filters": [{}, {}]}"#);
    let scenario = scenario.expect("it is a scenario");
    let names: Vec<(u32, &str)> = scenario.filters.iter().map(|filter| (filter.id, filter.name.as_str())).collect();
    assert_eq!(names, [(1, "EKF"), (2, "EKF 2")]);
    assert_eq!(scenario.filters[1].sensor_std, [1.0]);
}

#[test]
fn names_that_are_changed_are_told() {
    let text = json("[[filters]]\nname = \"a\"\n[[filters]]\nname = \"a\"");
    let document = document::from_json(&text).expect("it is JSON");
    let (scenario, remarks) = Scenario::from_document_with_remarks(&document).expect("it is a scenario");
    assert_eq!(scenario.filters[1].name, "a 2");
    assert_eq!(remarks, ["filter 2 is called `a 2` in place of `a`: an earlier filter has this name"]);
}

#[test]
fn an_error_has_the_path_of_its_key_and_no_line() {
    let refused = |text: &str| from_json(text).expect_err("it is no scenario");
    assert!(refused(r#"{"filters": [{}, {"knd": "ukf"}]}"#).starts_with("`filters[1].knd`: unknown field `knd`"));
    assert_eq!(refused(r#"{"dt": "soon"}"#), "`dt`: invalid type: string \"soon\", expected f64");
    assert!(refused(r#"{"dt": -1}"#).starts_with("`dt` is -1, but must be "));
    // A list of nothing would be the default.
    assert_eq!(refused("[]"), "expected a table");
}
