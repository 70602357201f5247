//! The filters' programs on a device: buffers, and dispatches of some samples each.

use std::future::poll_fn;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Poll, Waker};

use web_time::{Duration, Instant};
use wgpu::{BindGroup, Buffer, BufferDescriptor, BufferUsages, ComputePipeline, MapMode};

use crate::adapter::{Gpu, GpuError};
use crate::layout::bits;
use crate::shader::{GROUP, ShaderProgram};

/// Drivers reset a device that is busy with one dispatch for seconds, and pictures of the system wait.
const DISPATCH: Duration = Duration::from_millis(50);

// The first dispatch may compile the program, and its time then says little: portions grow step by step.
const FIRST: u32 = 64;
const GROWTH: f64 = 8.0;

/// Limits the programs that are kept: each edit of an equation makes another one.
const MOST_PROGRAMS: usize = 24;

/// A dispatch that takes longer than this counts as lost. It is long because some drivers compile the program in the first one.
#[cfg(not(target_arch = "wasm32"))]
const PATIENCE: Duration = Duration::from_secs(90);

pub(crate) struct GpuJob<'a> {
    pub(crate) program: &'a ShaderProgram,
    pub(crate) runs: u32,
    pub(crate) length: u32,
    pub(crate) dt: f64,
    pub(crate) samples: Vec<u32>,
    pub(crate) cells: Vec<u32>,
}

struct Buffers {
    settings: Buffer,
    states: Buffer,
    group: BindGroup,
}

impl Gpu {
    pub(crate) async fn run(&self, job: &GpuJob<'_>, is_wanted: &dyn Fn() -> bool) -> Result<Vec<u32>, GpuError> {
        // Faults come by a callback, not from the call that causes them: the check finds a program that is refused.
        let pipeline = self.pipeline(&job.program.text);
        self.trouble.check()?;
        let buffers = self.buffers(job, &pipeline);
        let samples = job.length;
        let (mut begin, mut portion) = (0, FIRST);
        while begin < samples {
            if !is_wanted() {
                return Err(GpuError::Unwanted);
            }
            let end = begin.saturating_add(portion).min(samples);
            let time = Instant::now();
            self.dispatch(job, &pipeline, &buffers, begin, end);
            self.done().await?;
            // The clocks of browsers are coarse, and may not have moved.
            let factor = DISPATCH.as_secs_f64() / time.elapsed().as_secs_f64().max(1e-6);
            portion = ((f64::from(portion) * factor.min(GROWTH)) as u32).max(1);
            begin = end;
        }
        self.read(&buffers.states, job).await
    }

    fn buffers(&self, job: &GpuJob<'_>, pipeline: &ComputePipeline) -> Buffers {
        let filled = |words: &[u32]| {
            let buffer = self.buffer(words.len() as u64 * 4, BufferUsages::STORAGE | BufferUsages::COPY_DST);
            self.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(words));
            buffer
        };
        let settings = self.buffer(32, BufferUsages::UNIFORM | BufferUsages::COPY_DST);
        let states = self.buffer(size_of_states(job), BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        let (samples, cells) = (filled(&job.samples), filled(&job.cells));
        let entries: Vec<_> = [&settings, &samples, &cells, &states]
            .into_iter()
            .zip(0..)
            .map(|(buffer, binding)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let layout = pipeline.get_bind_group_layout(0);
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries };
        let group = self.device.create_bind_group(&descriptor);
        Buffers { settings, states, group }
    }

    fn buffer(&self, size: u64, usage: BufferUsages) -> Buffer {
        self.device.create_buffer(&BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
    }

    fn pipeline(&self, text: &str) -> ComputePipeline {
        let mut pipelines = self.pipelines.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = pipelines.get(text) {
            return pipeline.clone();
        }
        if pipelines.len() >= MOST_PROGRAMS {
            pipelines.clear();
        }
        let source = wgpu::ShaderSource::Wgsl(text.into());
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: None,
            layout: None,
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        pipelines.insert(text.to_owned(), pipeline.clone());
        pipeline
    }

    fn dispatch(&self, job: &GpuJob<'_>, pipeline: &ComputePipeline, buffers: &Buffers, begin: u32, end: u32) {
        let recent = job.length * 4 / 5;
        let settings = [begin, end, job.runs, recent, bits(job.dt), 0, 0, 0];
        self.queue.write_buffer(&buffers.settings, 0, bytemuck::cast_slice(&settings));
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &buffers.group, &[]);
            pass.dispatch_workgroups(job.runs.div_ceil(GROUP), 1, 1);
        }
        self.queue.submit([encoder.finish()]);
    }

    async fn done(&self) -> Result<(), GpuError> {
        let (set, done) = one_shot();
        self.queue.on_submitted_work_done(move || set(()));
        self.wait()?;
        self.trouble.check()?;
        done.await;
        self.trouble.check()
    }

    async fn read(&self, states: &Buffer, job: &GpuJob<'_>) -> Result<Vec<u32>, GpuError> {
        let size = size_of_states(job);
        let copy = self.buffer(size, BufferUsages::MAP_READ | BufferUsages::COPY_DST);
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_buffer_to_buffer(states, 0, &copy, 0, size);
        self.queue.submit([encoder.finish()]);
        let (set, mapped) = one_shot();
        copy.slice(..).map_async(MapMode::Read, set);
        self.wait()?;
        self.trouble.check()?;
        mapped.await.map_err(failed)?;
        let view = copy.slice(..).get_mapped_range().map_err(failed)?;
        Ok(bytemuck::cast_slice(&view).to_vec())
    }

    /// Runs callbacks: natively by waiting for the device; a browser runs them by itself.
    #[cfg(not(target_arch = "wasm32"))]
    fn wait(&self) -> Result<(), GpuError> {
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(PATIENCE) };
        self.device.poll(wait).map(|_| ()).map_err(failed)
    }

    #[cfg(target_arch = "wasm32")]
    #[expect(clippy::unnecessary_wraps, reason = "the other systems wait here, and that may fail")]
    fn wait(&self) -> Result<(), GpuError> {
        Ok(())
    }
}

fn size_of_states(job: &GpuJob<'_>) -> u64 {
    u64::from(job.runs) * job.program.shape.state() as u64 * 4
}

fn failed(error: impl std::fmt::Display) -> GpuError {
    GpuError::Failed(error.to_string())
}

fn one_shot<T: Send>() -> (impl FnOnce(T) + Send, impl Future<Output = T>) {
    let shared = Arc::new(Mutex::new((None, None)));
    let other = Arc::clone(&shared);
    let set = move |value| {
        let waker: Option<Waker> = {
            let mut both = other.lock().unwrap_or_else(PoisonError::into_inner);
            both.0 = Some(value);
            both.1.take()
        };
        waker.into_iter().for_each(Waker::wake);
    };
    let get = poll_fn(move |context| {
        let mut both = shared.lock().unwrap_or_else(PoisonError::into_inner);
        both.1 = Some(context.waker().clone());
        both.0.take().map_or(Poll::Pending, Poll::Ready)
    });
    (set, get)
}
