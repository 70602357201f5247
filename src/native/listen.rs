//! An accelerometer elsewhere: a source that tells lines, by the network, a serial port or a pipe.

use std::cell::RefCell;
use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Instant;

use egui::Context;
use kalmanscope::sensor::{Acceleration, Readings, Sensor};
use kalmanscope_sources::{Accelerations, NoAxes, open, read_line};

/// A source by its name. It stays open once it has been begun: its header comes once.
pub(super) struct Listened {
    name: String,
    shared: Arc<Shared>,
    thread: RefCell<Option<JoinHandle<()>>>,
}

#[derive(Default)]
struct Shared(Mutex<Told>);

/// The count of the lines so far, and the window that wants their readings.
#[derive(Default)]
struct Told {
    lines: usize,
    left_out: usize,
    to: Option<(Context, Readings<Acceleration>)>,
}

impl Shared {
    fn told(&self) -> MutexGuard<'_, Told> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells the window that waits for readings, and has none, why there are none.
    fn refuse(&self, reason: String) {
        if let Some((ctx, to)) = &self.told().to
            && to.count() == 0
        {
            to.refuse(reason, ctx);
        }
    }

    /// Reads the source to its end. Returns why it tells nothing.
    fn read(&self, name: &str) -> String {
        match self.follow(name) {
            Ok(None) => format!("{name} has ended without a reading"),
            Ok(Some(reason)) => format!("{name} tells no accelerations: {reason}"),
            Err(error) => format!("{name} cannot be read: {error}"),
        }
    }

    fn follow(&self, name: &str) -> io::Result<Option<NoAxes>> {
        let mut source = open(name)?;
        let (mut accelerations, mut line, begin) = (Accelerations::default(), Vec::new(), Instant::now());
        while read_line(&mut source, &mut line)? {
            if let Err(reason) = accelerations.take(&line, begin.elapsed().as_secs_f64()) {
                return Ok(Some(reason));
            }
            let readings = accelerations.readings();
            let mut told = self.told();
            told.lines += 1;
            told.left_out = accelerations.left_out();
            if let Some((ctx, to)) = &told.to {
                to.put(&readings, ctx);
            }
        }
        Ok(None)
    }
}

impl Listened {
    pub(super) fn new(name: &str) -> Self {
        Self { name: name.to_owned(), shared: Arc::default(), thread: RefCell::default() }
    }
}

impl Sensor<Acceleration> for Listened {
    fn begin(&self, ctx: &Context, to: &Readings<Acceleration>) {
        self.shared.told().to = Some((ctx.clone(), to.clone()));
        let mut thread = self.thread.borrow_mut();
        if thread.as_ref().is_some_and(|thread| !thread.is_finished()) {
            return;
        }
        let (name, shared) = (self.name.clone(), Arc::clone(&self.shared));
        let read = move || {
            let reason = shared.read(&name);
            shared.refuse(reason);
        };
        match thread::Builder::new().name("listener".to_owned()).spawn(read) {
            Ok(begun) => *thread = Some(begun),
            Err(error) => to.refuse(format!("{} cannot be read: {error}", self.name), ctx),
        }
    }

    fn end(&self) {
        self.shared.told().to = None;
    }

    fn hint(&self) -> String {
        let told = self.shared.told();
        format!("{} lines have come from {}, {} of which told nothing.", told.lines, self.name, told.left_out)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;
    use std::net::TcpListener;
    use std::time::Duration;

    use super::*;

    fn wait_until(is_so: impl Fn() -> bool, what: &str) {
        let begin = Instant::now();
        while !is_so() {
            assert!(begin.elapsed() < Duration::from_secs(20), "{what}");
            thread::sleep(Duration::from_millis(5));
        }
    }

    #[test]
    fn readings_go_to_whom_wants_them_and_the_source_stays_open() {
        let server = TcpListener::bind("127.0.0.1:0").expect("a port");
        let listened = Listened::new(&format!("tcp://{}", server.local_addr().expect("an address")));
        let (ctx, first) = (Context::default(), Readings::default());
        listened.begin(&ctx, &first);
        let (mut to, _) = server.accept().expect("it connects");
        writeln!(to, "t,ax,ay,az").expect("sent");
        let mut tell = |from: u32, until: u32| {
            for k in from..until {
                writeln!(to, "{},0,0.1,9.8", 0.01 * f64::from(k)).expect("sent");
            }
        };
        tell(0, 50);
        wait_until(|| first.count() == 50, "the first readings");
        listened.end();
        tell(50, 60);
        wait_until(|| listened.hint().starts_with("61 lines"), "lines that nobody wants");
        let second = Readings::default();
        listened.begin(&ctx, &second);
        tell(60, 80);
        wait_until(|| second.count() == 20, "the second readings");
        assert_eq!((first.count(), second.refusal()), (50, None));
    }

    #[test]
    fn what_tells_nothing_says_why() {
        let folder = std::env::temp_dir().join(format!("kalmanscope-listen-{}.txt", std::process::id()));
        for (text, words) in [("", "has ended without a reading"), (&"1,2\n".repeat(100), "tells no accelerations")] {
            std::fs::write(&folder, text).expect("written");
            let (ctx, to) = (Context::default(), Readings::default());
            let listened = Listened::new(&folder.to_string_lossy());
            listened.begin(&ctx, &to);
            wait_until(|| to.refusal().is_some(), words);
            let refusal = to.refusal().expect("it is refused");
            assert!(refusal.contains(words), "{refusal}");
        }
        std::fs::remove_file(folder).expect("it is there");
        let (ctx, to) = (Context::default(), Readings::default());
        Listened::new("tcp://127.0.0.1:1").begin(&ctx, &to);
        wait_until(|| to.refusal().is_some_and(|refusal| refusal.contains("refused")), "nobody is there");
    }
}
