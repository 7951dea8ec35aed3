//! Error messages of a world, with the names of bodies in place of their indices.

use std::fmt::Display;

use scene::{Scene, shown};
use sim_core::{SeparateError, StepError};

/// The most overlaps, or bodies, that a message names individually.
pub const NAMED: usize = 8;

/// The message of a failed step: names the scene and the body.
pub fn step_error(scene: &Scene, error: &StepError) -> String {
    format!(
        "scene `{}`: {}",
        shown::name(&scene.name),
        with_names(scene, error)
    )
}

/// The reason why bodies cannot be moved apart, with their names.
pub fn separate_error(scene: &Scene, error: &SeparateError) -> String {
    let name = |&body: &usize| {
        scene
            .bodies
            .get(body)
            .map_or("?", |body| body.name.as_str())
    };
    let all = |bodies: &[usize]| names(&bodies.iter().map(name).collect::<Vec<_>>());
    match error {
        SeparateError::Caught { body, walls } => format!(
            "`{}` does not fit between the half-spaces {}: make it smaller, or move one of them",
            shown::name(name(body)),
            all(walls)
        ),
        SeparateError::NoRoom { body, others } => format!(
            "no place was found for `{}`, which overlaps {}: move it, or one of them",
            shown::name(name(body)),
            all(others)
        ),
    }
}

/// An error's message with the names of bodies in place of their indices.
pub fn with_names(scene: &Scene, error: &impl Display) -> String {
    let message = error.to_string();
    let mut words = Vec::new();
    // Whether the next number is a body, and whether the number after it is one too.
    let (mut one, mut more) = (false, false);
    for word in message.split(' ') {
        let end = word
            .find(|c: char| !c.is_ascii_digit())
            .unwrap_or(word.len());
        let body = word[..end].parse::<usize>().ok().filter(|_| one);
        match body.map(|body| scene.bodies.get(body)) {
            Some(body) => {
                let name = body.map_or("?", |body| &body.name);
                words.push(format!("`{}`{}", shown::name(name), &word[end..]));
                (one, more) = (more, false);
            }
            None => {
                words.push(word.to_owned());
                (one, more) = match word {
                    "body" => (true, false),
                    "bodies" => (true, true),
                    "and" => (one, more),
                    _ => (false, false),
                };
            }
        }
    }
    words.join(" ")
}

/// The names of some bodies; if there are many, the first ones and the total number.
pub fn names(of: &[&str]) -> String {
    let named: Vec<String> = of
        .iter()
        .take(NAMED)
        .map(|name| shown::name(name))
        .collect();
    let more = of.len().saturating_sub(NAMED);
    match more {
        0 => named.join(", "),
        _ => format!("{} and {more} more", named.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{Scene, with_names};

    #[test]
    fn errors_name_every_body_and_no_other_number() {
        let text = "rate = 60\n[[body]]\nname = \"body 1\"\nmesh = \"cube.obj\"\n[[body]]\nname = \"wall\"\nmesh = \"cube.obj\"";
        let scene = Scene::parse(text, Path::new("s.toml")).expect("a scene");
        for (message, named) in [
            (
                "step 3: body 1 is squeezed between bodies 0 and 1, which nothing stops",
                "step 3: body `wall` is squeezed between bodies `body 1` and `wall`, which nothing stops",
            ),
            ("body 0: mass is 0", "body `body 1`: mass is 0"),
            ("body 7 in 40 iterations", "body `?` in 40 iterations"),
            ("nobody 1, and 2 bodies", "nobody 1, and 2 bodies"),
        ] {
            assert_eq!(with_names(&scene, &message), named);
        }
    }
}
