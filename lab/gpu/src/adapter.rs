//! The search for a graphics processor.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock};

use thiserror::Error;
use wgpu::{
    Adapter, AdapterInfo, ComputePipeline, Device, DeviceDescriptor, DeviceType, Instance, InstanceDescriptor, Limits,
    Queue,
};

/// Whether a software adapter, such as lavapipe, is accepted. It is slower than threads, and useful for tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Software {
    /// Only a graphics processor will do.
    Refused,
    /// A software adapter is accepted if there is no graphics processor.
    Allowed,
}

/// A graphics processor with the filters' programs.
pub struct Gpu {
    /// The adapter's name, from its driver.
    pub name: String,
    pub(crate) device: Device,
    pub(crate) queue: Queue,
    pub(crate) pipelines: Mutex<HashMap<String, ComputePipeline>>,
    pub(crate) trouble: AdapterFault,
}

impl Gpu {
    /// Looks for a graphics processor and prepares it: that takes some tenths of a second.
    ///
    /// # Errors
    /// [`GpuError::None`], [`GpuError::Software`] if that is not accepted, [`GpuError::Failed`] if it rejects the filters' programs.
    pub async fn find(software: Software) -> Result<Self, GpuError> {
        let instance = Instance::new(InstanceDescriptor::new_without_display_handle());
        let adapter = choose(&instance, software).await?;
        let name = name_of(&info_of(&adapter).await);
        let own = adapter.limits();
        // The least that every adapter has, but with buffers as large as this one has them.
        let required_limits = Limits {
            max_buffer_size: own.max_buffer_size.min(LARGEST_BUFFER),
            max_storage_buffer_binding_size: own.max_storage_buffer_binding_size.min(LARGEST_BUFFER),
            ..Limits::downlevel_defaults()
        };
        let descriptor = DeviceDescriptor { required_limits, ..DeviceDescriptor::default() };
        let device = adapter.request_device(&descriptor).await;
        let (device, queue) = device.map_err(|error| GpuError::Failed(error.to_string()))?;
        let trouble = AdapterFault::default();
        let reporter = trouble.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| reporter.report(error.to_string())));
        let reporter = trouble.clone();
        device.set_device_lost_callback(move |reason, text| reporter.report(format!("it is lost ({reason:?}) {text}")));
        trouble.check()?;
        Ok(Self { name, device, queue, pipelines: Mutex::default(), trouble })
    }
}

#[cfg(not(target_arch = "wasm32"))]
async fn choose(instance: &Instance, software: Software) -> Result<Adapter, GpuError> {
    let adapters = instance.enumerate_adapters(wgpu::Backends::all()).await;
    let first = adapters.into_iter().min_by_key(|adapter| {
        let info = adapter.get_info();
        let rank = match info.device_type {
            DeviceType::DiscreteGpu => 0,
            DeviceType::IntegratedGpu => 1,
            _ => 2,
        };
        (is_software(&info), rank)
    });
    accept(first.ok_or_else(|| GpuError::None("no driver offers one".to_owned()))?, software).await
}

#[cfg(target_arch = "wasm32")]
async fn choose(instance: &Instance, software: Software) -> Result<Adapter, GpuError> {
    let options = wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::HighPerformance,
        ..wgpu::RequestAdapterOptions::default()
    };
    let adapter = instance.request_adapter(&options).await;
    accept(adapter.map_err(|error| GpuError::None(error.to_string()))?, software).await
}

async fn accept(adapter: Adapter, software: Software) -> Result<Adapter, GpuError> {
    let info = info_of(&adapter).await;
    if software == Software::Refused && is_software(&info) {
        return Err(GpuError::Software(name_of(&info)));
    }
    Ok(adapter)
}

#[cfg(not(target_arch = "wasm32"))]
#[expect(clippy::unused_async, reason = "a browser is asked")]
async fn info_of(adapter: &Adapter) -> AdapterInfo {
    adapter.get_info()
}

/// Browsers describe an adapter in words that the library leaves out.
#[cfg(target_arch = "wasm32")]
async fn info_of(adapter: &Adapter) -> AdapterInfo {
    let mut info = adapter.get_info();
    if info.name.trim().is_empty() {
        info.name = adapter_name().await.unwrap_or_default();
    }
    info
}

#[cfg(target_arch = "wasm32")]
async fn adapter_name() -> Option<String> {
    use js_sys::{Function, Object, Promise, Reflect};
    use wasm_bindgen::{JsCast as _, JsValue};
    let get = |object: &JsValue, key: &str| Reflect::get(object, &key.into()).ok();
    let gpu = get(&get(&js_sys::global(), "navigator")?, "gpu")?;
    let options = Object::new();
    Reflect::set(&options, &"powerPreference".into(), &"high-performance".into()).ok()?;
    let request: Function = get(&gpu, "requestAdapter")?.dyn_into().ok()?;
    let promise: Promise = request.call1(&gpu, &options).ok()?.dyn_into().ok()?;
    let adapter = wasm_bindgen_futures::JsFuture::from(promise).await.ok()?;
    let info = get(&adapter, "info")?;
    let words = ["vendor", "architecture"].map(|key| get(&info, key).and_then(|word| word.as_string()));
    let words: Vec<String> = words.into_iter().flatten().filter(|word| !word.is_empty()).collect();
    (!words.is_empty()).then(|| words.join(" "))
}

/// Whether an adapter is a program on the processor.
pub fn is_software(info: &AdapterInfo) -> bool {
    const NAMES: [&str; 5] = ["lavapipe", "llvmpipe", "softpipe", "swiftshader", "microsoft basic render"];
    let names = format!("{} {} {}", info.name, info.driver, info.driver_info).to_lowercase();
    info.device_type == DeviceType::Cpu || NAMES.iter().any(|name| names.contains(name))
}

fn name_of(info: &AdapterInfo) -> String {
    let name = info.name.trim();
    if name.is_empty() { "a graphics processor".to_owned() } else { name.to_owned() }
}

/// Limits a buffer \[bytes\].
pub(crate) const LARGEST_BUFFER: u64 = 128 << 20;

/// The reason why a graphics processor computes nothing, or no more.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum GpuError {
    /// There is no graphics processor that programs can use.
    #[error("there is no graphics processor that programs can use: {0}")]
    None(String),
    /// The only adapter is a program on the processor, which is slower than the processor itself.
    #[error("{0} is a program and no graphics processor")]
    Software(String),
    /// The adapter has refused the program, or has been lost.
    #[error("the graphics processor has failed: {0}")]
    Failed(String),
    /// The results are not wanted any more.
    #[error("the work has been given up")]
    Unwanted,
}

#[derive(Clone, Default)]
pub(crate) struct AdapterFault(Arc<OnceLock<String>>);

impl AdapterFault {
    fn report(&self, text: String) {
        // The first one is the cause of the others.
        let _ = self.0.set(text);
    }

    pub(crate) fn check(&self) -> Result<(), GpuError> {
        self.0.get().map_or(Ok(()), |text| Err(GpuError::Failed(text.clone())))
    }
}
