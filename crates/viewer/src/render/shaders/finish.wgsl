// Draws the finished picture onto the target, for any encoding of the target.
@group(0) @binding(0) var picture: texture_2d<f32>;

override encode: bool;

@vertex
fn vs_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fs_main(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let linear = textureLoad(picture, vec2i(at.xy), 0);
    if encode {
        let low = linear.rgb * 12.92;
        let high = 1.055 * pow(linear.rgb, vec3f(1.0 / 2.4)) - 0.055;
        return vec4f(select(high, low, linear.rgb <= vec3f(0.0031308)), 1.0);
    }
    return vec4f(linear.rgb, 1.0);
}
