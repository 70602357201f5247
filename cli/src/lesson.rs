//! The command `kalmanscope-cli lesson`.

use std::collections::BTreeSet;

use kalmanscope_lessons::{Claim, Lesson, verify_all};

use crate::args::LessonArgs;
use crate::input::{InputError, read_text};
use crate::places::print;

/// Reads a lesson, tries its claims and prints a line for each. Returns whether all of them hold.
pub(crate) fn lesson(args: &LessonArgs) -> Result<bool, InputError> {
    let LessonArgs { lesson: file, seeds } = args;
    let bad = |error| InputError::Lesson { file: file.clone(), error };
    let lesson = Lesson::from_toml(&read_text(file)?).map_err(bad)?;
    // Beside the first few: the record that opens, and those that a claim is about.
    let named = lesson.steps.iter().flat_map(|step| &step.checks).filter_map(|check| check.seed);
    let opened = lesson.first_scenario().map_err(bad)?.seed;
    let seeds: Vec<u64> = (1..=*seeds).chain(named).chain([opened]).collect::<BTreeSet<_>>().into_iter().collect();
    let claims = verify_all(&[lesson], &seeds).map_err(bad)?;
    let failed = claims.iter().filter(|claim| !claim.holds()).count();
    let lines: String = claims.iter().map(|claim| claim.summary() + "\n").collect();
    let count = match claims.len() {
        0 => "The lesson can be read. It states no claims.".to_owned(),
        1 => format!("1 claim on {} seeds: {failed} fails", seeds.len()),
        several => format!("{several} claims on {} seeds: {failed} fail", seeds.len()),
    };
    print(&format!("{lines}{count}\n"))?;
    Ok(claims.iter().all(Claim::holds))
}
