//! Lines for all who have connected to a WebSocket.

use std::io;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Duration;

use tungstenite::{Message, WebSocket};

use crate::messages::limits;

/// Limits those who listen at the same time.
const MOST: usize = 32;

/// A listener that takes nothing for this long is given up.
const PATIENCE: Duration = Duration::from_secs(2);

/// Sends lines to all who have connected.
pub struct Broadcast {
    address: SocketAddr,
    arriving: Receiver<WebSocket<TcpStream>>,
    listeners: Vec<WebSocket<TcpStream>>,
}

impl Broadcast {
    /// Waits for listeners at an address: `:9000` is a port that only this machine reaches.
    ///
    /// # Errors
    /// Where nobody can listen at that address.
    pub fn at(address: &str) -> io::Result<Self> {
        let address = address.strip_prefix("ws://").unwrap_or(address);
        let socket = match address.strip_prefix(':') {
            Some(port) => TcpListener::bind(format!("127.0.0.1:{port}"))?,
            None => TcpListener::bind(address)?,
        };
        let address = socket.local_addr()?;
        let (sender, arriving) = channel();
        thread::Builder::new().name("listeners".to_owned()).spawn(move || {
            for stream in socket.incoming().flatten() {
                stream.set_read_timeout(Some(PATIENCE)).ok();
                stream.set_write_timeout(Some(PATIENCE)).ok();
                if let Ok(listener) = tungstenite::accept_with_config(stream, Some(limits()))
                    && sender.send(listener).is_err()
                {
                    return;
                }
            }
        })?;
        Ok(Self { address, arriving, listeners: Vec::new() })
    }

    /// The address at which it waits.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Sends a line. One who has gone, or takes nothing, is forgotten.
    pub fn send(&mut self, line: &str) {
        while let Ok(listener) = self.arriving.try_recv() {
            if self.listeners.len() < MOST {
                self.listeners.push(listener);
            }
        }
        self.listeners.retain_mut(|listener| listener.send(Message::text(line)).is_ok());
    }
}
