//! The accelerometer behind a page: the browser's motion events.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use egui::{Context, pos2};
use kalmanscope::sensor::{Acceleration, ReadingQueue, SensorDevice};
use wasm_bindgen::JsCast as _;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;
use web_sys::{DeviceMotionEvent, MouseEvent, Window};

use super::object::{call, get};

const BEGIN: &str = "Start measuring";

pub(super) struct MotionSensor {
    shared: Rc<SharedMotion>,
    _clicks: Closure<dyn FnMut(MouseEvent)>,
}

type Listener = Closure<dyn FnMut(DeviceMotionEvent)>;

#[derive(Default)]
struct SharedMotion {
    listener: RefCell<Option<Listener>>,
    asked: RefCell<Option<js_sys::Promise>>,
    /// Counts beginnings and ends: a permission that comes after an end begins nothing.
    turn: Cell<u32>,
}

impl MotionSensor {
    pub(super) fn of_page(ctx: &Context) -> Option<Self> {
        let window = web_sys::window()?;
        get(&window, "DeviceMotionEvent").filter(|kind| !kind.is_undefined())?;
        let shared: Rc<SharedMotion> = Rc::default();
        let clicks = {
            let (shared, ctx) = (Rc::clone(&shared), ctx.clone());
            // Safari answers the question only inside the event of a tap, before the frame that sees the tap.
            Closure::<dyn FnMut(MouseEvent)>::new(move |event: MouseEvent| {
                let at = pos2(event.client_x() as f32, event.client_y() as f32);
                if kalmanscope::probe::place(&ctx, BEGIN).is_some_and(|button| button.contains(at)) {
                    *shared.asked.borrow_mut() = ask();
                }
            })
        };
        window.add_event_listener_with_callback_and_bool("click", clicks.as_ref().unchecked_ref(), true).ok()?;
        Some(Self { shared, _clicks: clicks })
    }
}

fn ask() -> Option<js_sys::Promise> {
    let kind = get(&js_sys::global(), "DeviceMotionEvent")?;
    call(&kind, "requestPermission", &[]).ok()?.dyn_into().ok()
}

impl SensorDevice<Acceleration> for MotionSensor {
    fn begin(&self, ctx: &Context, to: &ReadingQueue<Acceleration>) {
        self.end();
        let Some(window) = web_sys::window() else { return };
        if !window.is_secure_context() {
            let reason = "The browser gives motion only to pages from https, or from this machine";
            return to.refuse(reason.to_owned(), ctx);
        }
        let question = self.shared.asked.borrow_mut().take().or_else(ask);
        let turn = self.shared.turn.get();
        let (shared, ctx, to) = (Rc::clone(&self.shared), ctx.clone(), to.clone());
        let Some(question) = question else { return listen(&window, &shared, &ctx, &to) };
        wasm_bindgen_futures::spawn_local(async move {
            let answer = JsFuture::from(question).await;
            if shared.turn.get() != turn {
                return;
            }
            match answer {
                Ok(answer) if answer.as_string().as_deref() == Some("granted") => listen(&window, &shared, &ctx, &to),
                _ => to.refuse("The browser may not read the motion of this device".to_owned(), &ctx),
            }
        });
    }

    fn end(&self) {
        self.shared.turn.set(self.shared.turn.get().wrapping_add(1));
        let Some(listener) = self.shared.listener.borrow_mut().take() else { return };
        if let Some(window) = web_sys::window() {
            window.remove_event_listener_with_callback("devicemotion", listener.as_ref().unchecked_ref()).ok();
        }
    }

    fn hint(&self) -> String {
        "Computers have no accelerometer; a phone has one, and the browser may ask for permission.".to_owned()
    }
}

fn listen(window: &Window, shared: &SharedMotion, ctx: &Context, to: &ReadingQueue<Acceleration>) {
    let (ctx, to) = (ctx.clone(), to.clone());
    let listener = Listener::new(move |event: DeviceMotionEvent| {
        let Some(told) = event.acceleration_including_gravity() else { return };
        // A computer without the sensor sends events without numbers.
        if let (Some(x), Some(y), Some(z)) = (told.x(), told.y(), told.z()) {
            to.put(&[[0.001 * event.time_stamp(), x, y, z]], &ctx);
        }
    });
    let added = window.add_event_listener_with_callback("devicemotion", listener.as_ref().unchecked_ref());
    if added.is_ok() {
        *shared.listener.borrow_mut() = Some(listener);
    }
}
