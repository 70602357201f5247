//! Signals that end the program, as at a log-out: the state is saved first.

use super::keeper::Kept;

/// Saves the state when the system asks the program to end, and then ends it as it would have ended. A signal that the program
/// was started to ignore, as by `nohup`, stays ignored.
#[cfg(unix)]
pub(super) fn save_at_end(kept: &Kept) {
    use std::thread;

    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;

    let ignored = ignored();
    let heard = [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|signal| ignored & (1 << (signal - 1)) == 0);
    let mut signals = match Signals::new(heard) {
        Ok(signals) => signals,
        Err(error) => return log::warn!("Signals do not save the state: {error}"),
    };
    let kept = kept.clone();
    let hear = move || {
        for signal in signals.forever() {
            kept.save();
            emulate_default_handler(signal).ok();
        }
    };
    if let Err(error) = thread::Builder::new().name("signals".to_owned()).spawn(hear) {
        log::warn!("Signals do not save the state: {error}");
    }
}

/// The signals that the program was started to ignore, a bit each, as far as the system tells.
#[cfg(unix)]
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

/// The system has no such signals.
#[cfg(not(unix))]
pub(super) fn save_at_end(_: &Kept) {}
