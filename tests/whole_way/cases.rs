//! Many cases on all processors, and a summary of what they show.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use crate::dice::Dice;
use crate::findings::{Finding, Findings, keep_panics, stage_of};
use crate::scenarios;
use crate::screen;
use crate::way;

/// The cases that are tried unless others are asked for.
const CASES: u64 = 400;

/// Limits the time that is taken for them; those that are left are told \[s\].
const MOST: u64 = 240;

/// One case in this many is shown on screen, which takes longer than all the rest.
const ON_SCREEN: usize = 3;

/// Limits the time of one case, above which it is taken for endless \[s\].
const ENDLESS: Duration = Duration::from_secs(120);

#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    first: u64,
    count: u64,
    time: Duration,
    keeps_all: bool,
}

struct Outcome {
    name: String,
    text: String,
    findings: Vec<Finding>,
    longest: f64,
    was_accepted: bool,
    was_measured: bool,
}

impl Plan {
    pub(crate) fn of(mut args: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut plan = Self { first: 0, count: CASES, time: Duration::from_secs(MOST), keeps_all: false };
        while let Some(word) = args.next() {
            let mut number = || {
                let text = args.next().unwrap_or_default();
                text.parse::<u64>().map_err(|_| format!("{word} wants a whole number, not `{text}`"))
            };
            match word.as_str() {
                "--first" => plan.first = number()?,
                "--cases" => plan.count = number()?,
                "--seconds" => (plan.count, plan.time) = (u64::MAX, Duration::from_secs(number()?)),
                "--case" => (plan.first, plan.count, plan.keeps_all) = (number()?, 1, true),
                _ => return Err(format!("`{word}` is none of --first, --cases, --seconds and --case")),
            }
        }
        Ok(plan)
    }

    /// Tries the cases, those that once broke something first, and prints what they show.
    pub(crate) fn carry_out(self) -> ExitCode {
        keep_panics(self.keeps_all);
        let begin = Instant::now();
        let kept = if self.keeps_all { Vec::new() } else { kept() };
        let (next, workers) = (AtomicU64::new(0), thread::available_parallelism().map_or(1, usize::from));
        let (outcomes, busy) = (Mutex::new(Vec::new()), AtomicUsize::new(workers));
        let running: Vec<Mutex<Option<(u64, Instant)>>> = (0..workers).map(|_| Mutex::new(None)).collect();
        thread::scope(|scope| {
            for place in &running {
                scope.spawn(|| {
                    while begin.elapsed() < self.time {
                        let at = next.fetch_add(1, Ordering::Relaxed);
                        if at >= self.count {
                            break;
                        }
                        let number = self.first.wrapping_add(at);
                        set(place, Some((number, Instant::now())));
                        let outcome = on_its_own(&format!("case {number}"), move || made(number));
                        let Ok(mut outcomes) = outcomes.lock() else { return };
                        outcomes.push((number, outcome));
                        drop(outcomes);
                        set(place, None);
                    }
                    busy.fetch_sub(1, Ordering::Relaxed);
                });
            }
            while busy.load(Ordering::Relaxed) > 0 {
                thread::sleep(Duration::from_millis(50));
                for place in &running {
                    if let Ok(Some((number, since))) = place.lock().as_deref()
                        && since.elapsed() > ENDLESS
                    {
                        end_at(*number);
                    }
                }
            }
        });
        let mut outcomes = outcomes.into_inner().unwrap_or_default();
        outcomes.sort_by_key(|(number, _)| *number);
        let outcomes: Vec<Outcome> = kept.into_iter().chain(outcomes.into_iter().map(|(_, outcome)| outcome)).collect();
        self.report(&outcomes, begin.elapsed())
    }

    fn report(self, outcomes: &[Outcome], time: Duration) -> ExitCode {
        let mut kinds: BTreeMap<(String, &str), Vec<(&Outcome, &Finding)>> = BTreeMap::new();
        for outcome in outcomes {
            for finding in &outcome.findings {
                kinds.entry((finding.what.clone(), finding.stage)).or_default().push((outcome, finding));
            }
            if self.keeps_all || !outcome.findings.is_empty() {
                keep(outcome);
            }
        }
        for ((what, stage), found) in &kinds {
            let mut cases: Vec<&str> = found.iter().map(|(outcome, _)| outcome.name.as_str()).collect();
            cases.dedup();
            let (first, finding) = found[0];
            println!("{stage} {what}: {} case(s), {}", cases.len(), cases[..cases.len().min(8)].join(", "));
            println!("  {}", finding.detail);
            if !self.keeps_all {
                first.text.lines().for_each(|line| println!("  | {line}"));
            }
        }
        let count = |is: fn(&Outcome) -> bool| outcomes.iter().filter(|outcome| is(outcome)).count();
        let longest = outcomes.iter().max_by(|a, b| a.longest.total_cmp(&b.longest));
        let longest = longest.map_or_else(String::new, |o| format!(", longest stage {:.0} ms ({})", o.longest, o.name));
        println!(
            "{} cases from {} on, {} refused, {} measured, {} kinds of findings in {} cases{longest}; {:.0} s",
            outcomes.len(),
            self.first,
            count(|outcome| !outcome.was_accepted),
            count(|outcome| outcome.was_measured),
            kinds.len(),
            count(|outcome| !outcome.findings.is_empty()),
            time.as_secs_f64()
        );
        let tried = outcomes.iter().filter(|outcome| outcome.name.starts_with("case ")).count() as u64;
        if self.count != u64::MAX && tried < self.count {
            println!("{} cases are left: the time was up", self.count - tried);
        }
        ExitCode::from(u8::from(!kinds.is_empty()))
    }
}

fn set(place: &Mutex<Option<(u64, Instant)>>, now: Option<(u64, Instant)>) {
    if let Ok(mut place) = place.lock() {
        *place = now;
    }
}

/// Tries a case on a thread that bears its name, so that even a stack that overflows tells it.
fn on_its_own(name: &str, case: impl FnOnce() -> Outcome + Send) -> Outcome {
    let lost = || {
        let findings = vec![Finding { stage: "the case", what: "ends its thread".to_owned(), detail: String::new() }];
        let (text, longest) = (String::new(), 0.0);
        Outcome { name: name.to_owned(), text, findings, longest, was_accepted: false, was_measured: false }
    };
    thread::scope(|scope| {
        let thread = thread::Builder::new().name(name.to_owned()).spawn_scoped(scope, case);
        thread.map_or_else(|_| lost(), |thread| thread.join().unwrap_or_else(|_| lost()))
    })
}

fn kept() -> Vec<Outcome> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/hostile");
    let Ok(files) = std::fs::read_dir(&folder) else { return Vec::new() };
    let mut files: Vec<PathBuf> = files.filter_map(|file| Some(file.ok()?.path())).collect();
    files.retain(|file| file.extension().is_some_and(|end| end == "toml"));
    files.sort();
    let outcome = |file: &PathBuf| {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        on_its_own(&name.clone(), || {
            let (dice, mut findings) = (Dice::new(1), Findings::default());
            let text = std::fs::read_to_string(file).unwrap_or_default();
            findings.require("reading the scenario", !text.is_empty(), "is empty", String::new);
            one(name, text, dice, findings, true)
        })
    };
    files.iter().map(outcome).collect()
}

fn made(number: u64) -> Outcome {
    let (mut dice, mut findings) = (Dice::new(number), Findings::default());
    let text =
        findings.stage("making a scenario", || scenarios::text(&mut dice).unwrap_or_default()).unwrap_or_default();
    one(format!("case {number}"), text, dice, findings, false)
}

fn one(name: String, text: String, mut dice: Dice, mut findings: Findings, is_kept: bool) -> Outcome {
    let scenario = way::scenario_of(&text, &mut findings);
    findings.require("reading the scenario", scenario.is_some() || !is_kept, "is refused", String::new);
    let mut was_measured = false;
    if let Some(scenario) = &scenario {
        let measured = way::go(scenario, &mut dice, &mut findings);
        was_measured = measured.is_some();
        if is_kept || dice.one_in(ON_SCREEN) {
            screen::show(scenario, measured, &mut dice, &mut findings);
        }
    }
    let Findings { all, longest } = findings;
    Outcome { name, text, findings: all, longest, was_accepted: scenario.is_some(), was_measured }
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("whole-way")
}

fn keep(outcome: &Outcome) {
    let mut text = format!("# {}\n", outcome.name);
    for Finding { stage, what, detail } in &outcome.findings {
        let _ = writeln!(text, "# {stage} {what} {}", detail.replace('\n', " "));
    }
    let path = folder().join(format!("{}.toml", outcome.name.replace(' ', "-").trim_end_matches(".toml")));
    let written = std::fs::create_dir_all(folder()).and_then(|()| std::fs::write(&path, text + &outcome.text));
    match written {
        Ok(()) => println!("{}", path.display()),
        Err(error) => println!("{}: {error}", path.display()),
    }
}

fn end_at(number: u64) -> ! {
    let text = scenarios::text(&mut Dice::new(number)).unwrap_or_default();
    println!("case {number}, {}, does not end:\n{text}", stage_of(&format!("case {number}")));
    std::process::exit(1)
}
