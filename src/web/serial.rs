//! An accelerometer behind a serial port: Web Serial, which Chromium's browsers have.
//!
//! Bytes at another rate than the device's are no text, so the usual rates are tried in turn.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use egui::Context;
use js_sys::{Reflect, Uint8Array};
use kalmanscope::sensor::{Acceleration, Readings, Sensor};
use kalmanscope_sources::{Accelerations, LONGEST};
use wasm_bindgen::JsCast as _;
use wasm_bindgen::prelude::*;

use super::object::{awaited, call, get, words};

/// The rates that are tried, the likeliest first \[bits a second\].
const RATES: [u32; 6] = [115_200, 9_600, 57_600, 230_400, 38_400, 19_200];

/// So many bytes tell whether they are text, of which this share is then.
const ENOUGH: usize = 200;
const TEXT: f64 = 0.9;

/// The serial ports of this page.
pub(super) struct Serial {
    serial: JsValue,
    shared: Rc<Shared>,
}

#[derive(Default)]
struct Shared {
    /// Counts beginnings and ends: what reads in an earlier turn stops.
    turn: Cell<u32>,
    /// Reads the port of the present turn.
    reader: RefCell<Option<JsValue>>,
    lines: Cell<usize>,
    left_out: Cell<usize>,
    rate: Cell<u32>,
}

/// The reason to stop reading.
enum End {
    /// The bytes are no text.
    Unreadable,
    /// The port has no more, or an error.
    Over(String),
    /// Nobody wants it any more.
    Unwanted,
}

impl Serial {
    /// The serial ports of this page. `None` where the browser has no way to them.
    pub(super) fn of_page() -> Option<Self> {
        let navigator = JsValue::from(web_sys::window()?.navigator());
        let serial = get(&navigator, "serial").filter(JsValue::is_object)?;
        Some(Self { serial, shared: Rc::default() })
    }
}

impl Sensor<Acceleration> for Serial {
    fn begin(&self, ctx: &Context, to: &Readings<Acceleration>) {
        self.end();
        let (shared, ctx, to) = (Rc::clone(&self.shared), ctx.clone(), to.clone());
        shared.lines.set(0);
        shared.left_out.set(0);
        let turn = shared.turn.get();
        let asked = call(&self.serial, "requestPort", &[]);
        wasm_bindgen_futures::spawn_local(async move {
            let port = match awaited(asked).await {
                Ok(port) => port,
                Err(error) => return to.refuse(format!("No port was chosen ({})", words(&error)), &ctx),
            };
            // The user may have left the measurement while the browser asked.
            if shared.turn.get() != turn {
                return;
            }
            for rate in RATES {
                shared.rate.set(rate);
                let end = read(&port, rate, turn, &shared, &ctx, &to).await;
                match end {
                    End::Unreadable => {}
                    End::Unwanted => return,
                    End::Over(reason) if to.count() == 0 => return to.refuse(reason, &ctx),
                    End::Over(_) => return to.end(&ctx),
                }
            }
            to.refuse("The port tells no text at any usual rate".to_owned(), &ctx);
        });
    }

    fn end(&self) {
        self.shared.turn.set(self.shared.turn.get().wrapping_add(1));
        if let Some(reader) = self.shared.reader.borrow_mut().take() {
            // The reading task then gets an end, and closes the port.
            let _ = call(&reader, "cancel", &[]);
        }
    }

    fn hint(&self) -> String {
        let Shared { lines, left_out, rate, .. } = &*self.shared;
        format!(
            "{} lines have come at {} bits a second, {} of which told nothing.",
            lines.get(),
            rate.get(),
            left_out.get()
        )
    }
}

/// Opens a port at a rate, reads it to its end, and closes it.
async fn read(
    port: &JsValue,
    rate: u32,
    turn: u32,
    shared: &Shared,
    ctx: &Context,
    to: &Readings<Acceleration>,
) -> End {
    let options = js_sys::Object::new();
    let _ = Reflect::set(&options, &"baudRate".into(), &rate.into());
    if let Err(error) = awaited(call(port, "open", &[&options])).await {
        return End::Over(format!("The port cannot be opened ({})", words(&error)));
    }
    let reader = get(port, "readable").ok_or(JsValue::UNDEFINED).and_then(|all| call(&all, "getReader", &[]));
    let end = match reader {
        Ok(reader) => {
            *shared.reader.borrow_mut() = Some(reader.clone());
            let end = follow(&reader, turn, shared, ctx, to).await;
            let _ = awaited(call(&reader, "cancel", &[])).await;
            let _ = call(&reader, "releaseLock", &[]);
            end
        }
        Err(error) => End::Over(format!("The port cannot be read ({})", words(&error))),
    };
    let _ = awaited(call(port, "close", &[])).await;
    end
}

/// Hands on the readings in the lines that come.
async fn follow(reader: &JsValue, turn: u32, shared: &Shared, ctx: &Context, to: &Readings<Acceleration>) -> End {
    let mut parser = Accelerations::default();
    let mut line = Vec::new();
    let (mut bytes, mut printable) = (0_usize, 0_usize);
    let now = || js_sys::Date::now() * 1e-3;
    let begin = now();
    loop {
        let next = match awaited(call(reader, "read", &[])).await {
            Ok(next) => next,
            // Bits at another rate than the device's have no frame.
            Err(error) if to.count() == 0 && words(&error).contains("Framing") => return End::Unreadable,
            Err(error) => return End::Over(format!("The port cannot be read ({})", words(&error))),
        };
        if shared.turn.get() != turn {
            return End::Unwanted;
        }
        if get(&next, "done").is_some_and(|done| done.is_truthy()) {
            return End::Over("The port has ended without a reading".to_owned());
        }
        let Some(piece) = get(&next, "value").and_then(|value| value.dyn_into::<Uint8Array>().ok()) else { continue };
        for byte in piece.to_vec() {
            if bytes < ENOUGH {
                bytes += 1;
                printable += usize::from(matches!(byte, b' '..=b'~' | b'\t' | b'\r' | b'\n'));
                if bytes == ENOUGH && (printable as f64) < TEXT * ENOUGH as f64 {
                    return End::Unreadable;
                }
            }
            if byte != b'\n' {
                if line.len() <= LONGEST {
                    line.push(byte);
                }
                continue;
            }
            shared.lines.set(shared.lines.get() + 1);
            if let Err(reason) = parser.take(&line, now() - begin) {
                return End::Over(format!("The port tells no readings: {reason}"));
            }
            shared.left_out.set(parser.left_out());
            let readings = parser.readings();
            if !readings.is_empty() && !to.put(&readings, ctx) {
                return End::Over(String::new());
            }
            line.clear();
        }
    }
}
