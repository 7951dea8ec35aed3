const SKY = vec3f(0.46, 0.50, 0.56);
const GROUND = vec3f(0.24, 0.225, 0.21);
const KEY = vec3f(0.66, 0.64, 0.60);

// Light from a matt, slightly glossy surface towards the eye at the origin; linear.
fn lit(albedo: vec3f, position: vec3f, normal: vec3f) -> vec3f {
    let to_eye = -normalize(position);
    let ambient = mix(GROUND, SKY, 0.5 + 0.5 * normal.y);
    // The key light reaches slightly around the side, like that of a large lamp.
    let facing = (dot(normal, frame.light) + 0.2) / 1.2;
    let key = KEY * max(facing, 0.0);
    let grazing = 1.0 - max(dot(normal, to_eye), 0.0);
    let rim = SKY * (0.22 * grazing * grazing * grazing);
    let gloss = pow(max(dot(normal, normalize(frame.light + to_eye)), 0.0), 40.0);
    return albedo * (ambient + key) + rim * (0.4 + 0.6 * albedo) + KEY * (0.07 * gloss);
}
