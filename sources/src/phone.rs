//! A phone that runs phyphox with remote access: it is asked for what is new.

use std::io::{self, Read};
use std::thread;
use std::time::Duration;

use kalmanscope_core::Document;
use ureq::Agent;

use crate::pieces::Pieces;

/// The time between two questions, and the longest wait for an answer.
const BETWEEN: Duration = Duration::from_millis(100);
const PATIENCE: Duration = Duration::from_secs(5);

/// Limits an answer \[bytes\].
const LARGEST: u64 = 4_000_000;

/// The buffers of the experiments *Acceleration (with g)* and *Acceleration (without g)*.
const BUFFERS: [&str; 4] = ["acc_time", "accX", "accY", "accZ"];

/// The header of what is told.
const HEADER: &str = "t (s),ax (m/s^2),ay (m/s^2),az (m/s^2)\n";

/// Source: the phyphox wiki, *Remote-interface communication*.
pub(crate) struct Phone {
    agent: Agent,
    address: String,
    /// The time of the last reading, as the phone wrote it.
    last: Option<f64>,
    pieces: Pieces,
    has_header: bool,
}

impl Phone {
    /// Begins a measurement on the phone.
    pub(crate) fn connect(address: &str) -> io::Result<Self> {
        let agent = Agent::new_with_config(Agent::config_builder().timeout_global(Some(PATIENCE)).build());
        let address = address.trim_end_matches('/').to_owned();
        let phone = Self { agent, address, last: None, pieces: Pieces::default(), has_header: false };
        phone.ask("control?cmd=start")?;
        Ok(phone)
    }

    fn ask(&self, question: &str) -> io::Result<Document> {
        let mut answer = self.agent.get(format!("{}/{question}", self.address)).call().map_err(ureq::Error::into_io)?;
        let text = answer.body_mut().with_config().limit(LARGEST).read_to_string().map_err(ureq::Error::into_io)?;
        Document::from_json(&text).map_err(|error| io::Error::other(format!("it is no phone with phyphox: {error}")))
    }

    /// The readings after the last one, as lines.
    fn news(&mut self) -> io::Result<String> {
        let [time, axes @ ..] = BUFFERS;
        let after = self.last.map_or_else(|| "full".to_owned(), |last| format!("{last}"));
        let of = |axis: &str| match self.last {
            Some(_) => format!("&{axis}={after}%7C{time}"),
            None => format!("&{axis}={after}"),
        };
        let question = format!("get?{time}={after}{}", axes.map(of).concat());
        let answer = self.ask(&question)?;
        let missing =
            || io::Error::other("the phone has no accelerations: open an experiment with the accelerometer there");
        let columns = BUFFERS.map(|buffer| numbers(&answer, buffer)).into_iter().collect::<Option<Vec<_>>>();
        let columns = columns.ok_or_else(missing)?;
        let rows = columns.iter().map(Vec::len).min().unwrap_or_default();
        let mut text = String::new();
        for row in 0..rows {
            let cells: Vec<String> = columns.iter().map(|column| column[row].to_string()).collect();
            if self.last.is_none_or(|last| columns[0][row] > last) {
                text.push_str(&cells.join(","));
                text.push('\n');
                self.last = Some(columns[0][row]);
            }
        }
        Ok(text)
    }
}

/// The numbers of a buffer of an answer. One that is not a number ends them: the phone has not written it yet.
fn numbers(answer: &Document, buffer: &str) -> Option<Vec<f64>> {
    let Document::List(values) = answer.get("buffer")?.get(buffer)?.get("buffer")? else { return None };
    let number = |value: &Document| match value {
        Document::Number(number) => Some(*number),
        Document::Integer(number) => Some(*number as f64),
        _ => None,
    };
    Some(values.iter().map_while(number).collect())
}

impl Read for Phone {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut pieces = std::mem::take(&mut self.pieces);
        let read = pieces.read(buffer, |piece| {
            if !std::mem::replace(&mut self.has_header, true) {
                piece.extend_from_slice(HEADER.as_bytes());
                return Ok(());
            }
            loop {
                let news = self.news()?;
                if !news.is_empty() {
                    piece.extend_from_slice(news.as_bytes());
                    return Ok(());
                }
                thread::sleep(BETWEEN);
            }
        });
        self.pieces = pieces;
        read
    }
}
