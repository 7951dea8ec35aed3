struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) direction: vec3f,
}

@vertex
fn vs_main(@builtin(vertex_index) index: u32) -> Varying {
    // One triangle that covers the picture, at infinity.
    let at = vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    var out: Varying;
    out.clip = vec4f(at, 0.0, 1.0);
    out.direction = frame.forward + at.x * frame.right + at.y * frame.up;
    return out;
}

const ZENITH = vec3f(0.47, 0.57, 0.69);
const HORIZON = vec3f(0.84, 0.87, 0.90);
const NADIR = vec3f(0.66, 0.69, 0.72);

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    let height = normalize(in.direction).y;
    let away = select(NADIR, ZENITH, height > 0.0);
    return vec4f(mix(HORIZON, away, smoothstep(0.0, 1.0, abs(height))), 1.0);
}
