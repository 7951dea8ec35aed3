// The data of a picture that all pipelines share. Positions are metres relative to the eye, along world axes.
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
    // The middle of the shadow map, and x and z of the origin.
    shadow_centre: vec2f,
    origin: vec2f,
    // The finest spacing of the grid, m, and the radius to which it is drawn.
    grid_step: f32,
    grid_reach: f32,
    // The position of the eye within a cell of 1, 10, 100 and 1000 spacings, in cells.
    grid_x: vec4f,
    grid_z: vec4f,
    // The factor for relative offsets of the depth: with it an offset at the target has the same effect as in
    // perspective.
    depth_share: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;

// Rotates a vector by a unit quaternion.
fn turned(v: vec3f, q: vec4f) -> vec3f {
    let t = 2.0 * cross(q.xyz, v);
    return v + q.w * t + cross(q.xyz, t);
}
