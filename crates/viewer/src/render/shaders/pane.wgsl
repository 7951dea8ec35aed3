struct Varying {
    @builtin(position) clip: vec4f,
    // Premultiplied by its opacity.
    @location(0) colour: vec4f,
}

@vertex
fn vs_main(@location(0) position: vec3f, @location(1) colour: vec4f) -> Varying {
    var out: Varying;
    out.clip = frame.view_projection * vec4f(position, 1.0);
    out.colour = colour;
    return out;
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    return in.colour;
}
