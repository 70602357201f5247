//! Remote sensors: a source of lines, by the network, a serial port or a pipe.

use std::cell::RefCell;
use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Instant;

use egui::Context;
use kalmanscope::sensor::{Acceleration, ReadingQueue, SensorDevice, SensorReading};
use kalmanscope_core::Scenario;
use kalmanscope_sources::{Accelerations, LineReader, StreamRow, open, read_line};

pub(super) struct Listening {
    pub(super) source: String,
    pub(super) scenario: Option<Scenario>,
}

pub(super) trait Parser: Clone + Send + 'static {
    type Reading: SensorReading + Send;

    /// The readings of a line that arrived at some time \[s\]; or the reason why no later line can have any.
    fn take(&mut self, line: &[u8], arrival: f64) -> Result<Vec<Self::Reading>, String>;

    fn left_out(&self) -> (usize, &str);
}

pub(super) struct SensorListener<P: Parser> {
    name: String,
    shared: Arc<SharedListener<P::Reading>>,
    parser: P,
    thread: RefCell<Option<JoinHandle<()>>>,
}

struct SharedListener<T>(Mutex<ListenerState<T>>);

struct ListenerState<T> {
    lines: usize,
    left_out: (usize, String),
    to: Option<(Context, ReadingQueue<T>)>,
}

impl<T: SensorReading> SharedListener<T> {
    fn heard(&self) -> MutexGuard<'_, ListenerState<T>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn end(&self, reason: String) {
        match &self.heard().to {
            Some((ctx, to)) if to.count() == 0 => to.refuse(reason, ctx),
            Some((ctx, to)) => to.end(ctx),
            None => {}
        }
    }

    fn follow(&self, name: &str, mut parser: impl Parser<Reading = T>) -> io::Result<Option<String>> {
        let mut source = open(name)?;
        let (mut line, begin) = (Vec::new(), Instant::now());
        while read_line(&mut source, &mut line)? {
            let readings = match parser.take(&line, begin.elapsed().as_secs_f64()) {
                Ok(readings) => readings,
                Err(reason) => return Ok(Some(reason)),
            };
            let mut heard = self.heard();
            heard.lines += 1;
            let (count, why) = parser.left_out();
            if count != heard.left_out.0 {
                heard.left_out = (count, why.to_owned());
            }
            if let Some((ctx, to)) = &heard.to {
                to.put(&readings, ctx);
            }
        }
        Ok(None)
    }
}

impl<P: Parser> SensorListener<P> {
    pub(super) fn new(name: &str, parser: P) -> Self {
        let heard = SharedListener(Mutex::new(ListenerState { lines: 0, left_out: (0, String::new()), to: None }));
        Self { name: name.to_owned(), shared: Arc::new(heard), parser, thread: RefCell::default() }
    }
}

impl<P: Parser> SensorDevice<P::Reading> for SensorListener<P> {
    fn begin(&self, ctx: &Context, to: &ReadingQueue<P::Reading>) {
        self.shared.heard().to = Some((ctx.clone(), to.clone()));
        let mut thread = self.thread.borrow_mut();
        // Nothing can end a thread that waits for a line, so the next beginning uses it again.
        if thread.as_ref().is_some_and(|thread| !thread.is_finished()) {
            return;
        }
        let (name, parser, shared) = (self.name.clone(), self.parser.clone(), Arc::clone(&self.shared));
        let read = move || {
            shared.end(match shared.follow(&name, parser) {
                Ok(None) => format!("{name} has ended without a reading"),
                Ok(Some(reason)) => format!("{name} tells no readings: {reason}"),
                Err(error) => format!("{name} cannot be read: {error}"),
            });
        };
        match thread::Builder::new().name("listener".to_owned()).spawn(read) {
            Ok(begun) => *thread = Some(begun),
            Err(error) => to.refuse(format!("{} cannot be read: {error}", self.name), ctx),
        }
    }

    fn end(&self) {
        self.shared.heard().to = None;
    }

    fn hint(&self) -> String {
        let heard = self.shared.heard();
        let (count, why) = &heard.left_out;
        let why = if why.is_empty() { String::new() } else { format!(": {why}") };
        format!("{} lines have come from {}, {count} of which told nothing{why}.", heard.lines, self.name)
    }
}

impl Parser for Accelerations {
    type Reading = Acceleration;

    fn take(&mut self, line: &[u8], arrival: f64) -> Result<Vec<Acceleration>, String> {
        self.take(line, arrival).map_err(|reason| reason.to_string())?;
        Ok(self.readings())
    }

    fn left_out(&self) -> (usize, &str) {
        (self.left_out(), "")
    }
}

#[derive(Clone)]
pub(super) struct ScenarioParser {
    lines: LineReader,
    left_out: usize,
    why: String,
}

impl ScenarioParser {
    pub(super) fn new(scenario: &Scenario) -> Self {
        Self { lines: LineReader::new(scenario), left_out: 0, why: String::new() }
    }
}

impl Parser for ScenarioParser {
    type Reading = StreamRow;

    fn take(&mut self, line: &[u8], _: f64) -> Result<Vec<StreamRow>, String> {
        Ok(match self.lines.read(line) {
            Ok(row) => row.into_iter().collect(),
            Err(reason) => {
                (self.left_out, self.why) = (self.left_out + 1, reason.to_string());
                Vec::new()
            }
        })
    }

    fn left_out(&self) -> (usize, &str) {
        (self.left_out, &self.why)
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
        let name = format!("tcp://{}", server.local_addr().expect("an address"));
        let listened = SensorListener::new(&name, Accelerations::default());
        let (ctx, first) = (Context::default(), ReadingQueue::default());
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
        let second = ReadingQueue::default();
        listened.begin(&ctx, &second);
        tell(60, 80);
        wait_until(|| second.count() == 20, "the second readings");
        assert_eq!((first.count(), second.refusal()), (50, None));
    }

    #[test]
    fn what_tells_nothing_says_why() {
        let folder = std::env::temp_dir().join(format!("kalmanscope-listen-{}.txt", std::process::id()));
        for (text, words) in [("", "has ended without a reading"), (&"1,2\n".repeat(100), "tells no readings")] {
            std::fs::write(&folder, text).expect("written");
            let (ctx, to) = (Context::default(), ReadingQueue::default());
            let listened = SensorListener::new(&folder.to_string_lossy(), Accelerations::default());
            listened.begin(&ctx, &to);
            wait_until(|| to.refusal().is_some(), words);
            let refusal = to.refusal().expect("it is refused");
            assert!(refusal.contains(words), "{refusal}");
        }
        std::fs::remove_file(folder).expect("it is there");
        let (ctx, to) = (Context::default(), ReadingQueue::default());
        SensorListener::new("tcp://127.0.0.1:1", Accelerations::default()).begin(&ctx, &to);
        wait_until(|| to.refusal().is_some_and(|refusal| refusal.contains("refused")), "nobody is there");
    }
}
