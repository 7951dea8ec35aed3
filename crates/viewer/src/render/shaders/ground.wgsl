@group(1) @binding(0) var shadow_map: texture_2d<f32>;
@group(1) @binding(1) var shadow_sampler: sampler;

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) from_eye: vec2f,
}

@vertex
fn vs_main(@builtin(vertex_index) index: u32) -> Varying {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    var out: Varying;
    out.from_eye = corner * frame.grid_reach;
    out.clip = frame.view_projection * vec4f(out.from_eye.x, -frame.eye_height, out.from_eye.y, 1.0);
    // A face that lies on the ground hides the grid.
    out.clip.z *= 1.0 - 0.0005 * frame.depth_share;
    return out;
}

const LINE = vec3f(0.13, 0.15, 0.18);
const X_AXIS = vec3f(0.72, 0.06, 0.06);
const Z_AXIS = vec3f(0.04, 0.16, 0.72);

// The fraction of a pixel that a line covers, `distance` away from its middle, both in the unit of `pixel`.
fn coverage(distance: vec2f, pixel: vec2f, width: f32) -> vec2f {
    return clamp(vec2f(0.5 * width + 0.5) - abs(distance) / pixel, vec2f(0.0), vec2f(min(width, 1.0)));
}

// The visibility of lines one cell apart; they fade before they would cause moire.
fn clarity(pixel: vec2f) -> vec2f {
    return 1.0 - smoothstep(vec2f(0.05), vec2f(0.28), pixel);
}

// The shadow at a place, fading towards the border of the map.
fn shadow(from_eye: vec2f) -> f32 {
    let middle = (from_eye - frame.shadow_centre) / (2.0 * frame.shadow_half);
    let inside = 1.0 - smoothstep(0.4, 0.5, max(abs(middle.x), abs(middle.y)));
    let at = vec2f(middle.x, -middle.y) + 0.5;
    return inside * textureSampleLevel(shadow_map, shadow_sampler, at, 0.0).r;
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    let at = in.from_eye;
    let pixel = max(vec2f(length(vec2f(dpdx(at.x), dpdy(at.x))), length(vec2f(dpdx(at.y), dpdy(at.y)))), vec2f(1e-12));
    var ink = 0.0;
    var cell = frame.grid_step;
    for (var level = 0; level < 4; level++) {
        let cells = at / cell + vec2f(frame.grid_x[level], frame.grid_z[level]);
        // Thicker than the next finer lines, as long as those are visible.
        let finer = select(clarity(10.0 * pixel / cell), vec2f(0.0), level == 0);
        let covered = coverage(fract(cells + 0.5) - 0.5, pixel / cell, 1.3);
        let inks = covered * clarity(pixel / cell) * mix(vec2f(0.28), vec2f(0.6), finer);
        ink = max(ink, max(inks.x, inks.y));
        cell *= 10.0;
    }
    // The x axis is the line with z = 0, and the z axis that with x = 0; the negative halves are paler.
    let from_origin = at - frame.origin;
    let axis = coverage(from_origin.yx, pixel.yx, 2.0) * select(vec2f(0.35), vec2f(0.9), from_origin >= vec2f(0.0));
    var colour = mix(LINE, X_AXIS, axis.x);
    colour = mix(colour, Z_AXIS, axis.y);
    ink = max(ink, max(axis.x, axis.y));

    let fade = 1.0 - smoothstep(0.25, 1.0, length(at) / frame.grid_reach);
    ink *= fade;
    let dark = 0.5 * shadow(at);
    // Draws the lines over the shadow.
    let opacity = ink + dark * (1.0 - ink);
    return vec4f(colour * ink, opacity);
}
