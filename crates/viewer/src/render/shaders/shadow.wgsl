// Draws meshes from straight above onto the ground: 1 where they touch it, fading with height.
struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) height: f32,
}

@vertex
fn vs_main(
    @location(0) position: vec3f,
    @location(2) offset: vec3f,
    @location(3) radius: f32,
    @location(5) rotation: vec4f,
) -> Varying {
    let at = turned(position, rotation) + offset;
    var out: Varying;
    out.clip = vec4f((at.xz - frame.shadow_centre) / frame.shadow_half, 0.5, 1.0);
    // In sizes of the mesh, so that small and large bodies cast similar shadows.
    out.height = (at.y + frame.eye_height) / radius;
    return out;
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    let above = step(-0.01, in.height);
    return vec4f(above * exp(-max(in.height, 0.0)));
}
