//! Messages of the page that embeds this one, and the answers to them.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use kalmanscope::share::message::{self, LONGEST, Refusal};
use kalmanscope_core::Document;
use wasm_bindgen::prelude::*;
use web_sys::{MessageEvent, Window};

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_namespace = JSON, catch)]
    fn stringify(value: &JsValue) -> Result<JsValue, JsValue>;
    #[wasm_bindgen(js_namespace = JSON, catch)]
    fn parse(text: &str) -> Result<JsValue, JsValue>;
}

/// Limits the messages that wait for a frame.
const MOST: usize = 100;

/// The messages that wait.
pub(super) struct Messages {
    waiting: Rc<RefCell<VecDeque<Message>>>,
    /// The page listens for as long as this lives.
    _listener: Closure<dyn FnMut(MessageEvent)>,
}

/// A message as JSON, and the window that has sent it.
pub(super) struct Message {
    pub(super) text: String,
    sender: Window,
    origin: String,
}

impl Messages {
    /// Listens to the page that embeds this one, and tells that page that it is ready. `None` if no page embeds it.
    pub(super) fn listen(ctx: &egui::Context) -> Option<Self> {
        let window = web_sys::window()?;
        let parent = window.parent().ok()??;
        if parent == window {
            return None;
        }
        let waiting: Rc<RefCell<VecDeque<Message>>> = Rc::default();
        let listener = {
            let (waiting, ctx, parent) = (Rc::clone(&waiting), ctx.clone(), parent.clone());
            Closure::new(move |event: MessageEvent| match taken(&event, &parent) {
                Ok(_) if waiting.borrow().len() >= MOST => log::warn!("A message is ignored: {MOST} others wait."),
                Ok(message) => {
                    waiting.borrow_mut().push_back(message);
                    ctx.request_repaint();
                }
                Err(reason) => log::warn!("A message is ignored: {reason}."),
            })
        };
        window.add_event_listener_with_callback("message", listener.as_ref().unchecked_ref()).ok()?;
        // The message has no contents of the screen, so that any origin may read it.
        post(&parent, &message::ready(), "*");
        Some(Self { waiting, _listener: listener })
    }

    /// The oldest message.
    pub(super) fn next(&self) -> Option<Message> {
        self.waiting.borrow_mut().pop_front()
    }
}

impl Message {
    /// Answers the window that has sent the message, unless it shows a page of another origin by now.
    pub(super) fn answer(&self, answer: &Document) {
        // A page from a file, or in a sandbox, has an origin that cannot be named.
        let origin = if self.origin == "null" { "*" } else { &self.origin };
        post(&self.sender, answer, origin);
    }

    /// Says why the message is not followed: on the console, and to the sender of one of ours.
    pub(super) fn refuse(&self, refusal: &Refusal) {
        log::warn!("A message is ignored: {}", refusal.reason);
        if let Some(answer) = refusal.answer() {
            self.answer(&answer);
        }
    }
}

/// The message of an event, if the page that embeds this one has sent it.
fn taken(event: &MessageEvent, parent: &Window) -> Result<Message, &'static str> {
    let sender = event.source().map(JsValue::from);
    if sender.as_ref() != Some(parent.as_ref()) {
        return Err("it does not come from the page that embeds this one");
    }
    let text = stringify(&event.data()).ok().and_then(|text| text.as_string()).ok_or("it cannot be written as JSON")?;
    if text.len() > LONGEST {
        return Err("it is too long");
    }
    Ok(Message { text, sender: parent.clone(), origin: event.origin() })
}

fn post(window: &Window, message: &Document, origin: &str) {
    let sent =
        parse(&Document::json(message).unwrap_or_default()).and_then(|message| window.post_message(&message, origin));
    if let Err(error) = sent {
        log::warn!("A message cannot be sent: {error:?}");
    }
}
