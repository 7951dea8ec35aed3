@group(0) @binding(0) var sharp: texture_2d<f32>;
@group(0) @binding(1) var smoothly: sampler;

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) at: vec2f,
}

@vertex
fn vs_main(@builtin(vertex_index) index: u32) -> Varying {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0;
    var out: Varying;
    out.at = corner;
    out.clip = vec4f(corner.x * 2.0 - 1.0, 1.0 - corner.y * 2.0, 0.0, 1.0);
    return out;
}

const TAPS = 24;
// A fraction of the width of the map.
const REACH = 0.009;

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    var sum = 0.0;
    for (var tap = 0; tap < TAPS; tap++) {
        // A sunflower spiral covers the disc evenly.
        let turn = 2.39996 * f32(tap);
        let reach = REACH * sqrt((f32(tap) + 0.5) / f32(TAPS));
        let at = in.at + reach * vec2f(cos(turn), sin(turn));
        sum += textureSampleLevel(sharp, smoothly, at, 0.0).r;
    }
    return vec4f(sum / f32(TAPS));
}
