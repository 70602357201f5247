//! Many cases on all processors: those that once broke something, and those that follow from numbers.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use crate::dice::Dice;
use crate::findings::{current, stage};
use crate::{scenarios, screen, way};

/// The cases that are tried unless others are asked for.
const CASES: u64 = 400;

/// Limits the time that is taken for them; those that are left are counted \[s\].
const MOST: u64 = 240;

/// One case in this many is shown on screen, which takes longer than all the rest.
const ON_SCREEN: usize = 3;

/// Limits the time of one case, above which it is taken for endless.
const ENDLESS: Duration = Duration::from_secs(120);

pub(crate) struct Plan {
    first: u64,
    count: u64,
    time: Duration,
    is_alone: bool,
}

#[derive(Clone)]
enum Case {
    Kept(PathBuf),
    Made(u64),
}

impl Plan {
    pub(crate) fn of(mut args: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut plan = Self { first: 0, count: CASES, time: Duration::from_secs(MOST), is_alone: false };
        while let Some(word) = args.next() {
            let mut number = || {
                let text = args.next().unwrap_or_default();
                text.parse::<u64>().map_err(|_| format!("{word} wants a whole number, not `{text}`"))
            };
            match word.as_str() {
                "--first" => plan.first = number()?,
                "--seconds" => (plan.count, plan.time) = (u64::MAX, Duration::from_secs(number()?)),
                "--case" => (plan.first, plan.count, plan.is_alone) = (number()?, 1, true),
                _ => return Err(format!("`{word}` is none of --first, --seconds and --case")),
            }
        }
        Ok(plan)
    }

    /// Tries the cases, those that once broke something first, and counts those that fail.
    pub(crate) fn carry_out(self) -> ExitCode {
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            eprintln!("{}:", current());
            usual(info);
        }));
        let begin = Instant::now();
        let kept = if self.is_alone { Vec::new() } else { kept() };
        let made = |at: usize| self.first.wrapping_add((at - kept.len()) as u64);
        let all = usize::try_from(self.count).unwrap_or(usize::MAX).saturating_add(kept.len());
        let (next, failed) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let work = || {
            while begin.elapsed() < self.time {
                let at = next.fetch_add(1, Ordering::Relaxed);
                if at >= all {
                    break;
                }
                let case = kept.get(at).cloned().map_or_else(|| Case::Made(made(at)), Case::Kept);
                failed.fetch_add(usize::from(!case.is_well(self.is_alone)), Ordering::Relaxed);
            }
        };
        let workers = thread::available_parallelism().map_or(1, usize::from);
        thread::scope(|scope| (0..workers).for_each(|_| drop(scope.spawn(work))));
        let (tried, failed) = (next.into_inner().min(all), failed.into_inner());
        println!("{tried} cases in {:.0} s, {failed} failed", begin.elapsed().as_secs_f64());
        if self.count != u64::MAX && tried < all {
            println!("{} cases are left: the time was up", all - tried);
        }
        ExitCode::from(u8::from(failed > 0))
    }
}

fn kept() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hostile");
    let files = std::fs::read_dir(&folder).expect("the folder is there");
    let mut files: Vec<PathBuf> = files.filter_map(|file| Some(file.ok()?.path())).collect();
    files.retain(|file| file.extension().is_some_and(|end| end == "toml"));
    files.sort();
    files
}

impl Case {
    fn name(&self) -> String {
        match self {
            Self::Kept(file) => file.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            Self::Made(number) => format!("case-{number}"),
        }
    }

    /// The scenario as a file has it, and the dice for what follows.
    fn text(&self) -> (String, Dice) {
        match self {
            Self::Kept(file) => (std::fs::read_to_string(file).expect("it can be read"), Dice::new(1)),
            Self::Made(number) => {
                let mut dice = Dice::new(*number);
                (scenarios::text(&mut dice).unwrap_or_default(), dice)
            }
        }
    }

    fn try_it(&self) {
        let is_kept = matches!(self, Self::Kept(_));
        let (text, mut dice) = stage("making a scenario", || self.text());
        let scenario = way::scenario_of(&text);
        assert!(scenario.is_some() || !is_kept, "it is refused");
        if let Some(scenario) = &scenario {
            let measured = way::go(scenario, &mut dice);
            if is_kept || dice.one_in(ON_SCREEN) {
                screen::show(scenario, measured, &mut dice);
            }
        }
    }

    /// Tries a case on a thread with its name, so that even a stack that overflows reports it. Keeps the file of one that fails.
    fn is_well(&self, keeps: bool) -> bool {
        let (end, has_ended) = channel::<()>();
        let (case, name) = (self.clone(), self.name());
        let thread = thread::Builder::new().name(name.clone()).spawn(move || {
            let _end = end;
            case.try_it();
        });
        let thread = thread.expect("a thread can be made");
        let is_endless = has_ended.recv_timeout(ENDLESS) == Err(RecvTimeoutError::Timeout);
        let is_well = !is_endless && thread.join().is_ok();
        if keeps || !is_well {
            let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("whole-way");
            let path = folder.join(name + ".toml");
            std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&path, self.text().0)).expect("it is kept");
            println!("{}{}", path.display(), if is_endless { " does not end" } else { "" });
        }
        if is_endless {
            std::process::exit(1);
        }
        is_well
    }
}
