struct Corner {
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
}

struct Instance {
    @location(2) offset: vec3f,
    @location(3) radius: f32,
    @location(4) colour: vec3f,
    @location(5) selected: f32,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) colour: vec3f,
    @location(3) selected: f32,
}

@vertex
fn vs_main(corner: Corner, instance: Instance) -> Varying {
    var out: Varying;
    out.position = corner.position + instance.offset;
    out.clip = frame.view_projection * vec4f(out.position, 1.0);
    out.normal = corner.normal;
    out.colour = instance.colour;
    out.selected = instance.selected;
    return out;
}

@fragment
fn fs_main(in: Varying, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    // Both sides are drawn: an open mesh has an inside to look at.
    let normal = normalize(select(-in.normal, in.normal, front));
    var colour = lit(in.colour, in.position, normal);
    let grazing = 1.0 - abs(dot(normal, normalize(in.position)));
    colour = mix(colour, vec3f(1.0), in.selected * (0.06 + 0.3 * pow(grazing, 3.0)));
    return vec4f(colour, 1.0);
}
