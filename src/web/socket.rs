//! Readings of a scenario from a WebSocket of this device, whose messages are lines.

use std::cell::RefCell;
use std::rc::Rc;

use egui::Context;
use kalmanscope::sensor::{Readings, Sensor};
use kalmanscope_core::Scenario;
use kalmanscope_sources::{BadLine, Lines, StreamRow};
use wasm_bindgen::JsCast as _;
use wasm_bindgen::prelude::*;
use web_sys::{MessageEvent, WebSocket};

/// A port of this device, whose lines tell the input and the sensors of a scenario.
pub(super) struct Socket {
    address: String,
    lines: Lines,
    heard: Rc<RefCell<Heard>>,
    /// The connection of the measurement that runs.
    open: RefCell<Option<Open>>,
}

/// The lines so far.
#[derive(Default)]
struct Heard {
    lines: usize,
    left_out: usize,
    why: Option<BadLine>,
}

/// A connection, for as long as this lives.
struct Open {
    socket: WebSocket,
    _messages: Closure<dyn FnMut(MessageEvent)>,
    _end: Closure<dyn FnMut()>,
}

impl Socket {
    pub(super) fn new(scenario: &Scenario, port: u16) -> Self {
        // The page's policy allows no other host.
        let address = format!("ws://localhost:{port}");
        Self { address, lines: Lines::new(scenario), heard: Rc::default(), open: RefCell::default() }
    }

    fn open(&self, ctx: &Context, to: &Readings<StreamRow>) -> Result<Open, JsValue> {
        let socket = WebSocket::new(&self.address)?;
        let messages = {
            let (ctx, to, heard, mut lines) = (ctx.clone(), to.clone(), Rc::clone(&self.heard), self.lines.clone());
            Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
                // Bytes are no lines.
                let text = event.data().as_string().unwrap_or_else(|| "\u{fffd}".to_owned());
                let readings = heard.borrow_mut().take(&text, &mut lines);
                to.put(&readings, &ctx);
            })
        };
        let end = {
            let (ctx, to, address) = (ctx.clone(), to.clone(), self.address.clone());
            Closure::<dyn FnMut()>::new(move || match to.count() {
                0 => to.refuse(format!("Nothing answers at {address}, or it has ended without a reading"), &ctx),
                _ => to.end(&ctx),
            })
        };
        socket.set_onmessage(Some(messages.as_ref().unchecked_ref()));
        // Browsers say nothing of the reason, and an error is always followed by this.
        socket.set_onclose(Some(end.as_ref().unchecked_ref()));
        Ok(Open { socket, _messages: messages, _end: end })
    }
}

impl Sensor<StreamRow> for Socket {
    fn begin(&self, ctx: &Context, to: &Readings<StreamRow>) {
        self.end();
        *self.heard.borrow_mut() = Heard::default();
        match self.open(ctx, to) {
            Ok(open) => *self.open.borrow_mut() = Some(open),
            Err(_) => to.refuse(format!("The browser does not let this page connect to {}", self.address), ctx),
        }
    }

    fn end(&self) {
        self.open.borrow_mut().take();
    }

    fn hint(&self) -> String {
        let Heard { lines, left_out, why } = &*self.heard.borrow();
        let why = why.as_ref().map_or_else(String::new, |why| format!(": {why}"));
        format!("{lines} lines have come from {}, {left_out} of which told nothing{why}.", self.address)
    }
}

impl Heard {
    /// The readings in the lines of a message.
    fn take(&mut self, message: &str, lines: &mut Lines) -> Vec<StreamRow> {
        let mut readings = Vec::new();
        for line in message.lines() {
            self.lines += 1;
            match lines.read(line.as_bytes()) {
                Ok(row) => readings.extend(row),
                Err(reason) => (self.left_out, self.why) = (self.left_out + 1, Some(reason)),
            }
        }
        readings
    }
}

impl Drop for Open {
    fn drop(&mut self) {
        self.socket.set_onmessage(None);
        self.socket.set_onclose(None);
        self.socket.close().ok();
    }
}
