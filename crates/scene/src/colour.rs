//! Colours as `#rrggbb`.

/// Parses `#rrggbb` into red, green and blue from 0 to 1, sRGB-encoded as written.
pub(crate) fn parse(text: &str) -> Option<[f32; 3]> {
    let digits = text.strip_prefix('#')?;
    if digits.len() != 6 || !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return None;
    }
    let number = u32::from_str_radix(digits, 16).ok()?;
    let [_, r, g, b] = number.to_be_bytes();
    Some([r, g, b].map(|byte| f32::from(byte) / 255.0))
}

/// Writes a colour as `#rrggbb`, to the nearest of the 256 steps.
pub(crate) fn format(colour: [f32; 3]) -> String {
    let [r, g, b] = colour.map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_survives() {
        for byte in 0..=255_u8 {
            let text = format!("#00{byte:02x}ff");
            let colour = parse(&text).expect("a colour");
            assert_eq!(format(colour), text);
        }
        assert_eq!(parse("#FF8000"), parse("#ff8000"));
        for wrong in ["", "#", "ff8000", "#ff800", "#ff80001", "#+f8000", "#ff80é"] {
            assert_eq!(parse(wrong), None, "{wrong}");
        }
    }
}
