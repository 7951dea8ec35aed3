//! Draws the shapes of a control panel onto a texture.

use egui_wgpu::wgpu;

/// Paints a control panel onto a texture. Returns the command buffers that must be submitted before.
pub fn paint_panels(
    ui: &mut egui_wgpu::Renderer,
    (device, queue): (&wgpu::Device, &wgpu::Queue),
    (encoder, view): (&mut wgpu::CommandEncoder, &wgpu::TextureView),
    primitives: &[egui::ClippedPrimitive],
    screen: &egui_wgpu::ScreenDescriptor,
) -> Vec<wgpu::CommandBuffer> {
    let before = ui.update_buffers(device, queue, encoder, primitives, screen);
    let mut pass = encoder
        .begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("control panel"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Store,
                },
                depth_slice: None,
            })],
            ..Default::default()
        })
        .forget_lifetime();
    ui.render(&mut pass, primitives, screen);
    before
}
