struct Corner {
    // Unit direction away from the arrow's line; zero on it.
    @location(0) around: vec2f,
    // Distance from the line, in radii of the shaft and of the head.
    @location(1) outward: vec2f,
    // Distance from the tail, in lengths of the arrow and of the head.
    @location(2) along: vec2f,
    // The radial and axial components of the normal; the slope of a cone depends on the head.
    @location(3) normal: vec2f,
}

struct Instance {
    @location(4) tail: vec3f,
    @location(5) radius: f32,
    @location(6) span: vec3f,
    @location(7) head_length: f32,
    @location(8) colour: vec3f,
    @location(9) head_radius: f32,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) colour: vec3f,
}

@vertex
fn vs_main(corner: Corner, instance: Instance) -> Varying {
    let total = length(instance.span);
    let direction = instance.span / total;
    let other = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(direction.x) > 0.7);
    let side = normalize(cross(other, direction));
    let around = corner.around.x * side + corner.around.y * cross(direction, side);
    let outward = dot(corner.outward, vec2f(instance.radius, instance.head_radius));
    let along = dot(corner.along, vec2f(total, instance.head_length));
    var slope = corner.normal;
    if slope.x * slope.y > 0.0 {
        slope = vec2f(instance.head_length, instance.head_radius);
    }
    var out: Varying;
    out.position = instance.tail + direction * along + around * outward;
    out.clip = frame.view_projection * vec4f(out.position, 1.0);
    out.normal = normalize(around * slope.x + direction * slope.y);
    out.colour = instance.colour;
    return out;
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    return vec4f(lit(in.colour, in.position, normalize(in.normal)), 1.0);
}
