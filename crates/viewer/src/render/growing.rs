//! A buffer on the device for data that changes with each picture.

use std::marker::PhantomData;

use bytemuck::Pod;
use egui_wgpu::wgpu;

/// A buffer whose items are written for each picture. Its capacity only grows, so constant pictures allocate nothing.
pub(super) struct Growing<T> {
    label: &'static str,
    usage: wgpu::BufferUsages,
    buffer: wgpu::Buffer,
    items: PhantomData<T>,
}

impl<T: Pod> Growing<T> {
    pub(super) fn new(
        device: &wgpu::Device,
        label: &'static str,
        usage: wgpu::BufferUsages,
    ) -> Self {
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        Self {
            label,
            usage,
            buffer: room(device, label, usage, 64 * size_of::<T>() as u64),
            items: PhantomData,
        }
    }

    /// Writes the items, as many as a buffer of the device can hold, and returns their number.
    pub(super) fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, items: &[T]) -> u32 {
        let item = size_of::<T>() as u64;
        let most = device.limits().max_buffer_size / item;
        let count = (items.len() as u64).min(most).min(u64::from(u32::MAX));
        let size = count * item;
        if size > self.buffer.size() {
            let roomy = size.next_power_of_two().min(most * item);
            self.buffer = room(device, self.label, self.usage, roomy);
        }
        if count > 0 {
            queue.write_buffer(
                &self.buffer,
                0,
                bytemuck::cast_slice(&items[..count as usize]),
            );
        }
        count as u32
    }

    pub(super) fn buffer(&self) -> &wgpu::Buffer {
        &self.buffer
    }
}

fn room(device: &wgpu::Device, label: &str, usage: wgpu::BufferUsages, size: u64) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: false,
    })
}
