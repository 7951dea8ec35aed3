//! What a renderer asks of an adapter.

use egui_wgpu::wgpu;

/// The samples per pixel that are multiplied where the adapter can: 4, else 1.
pub fn supported_samples(adapter: &wgpu::Adapter) -> u32 {
    let flags = |format| adapter.get_texture_format_features(format).flags;
    let colour = flags(super::targets::COLOUR);
    let depth = flags(super::targets::DEPTH);
    let able = colour.sample_count_supported(4)
        && colour.contains(wgpu::TextureFormatFeatureFlags::MULTISAMPLE_RESOLVE)
        && depth.sample_count_supported(4);
    if able { 4 } else { 1 }
}

/// A device with textures and buffers as large as the adapter has them, and no more than common limits else,
/// for older adapters too.
pub fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
    let able = adapter.limits();
    wgpu::DeviceDescriptor {
        label: Some("pictures"),
        required_limits: wgpu::Limits {
            max_buffer_size: able.max_buffer_size,
            ..wgpu::Limits::downlevel_webgl2_defaults().using_resolution(able)
        },
        ..Default::default()
    }
}
