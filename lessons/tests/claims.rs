//! Every claim of the lessons holds, with ten seeds.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

use std::sync::Mutex;

use kalmanscope_lessons::{Claim, LESSONS, Lesson, verify};

/// The lessons whose file name contains the value of `LESSON`, if it is set, to save time while writing one.
fn wanted() -> Vec<Lesson> {
    let part = std::env::var("LESSON").unwrap_or_default();
    let chosen = LESSONS.iter().filter(|(name, _)| name.contains(&part));
    chosen.map(|(name, text)| Lesson::from_toml(text).unwrap_or_else(|error| panic!("{name}: {error}"))).collect()
}

fn verify_all(lessons: &[Lesson]) -> Vec<Claim> {
    let queue = Mutex::new(lessons.iter().enumerate());
    let next = || queue.lock().unwrap().next();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut done: Vec<(usize, Vec<Claim>)> = std::thread::scope(|scope| {
        let work = || {
            let one = |(place, lesson)| (place, verify(lesson, 1..=10).unwrap());
            std::iter::from_fn(next).map(one).collect::<Vec<_>>()
        };
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap()).collect()
    });
    done.sort_by_key(|(place, _)| *place);
    done.into_iter().flat_map(|(_, claims)| claims).collect()
}

#[test]
fn every_claim_of_each_lesson_holds() {
    let claims = verify_all(&wanted());
    for claim in &claims {
        println!("{} {claim}", if claim.holds() { "holds" } else { "FAILS" });
    }
    let failed: Vec<String> = claims.iter().filter(|claim| !claim.holds()).map(Claim::to_string).collect();
    assert!(failed.is_empty(), "{} claims of {} fail:\n{}", failed.len(), claims.len(), failed.join("\n"));
}
