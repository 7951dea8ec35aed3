//! The requirements of a renderer on an adapter.

use egui_wgpu::wgpu;

/// The number of multisampling samples per pixel: 4 if the adapter supports it, else 1.
pub fn supported_samples(adapter: &wgpu::Adapter) -> u32 {
    let flags = |format| adapter.get_texture_format_features(format).flags;
    let colour = flags(super::targets::COLOUR);
    let depth = flags(super::targets::DEPTH);
    let able = colour.sample_count_supported(4)
        && colour.contains(wgpu::TextureFormatFeatureFlags::MULTISAMPLE_RESOLVE)
        && depth.sample_count_supported(4);
    if able { 4 } else { 1 }
}

/// The descriptor of a device with textures and buffers as large as the adapter allows. Its other limits are common
/// ones, so that older adapters meet them too.
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
