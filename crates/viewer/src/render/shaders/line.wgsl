struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) colour: vec4f,
    // Pixels along the line from its start and across from its middle.
    @location(1) place: vec2f,
    // Length and half the width, pixels.
    @location(2) extent: vec2f,
}

// One of the four corners of a rectangle on the screen that contains the line with its round ends.
@vertex
fn vs_main(
    @builtin(vertex_index) index: u32,
    @location(0) from_eye: vec3f,
    @location(1) to_eye: vec3f,
    @location(2) colour: vec4f,
    @location(3) width: f32,
) -> Varying {
    var out: Varying;
    out.colour = colour;
    var a = frame.view_projection * vec4f(from_eye, 1.0);
    var b = frame.view_projection * vec4f(to_eye, 1.0);
    if max(a.w, b.w) <= frame.near {
        return out; // behind the eye: no area
    }
    if a.w < frame.near {
        a = mix(a, b, (frame.near - a.w) / (b.w - a.w));
    }
    if b.w < frame.near {
        b = mix(b, a, (frame.near - b.w) / (a.w - b.w));
    }
    let start = a.xy / a.w * frame.half_size;
    let end = b.xy / b.w * frame.half_size;
    let length = distance(start, end);
    var along = vec2f(1.0, 0.0);
    if length > 1e-3 {
        along = (end - start) / length;
    }
    let across = vec2f(-along.y, along.x);
    let half_width = 0.5 * max(width, 1.0);
    out.colour.a *= min(width, 1.0);
    let reach = half_width + 1.0;
    let side = select(-reach, reach, (index & 1u) == 1u);
    let last = index > 1u;
    let shift = select(-reach, reach, last);
    let corner = select(start, end, last) + along * shift + across * side;
    // The line is drawn slightly nearer, so that it does not sink into its surface; the ends continue its slope.
    let beyond = min(reach / max(length, 1e-3), 0.5);
    let ends = vec2f(a.z / a.w, b.z / b.w);
    let depth = mix(ends.x, ends.y, select(-beyond, 1.0 + beyond, last)) * (1.0 + 3.0 * frame.pixel * frame.depth_share);
    // After this division all values vary linearly over the screen.
    out.clip = vec4f(corner / frame.half_size, min(depth, 1.0), 1.0);
    out.place = vec2f(select(0.0, length, last) + shift, side);
    out.extent = vec2f(length, half_width);
    return out;
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    let beyond = in.place.x - clamp(in.place.x, 0.0, in.extent.x);
    let away = length(vec2f(beyond, in.place.y));
    let covered = clamp(in.extent.y + 0.5 - away, 0.0, 1.0);
    let opacity = in.colour.a * covered;
    return vec4f(in.colour.rgb * opacity, opacity);
}
