// What every pipeline knows of the picture. Positions are metres relative to the eye, along world axes.
struct Frame {
    view_projection: mat4x4f,
    // From the middle of the picture to its right and upper edges, at a depth of one; unit direction of view.
    right: vec3f,
    near: f32,
    up: vec3f,
    // Size of a pixel at a depth of one.
    pixel: f32,
    forward: vec3f,
    eye_height: f32,
    // Unit direction to the key light.
    light: vec3f,
    shadow_half: f32,
    // Half the picture, pixels.
    half_size: vec2f,
    // The middle of the shadow map and the origin's x and z.
    shadow_centre: vec2f,
    origin: vec2f,
    // The finest spacing of the grid, m, and how far it is drawn.
    grid_step: f32,
    grid_reach: f32,
    // The eye's place within a cell of 1, 10, 100 and 1000 spacings, in cells.
    grid_x: vec4f,
    grid_z: vec4f,
    // How much a part of the depth is at the target, compared with perspective.
    depth_share: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;

// A vector turned by a unit quaternion.
fn turned(v: vec3f, q: vec4f) -> vec3f {
    let t = 2.0 * cross(q.xyz, v);
    return v + q.w * t + cross(q.xyz, t);
}
