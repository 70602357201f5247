//! The page's program in one of its workers: runs the cells of ensembles.

use js_sys::Array;
use kalmanscope_lab::Runner;
use kalmanscope_worker::{answer, cells, hear, runner, tell};

/// Answers messages for as long as the worker lives.
pub(super) fn serve() {
    let mut present: Option<(f64, Runner)> = None;
    hear(move |words| match words.text(0).as_str() {
        "ensemble" => {
            present = match runner(&words.text(2), &words.get(3)) {
                Ok(runner) => Some((words.job(), runner)),
                Err(reason) => {
                    tell(&Array::of3(&"failed".into(), &words.job().into(), &reason.into()));
                    None
                }
            };
        }
        "cells" => {
            if let Some((job, runner)) = &present
                && *job == words.job()
            {
                let cells = cells(words.get(2));
                answer(*job, &cells, &runner.rows(&cells));
            }
        }
        _ => {}
    });
}
