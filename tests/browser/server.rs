//! A minimal static file server on loopback.

use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::{fs, io, thread};

pub(crate) struct Server {
    address: SocketAddr,
    is_stopped: Arc<AtomicBool>,
}

impl Server {
    pub(crate) fn start(folder: PathBuf) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
        let server = Self { address: listener.local_addr()?, is_stopped: Arc::default() };
        let is_stopped = Arc::clone(&server.is_stopped);
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                if is_stopped.load(Ordering::Relaxed) {
                    break;
                }
                let folder = folder.clone();
                // A browser may disconnect in the middle of an answer.
                thread::spawn(move || answer(&stream, &folder).ok());
            }
        });
        Ok(server)
    }

    pub(crate) fn page(&self) -> String {
        format!("http://{}/{FOLDER}", self.address)
    }

    pub(crate) fn stop(&self) {
        self.is_stopped.store(true, Ordering::Relaxed);
        // The listener waits for one more connection, and is closed after it.
        while TcpStream::connect(self.address).is_ok() {
            thread::yield_now();
        }
    }
}

/// The folder of the page on the server: its links must not begin at the root.
const FOLDER: &str = "some/folder/";

fn answer(mut stream: &TcpStream, folder: &Path) -> io::Result<()> {
    let mut request = String::new();
    let mut reader = BufReader::new(stream);
    reader.read_line(&mut request)?;
    let mut takes_brotli = false;
    let mut header = String::new();
    while reader.read_line(&mut header)? > 2 {
        let (name, value) = header.split_once(':').unwrap_or_default();
        takes_brotli |= name.eq_ignore_ascii_case("accept-encoding") && value.contains("br");
        header.clear();
    }
    let path = request.split(' ').nth(1).and_then(|path| path.split('?').next()).unwrap_or_default();
    let name =
        path.trim_start_matches('/').strip_prefix(FOLDER).map(|name| if name.is_empty() { "index.html" } else { name });
    // The page has no subfolders, so a name with a slash is invalid.
    let name = name.filter(|name| !name.contains('/')).unwrap_or_default();
    let brotli = fs::read(folder.join(format!("{name}.br"))).ok().filter(|_| takes_brotli);
    let encoding = if brotli.is_some() { "Content-Encoding: br\r\n" } else { "" };
    let body = brotli.or_else(|| fs::read(folder.join(name)).ok());
    let (status, kind, body) = match body {
        Some(body) => ("200 OK", media_type(name), body),
        None => ("404 Not Found", "text/plain", b"There is no such file.".to_vec()),
    };
    let length = body.len();
    let policy = policy(folder).map(|policy| format!("Content-Security-Policy: {policy}\r\n")).unwrap_or_default();
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\n{encoding}{policy}Content-Length: {length}\r\nConnection: close\r\n\r\n"
    )?;
    stream.write_all(&body)
}

/// The policy in the page, which a server may send with every file: then it binds the service worker too.
fn policy(folder: &Path) -> Option<String> {
    let page = fs::read_to_string(folder.join("index.html")).ok()?;
    let (_, rest) = page.split_once("http-equiv=\"Content-Security-Policy\" content=\"")?;
    Some(rest.split_once('"')?.0.to_owned())
}

fn media_type(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript",
        Some("wasm") => "application/wasm",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("css") => "text/css",
        _ => "application/octet-stream",
    }
}
