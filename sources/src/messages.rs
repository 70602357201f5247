//! The messages of a WebSocket.

use std::io::{self, Read};
use std::net::TcpStream;

use tungstenite::protocol::WebSocketConfig;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Error, Message, WebSocket};

use crate::line::LONGEST;
use crate::pieces::Pieces;

/// A connection to a server, whose messages are read as lines.
pub(crate) struct Messages {
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    pieces: Pieces,
}

/// Messages of a limited size.
pub(crate) fn limits() -> WebSocketConfig {
    WebSocketConfig::default().max_message_size(Some(16 * LONGEST)).max_frame_size(Some(16 * LONGEST))
}

impl Messages {
    pub(crate) fn connect(address: &str) -> io::Result<Self> {
        let (socket, _) = tungstenite::client::connect_with_config(address, Some(limits()), 3).map_err(of_library)?;
        Ok(Self { socket, pieces: Pieces::default() })
    }
}

fn of_library(error: Error) -> io::Error {
    match error {
        Error::Io(error) => error,
        other => io::Error::other(other),
    }
}

impl Read for Messages {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let Self { socket, pieces } = self;
        pieces.read(buffer, |piece| {
            loop {
                match socket.read() {
                    Ok(Message::Text(text)) => piece.extend_from_slice(text.as_bytes()),
                    Ok(Message::Binary(bytes)) => piece.extend_from_slice(&bytes),
                    Ok(_) => {}
                    Err(Error::ConnectionClosed | Error::AlreadyClosed) => return Ok(()),
                    Err(error) => return Err(of_library(error)),
                }
                if !piece.is_empty() {
                    return Ok(());
                }
            }
        })
    }
}
