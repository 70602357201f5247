//! Headless Chromium, driven by chromedriver.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Ipv4Addr, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use std::{fs, process, thread};

use serde_json::{Value, json};

use crate::page::Page;

/// A running chromedriver, with its browsers ended when it goes out of scope.
pub(crate) struct Driver {
    child: Child,
    port: u16,
    profile: PathBuf,
}

impl Driver {
    pub(crate) fn start() -> Self {
        let mut child = Command::new("chromedriver")
            .args(["--port=0", "--allowed-ips=127.0.0.1"])
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap_or_else(|error| panic!("chromedriver cannot be started ({error}): run ./check, which sees to it"));
        let mut lines = BufReader::new(child.stdout.take().expect("its output is piped")).lines().map_while(Result::ok);
        let port =
            lines.find_map(|line| line.split_once("successfully on port ")?.1.trim_end_matches('.').parse().ok());
        // Its output is discarded, because a full pipe would block it.
        thread::spawn(move || lines.for_each(drop));
        let Some(port) = port else {
            child.kill().ok();
            child.wait().ok();
            panic!("chromedriver has not told its port: run ./check, which sees to one that works");
        };
        let profile = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("browser-{}-{port}", process::id()));
        Self { child, port, profile }
    }

    pub(crate) fn downloads(&self) -> PathBuf {
        let folder = self.profile.join("downloads");
        fs::create_dir_all(&folder).expect("a folder can be made");
        folder
    }

    pub(crate) async fn open(&self, more: &[&str]) -> Page {
        let profile = format!("--user-data-dir={}", self.profile.display());
        let arguments = [
            "--headless=new",
            "--no-sandbox",
            "--disable-quic",
            "--no-first-run",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--disable-dev-shm-usage",
            "--window-size=1280,800",
            "--enable-unsafe-swiftshader",
            "--use-gl=angle",
            "--use-angle=swiftshader",
            &profile,
        ];
        let arguments: Vec<&str> = arguments.into_iter().chain(more.iter().copied()).collect();
        let capabilities =
            json!({ "goog:chromeOptions": { "args": arguments }, "goog:loggingPrefs": { "browser": "ALL" } });
        let client = Client::start(self.port, &capabilities)
            .unwrap_or_else(|error| panic!("Chromium cannot be started ({error}): run ./check, which sees to it"));
        Page::new(client)
    }
}

impl Drop for Driver {
    fn drop(&mut self) {
        // A killed chromedriver would leave its browsers running.
        if let Ok(mut stream) = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)) {
            stream.set_read_timeout(Some(Duration::from_secs(10))).ok();
            write!(stream, "GET /shutdown HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n").ok();
            stream.read_to_end(&mut Vec::new()).ok();
        }
        self.child.kill().ok();
        self.child.wait().ok();
        fs::remove_dir_all(&self.profile).ok();
    }
}

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
