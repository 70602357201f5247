//! Two clocks: wall time, and the processor time of this thread, which a busy machine does not lengthen.

use std::time::{Duration, Instant};

/// A moment on both clocks.
#[derive(Clone, Copy)]
pub(crate) struct Moment {
    wall: Instant,
    cpu: Duration,
}

/// The time since a moment \[ms\].
#[derive(Clone, Copy, Default)]
pub(crate) struct Elapsed {
    pub(crate) wall: f64,
    pub(crate) cpu: f64,
}

impl Moment {
    pub(crate) fn now() -> Self {
        Self { wall: Instant::now(), cpu: cpu_time() }
    }

    pub(crate) fn elapsed(self) -> Elapsed {
        let of = |time: Duration| 1e3 * time.as_secs_f64();
        Elapsed { wall: of(self.wall.elapsed()), cpu: of(cpu_time().saturating_sub(self.cpu)) }
    }
}

impl std::ops::AddAssign for Elapsed {
    fn add_assign(&mut self, other: Self) {
        self.wall += other.wall;
        self.cpu += other.cpu;
    }
}

#[cfg(target_os = "linux")]
fn cpu_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// Zero where the system's clock of a thread is not known.
#[cfg(not(target_os = "linux"))]
fn cpu_time() -> Duration {
    Duration::ZERO
}

/// The most memory that the process has had so far \[MB\], where the system tells.
pub(crate) fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix(" kB")?.trim().parse::<f64>().ok()? / 1024.0)
}
