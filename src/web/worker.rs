//! The page's program in one of its workers: runs the cells of ensembles, and errands.

use js_sys::Array;
use kalmanscope_lab::Runner;
use kalmanscope_worker::{Errand, Watch, Words, answer, cells, hear, runner, tell};

/// Answers messages for as long as the worker lives.
pub(super) fn serve() {
    let mut present: Option<(f64, Runner)> = None;
    let mut errands: Vec<Errand> = Vec::new();
    hear(move |words| match words.text(0).as_str() {
        "ensemble" => {
            present = told(runner(&words.text(2), &words.get(3)), words).map(|runner| (words.job(), runner));
        }
        "cells" => {
            if let Some((job, runner)) = &present
                && *job == words.job()
            {
                let (cells, watch) = (cells(words.get(2)), Watch::start());
                answer(*job, &cells, &runner.rows(&cells), &watch);
            }
        }
        "more" => {
            let errand = errands.iter_mut().find(|errand| errand.number() == words.job());
            if let Some(errand) = errand {
                errand.answer(words);
            }
        }
        "forget" => errands.retain(|errand| errand.number() != words.job()),
        _ => errands.extend(Errand::new(words).and_then(|errand| told(errand, words))),
    });
}

/// The work of a message. If the worker cannot begin it, the page hears why.
fn told<T>(found: Result<T, String>, words: &Words) -> Option<T> {
    found.map_err(|reason| tell(&Array::of3(&"failed".into(), &words.job().into(), &reason.into()))).ok()
}
