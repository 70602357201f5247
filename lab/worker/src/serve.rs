//! The page's program in one of its workers.

use js_sys::Array;

use crate::cells::{Rows, runner};
use crate::filter::{Filter, posterior, sampled_message, suggest, suggestion_message};
use crate::record::{file, loaded_message};
use crate::scope::{Words, answer, fail, hear};
use crate::task::{Portioned, Whole};

/// Does tasks for as long as the worker lives.
pub fn serve() {
    let mut tasks: Vec<(f64, Box<dyn Portioned>)> = Vec::new();
    hear(move |words| {
        let number = words.number();
        match words.text(0).as_str() {
            "more" => {
                if let Some((_, task)) = tasks.iter_mut().find(|(other, _)| *other == number) {
                    let handed_over = Array::new();
                    let part = task.go_on(&words.get(2), &handed_over);
                    answer(number, &part, &handed_over);
                }
            }
            "forget" => tasks.retain(|(other, _)| *other != number),
            kind => match begin(kind, words) {
                Ok(task) => tasks.push((number, task)),
                Err(reason) => fail(number, &reason),
            },
        }
    });
}

fn begin(kind: &str, words: &Words) -> Result<Box<dyn Portioned>, String> {
    Ok(match kind {
        "cells" => Box::new(Rows(runner(words)?)),
        "filter" => Box::new(Filter::new(words)?),
        "file" => Box::new(Whole::new(file(words), loaded_message)),
        "posterior" => Box::new(Whole::new(posterior(words)?, sampled_message)),
        "suggest" => Box::new(Whole::new(suggest(words)?, suggestion_message)),
        _ => return Err(format!("`{kind}` is no task")),
    })
}
