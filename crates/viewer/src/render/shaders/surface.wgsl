struct Corner {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
}

struct Instance {
    @location(2) offset: vec3f,
    @location(4) colour: vec3f,
    @location(5) rotation: vec4f,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) colour: vec3f,
    // Barycentric coordinates; each is zero along the edge opposite its corner.
    @location(3) parts: vec3f,
}

fn placed(corner: Corner, instance: Instance, parts: vec3f) -> Varying {
    var out: Varying;
    out.position = turned(corner.position, instance.rotation) + instance.offset;
    out.clip = frame.view_projection * vec4f(out.position, 1.0);
    out.normal = turned(corner.normal, instance.rotation);
    out.colour = instance.colour;
    out.parts = parts;
    return out;
}

@vertex
fn vs_plain(corner: Corner, instance: Instance) -> Varying {
    return placed(corner, instance, vec3f(1.0));
}

// For triangles whose corners are in order, three by three.
@vertex
fn vs_edged(corner: Corner, instance: Instance, @builtin(vertex_index) index: u32) -> Varying {
    let place = index % 3u;
    let parts = vec3f(f32(place == 0u), f32(place == 1u), f32(place == 2u));
    return placed(corner, instance, parts);
}

// Like the above, but moved sideways by some pixels and slightly back, so that only a rim is visible beside the body.
const RIM = 2.0;
const BACK = 0.05;
const RIM_COLOUR = vec3f(0.02, 0.14, 0.9);

fn beside(corner: Corner, instance: Instance, side: vec2f) -> Varying {
    var out = placed(corner, instance, vec3f(1.0));
    let shift = RIM * side / frame.half_size * out.clip.w;
    out.clip = vec4f(out.clip.xy + shift, out.clip.z * (1.0 - BACK * frame.depth_share), out.clip.w);
    return out;
}

@vertex
fn vs_rim0(corner: Corner, instance: Instance) -> Varying {
    return beside(corner, instance, vec2f(0.7, 0.7));
}

@vertex
fn vs_rim1(corner: Corner, instance: Instance) -> Varying {
    return beside(corner, instance, vec2f(-0.7, 0.7));
}

@vertex
fn vs_rim2(corner: Corner, instance: Instance) -> Varying {
    return beside(corner, instance, vec2f(-0.7, -0.7));
}

@vertex
fn vs_rim3(corner: Corner, instance: Instance) -> Varying {
    return beside(corner, instance, vec2f(0.7, -0.7));
}

@fragment
fn fs_rim(in: Varying) -> @location(0) vec4f {
    return vec4f(RIM_COLOUR, 1.0);
}

fn surface(in: Varying, front: bool) -> vec3f {
    // Both sides are drawn, because an open mesh has a visible inside.
    return lit(in.colour, in.position, normalize(select(-in.normal, in.normal, front)));
}

@fragment
fn fs_plain(in: Varying, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    return vec4f(surface(in, front), 1.0);
}

// A translucent mesh: faint where it faces the viewer, denser towards its outline.
@fragment
fn fs_ghost(in: Varying, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let grazing = 1.0 - abs(dot(normalize(in.normal), normalize(in.position)));
    let opacity = 0.26 + 0.45 * grazing * grazing;
    return vec4f(surface(in, front) * opacity, opacity);
}

const EDGE = vec3f(0.010, 0.014, 0.022);
// Half the width of an edge, pixels; the triangles on both sides each draw one half.
const EDGE_HALF_WIDTH = 0.6;

@fragment
fn fs_edged(in: Varying, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let dx = dpdx(in.parts);
    let dy = dpdy(in.parts);
    // The change of each barycentric coordinate over one pixel.
    let pixel = max(sqrt(dx * dx + dy * dy), vec3f(1e-9));
    let covered = clamp(vec3f(EDGE_HALF_WIDTH + 0.5) - in.parts / pixel, vec3f(0.0), vec3f(1.0));
    // Crowded edges become faint, so that a dense mesh still shows its surface.
    let apart = mix(vec3f(0.12), vec3f(0.75), 1.0 - smoothstep(vec3f(0.04), vec3f(0.3), pixel));
    let inks = covered * apart;
    let ink = max(inks.x, max(inks.y, inks.z));
    let normal = normalize(in.normal);
    let grazing = 1.0 - abs(dot(normal, normalize(in.position)));
    let bright = 1.1 * surface(in, front) + vec3f(0.012 + 0.12 * grazing * grazing * grazing);
    return vec4f(mix(bright, EDGE, ink), 1.0);
}
