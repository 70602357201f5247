//! The microphone behind a page: an audio worklet.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use egui::Context;
use kalmanscope::sensor::{ReadingQueue, SensorDevice, Sound};
use wasm_bindgen::JsCast as _;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;
use web_sys::{
    AudioContext, AudioWorkletNode, MediaDevices, MediaStream, MediaStreamConstraints, MediaStreamTrack,
    MediaTrackConstraints, MessageEvent,
};

use super::object::{get, version, words};

const WORKLET: &str = "./listen.js?v=";
const PROCESSOR: &str = "listen";

pub(super) struct Microphone {
    devices: MediaDevices,
    shared: Rc<SharedMicrophone>,
}

#[derive(Default)]
struct SharedMicrophone {
    listening: RefCell<Option<AudioCapture>>,
    turn: Cell<u32>,
}

struct AudioCapture {
    stream: MediaStream,
    context: AudioContext,
    node: AudioWorkletNode,
    _messages: Closure<dyn FnMut(MessageEvent)>,
}

impl Microphone {
    pub(super) fn of_page() -> Option<Self> {
        let navigator = web_sys::window()?.navigator();
        let has = |object: &JsValue, name: &str| get(object, name).is_some_and(|it| it.is_truthy());
        // A page that did not come by https has none.
        let can = has(&navigator, "mediaDevices") && has(&js_sys::global(), "AudioWorkletNode");
        let devices = can.then(|| navigator.media_devices().ok()).flatten()?;
        Some(Self { devices, shared: Rc::default() })
    }
}

impl SensorDevice<Sound> for Microphone {
    fn begin(&self, ctx: &Context, to: &ReadingQueue<Sound>) {
        self.end();
        let turn = self.shared.turn.get();
        let (devices, shared, ctx, to) = (self.devices.clone(), Rc::clone(&self.shared), ctx.clone(), to.clone());
        wasm_bindgen_futures::spawn_local(async move {
            let stream = match stream(&devices).await {
                Ok(stream) => stream,
                Err(error) => return to.refuse(reason(&error), &ctx),
            };
            match AudioCapture::begin(&stream, &ctx, &to).await {
                Ok(listening) if shared.turn.get() == turn => *shared.listening.borrow_mut() = Some(listening),
                Ok(_) => {}
                Err(error) => {
                    end(&stream);
                    to.refuse(format!("The browser cannot listen ({})", words(&error)), &ctx);
                }
            }
        });
    }

    fn end(&self) {
        self.shared.turn.set(self.shared.turn.get().wrapping_add(1));
        self.shared.listening.borrow_mut().take();
    }

    fn hint(&self) -> String {
        "The browser may ask for permission.".to_owned()
    }
}

/// The sound as it is: what makes speech clear would make a ring shorter and louder.
async fn stream(devices: &MediaDevices) -> Result<MediaStream, JsValue> {
    let track = MediaTrackConstraints::new();
    for feature in ["echoCancellation", "noiseSuppression", "autoGainControl"] {
        js_sys::Reflect::set(&track, &feature.into(), &JsValue::FALSE)?;
    }
    let constraints = MediaStreamConstraints::new();
    constraints.set_audio(&track);
    JsFuture::from(devices.get_user_media_with_constraints(&constraints)?).await?.dyn_into()
}

impl AudioCapture {
    async fn begin(stream: &MediaStream, ctx: &Context, to: &ReadingQueue<Sound>) -> Result<Self, JsValue> {
        let context = AudioContext::new()?;
        let begun = Self::within(&context, stream, ctx, to).await;
        if begun.is_err() {
            context.close().ok();
        }
        begun
    }

    async fn within(
        context: &AudioContext,
        stream: &MediaStream,
        ctx: &Context,
        to: &ReadingQueue<Sound>,
    ) -> Result<Self, JsValue> {
        JsFuture::from(context.audio_worklet()?.add_module(&format!("{WORKLET}{}", version()))?).await?;
        let node = AudioWorkletNode::new(context, PROCESSOR)?;
        to.set_rate(f64::from(context.sample_rate()));
        let (ctx, to) = (ctx.clone(), to.clone());
        let messages = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
            if let Ok(samples) = event.data().dyn_into::<js_sys::Float32Array>() {
                to.put(&samples.to_vec(), &ctx);
            }
        });
        node.port()?.set_onmessage(Some(messages.as_ref().unchecked_ref()));
        context.create_media_stream_source(stream)?.connect_with_audio_node(&node)?;
        // Safari's contexts sleep at first.
        JsFuture::from(context.resume()?).await?;
        Ok(Self { stream: stream.clone(), context: context.clone(), node, _messages: messages })
    }
}

impl Drop for AudioCapture {
    fn drop(&mut self) {
        if let Ok(port) = self.node.port() {
            port.set_onmessage(None);
        }
        end(&self.stream);
        self.context.close().ok();
    }
}

fn end(stream: &MediaStream) {
    for track in stream.get_tracks() {
        if let Ok(track) = track.dyn_into::<MediaStreamTrack>() {
            track.stop();
        }
    }
}

fn reason(error: &JsValue) -> String {
    match words(error).split(':').next().unwrap_or_default() {
        "NotAllowedError" => "The browser may not use the microphone".to_owned(),
        "NotFoundError" => "This device has no microphone".to_owned(),
        _ => format!("The microphone cannot be heard ({})", words(error)),
    }
}
