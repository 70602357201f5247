//! Commands of WebDriver: JSON in, JSON out, one connection each.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Ipv4Addr, TcpStream};

use serde_json::{Value, json};

/// A session of a driver on this machine, which ends with it.
pub(crate) struct Client {
    port: u16,
    session: String,
}

impl Client {
    pub(crate) fn start(port: u16, capabilities: &Value) -> Result<Self, String> {
        let body = json!({ "capabilities": { "alwaysMatch": capabilities } });
        let answer = call(port, "POST", "/session", &body.to_string())?;
        let session = answer["sessionId"].as_str().ok_or("the driver has named no session")?;
        Ok(Self { port, session: format!("/session/{session}") })
    }

    /// A command with a body, such as `url`.
    pub(crate) fn post(&self, command: &str, body: &Value) -> Result<Value, String> {
        call(self.port, "POST", &format!("{}/{command}", self.session), &body.to_string())
    }

    /// Does something with the mouse or with its wheel.
    pub(crate) fn act(&self, kind: &str, actions: &[Value]) {
        let actions = json!({ "actions": [{ "type": kind, "id": kind, "actions": actions }] });
        self.post("actions", &actions).unwrap_or_else(|error| panic!("{actions}: {error}"));
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        call(self.port, "DELETE", &self.session, "").ok();
    }
}

fn call(port: u16, method: &str, path: &str, body: &str) -> Result<Value, String> {
    let answer = exchange(port, method, path, body).map_err(|error| format!("{method} {path}: {error}"))?;
    let mut answer: Value = serde_json::from_slice(&answer).map_err(|error| format!("{method} {path}: {error}"))?;
    match answer["value"].take() {
        value if value["error"].is_string() => Err(format!("{path}: {}: {}", value["error"], value["message"])),
        value => Ok(value),
    }
}

/// Sends a request of HTTP and returns the body of the answer.
fn exchange(port: u16, method: &str, path: &str, body: &str) -> std::io::Result<Vec<u8>> {
    let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, port))?;
    write!(
        stream,
        "{method} {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Type: application/json; charset=utf-8\r\n\
         Content-Length: {}\r\nConnection: close\r\n\r\n{body}",
        body.len()
    )?;
    let (mut reader, mut line, mut length) = (BufReader::new(stream), String::new(), 0);
    while reader.read_line(&mut line)? > 0 && !line.trim().is_empty() {
        if let Some((_, value)) = line.split_once(':').filter(|(name, _)| name.eq_ignore_ascii_case("content-length")) {
            length = value.trim().parse().map_err(std::io::Error::other)?;
        }
        line.clear();
    }
    let mut answer = vec![0; length];
    reader.read_exact(&mut answer)?;
    Ok(answer)
}
