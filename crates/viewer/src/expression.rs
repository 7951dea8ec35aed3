//! Numbers as users type them into fields: `1.5`, `-2e-3`, `1/60`, `2*(3 + 4)`, `pi`.

/// The most characters of a text, and the deepest nesting of brackets.
const LONGEST: usize = 200;
const DEEPEST: usize = 20;

/// The value of a number or of a sum, product or quotient of numbers. `None` if the text is not such an expression or
/// its value is not a number.
pub fn value(text: &str) -> Option<f64> {
    if text.len() > LONGEST {
        return None;
    }
    // The signs minus, times and divided may be typographic.
    let text: String = text
        .chars()
        .map(|c| match c {
            '\u{2212}' => '-',
            '×' | '·' => '*',
            '÷' => '/',
            c => c,
        })
        .collect();
    let mut rest = Rest {
        text: &text,
        depth: 0,
    };
    let value = rest.sum()?;
    (rest.peek().is_none() && !value.is_nan()).then_some(value)
}

/// The text that has not been parsed yet.
struct Rest<'a> {
    text: &'a str,
    depth: usize,
}

impl Rest<'_> {
    fn peek(&mut self) -> Option<char> {
        self.text = self.text.trim_start();
        self.text.chars().next()
    }

    fn take(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        if found {
            self.text = &self.text[wanted.len_utf8()..];
        }
        found
    }

    fn sum(&mut self) -> Option<f64> {
        let mut value = self.product()?;
        loop {
            if self.take('+') {
                value += self.product()?;
            } else if self.take('-') {
                value -= self.product()?;
            } else {
                return Some(value);
            }
        }
    }

    fn product(&mut self) -> Option<f64> {
        let mut value = self.signed()?;
        loop {
            if self.take('*') {
                value *= self.signed()?;
            } else if self.take('/') {
                value /= self.signed()?;
            } else {
                return Some(value);
            }
        }
    }

    fn signed(&mut self) -> Option<f64> {
        let mut sign = 1.0;
        loop {
            if self.take('-') {
                sign = -sign;
            } else if !self.take('+') {
                return Some(sign * self.single()?);
            }
        }
    }

    fn single(&mut self) -> Option<f64> {
        if self.take('(') {
            self.depth += 1;
            if self.depth > DEEPEST {
                return None;
            }
            let value = self.sum()?;
            self.depth -= 1;
            return self.take(')').then_some(value);
        }
        self.peek()?;
        let mut end = 0;
        let mut before = ' ';
        for (at, c) in self.text.char_indices() {
            // A sign after an `e` belongs to the exponent.
            let exponent = matches!(c, '+' | '-') && matches!(before, 'e' | 'E');
            if !(c.is_ascii_alphanumeric() || c == '.' || exponent) {
                break;
            }
            (end, before) = (at + 1, c);
        }
        let (word, rest) = self.text.split_at(end);
        self.text = rest;
        match word {
            "pi" | "π" => Some(std::f64::consts::PI),
            word => word.parse().ok(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::value;

    #[test]
    fn numbers_and_what_is_made_of_them() {
        for (text, expected) in [
            (" 1.5 ", 1.5),
            ("\u{2212}2e-3", -2e-3),
            ("1e+3", 1e3),
            ("inf", f64::INFINITY),
            ("1/60", 1.0 / 60.0),
            ("2*3", 6.0),
            ("2 * (3 + 4) - 1", 13.0),
            ("1 - 2 - 3", -4.0),
            ("8 / 2 / 2", 2.0),
            ("--2", 2.0),
            ("-(2+3)*2", -10.0),
            ("2*pi", std::f64::consts::TAU),
            ("3×2÷4", 1.5),
        ] {
            assert_eq!(value(text), Some(expected), "{text}");
        }
    }

    #[test]
    fn what_is_no_number_is_refused() {
        let deep = "(".repeat(10_000);
        let long = "1+".repeat(10_000) + "1";
        for text in [
            "", " ", "nan", "hello", "1,5", "1 2", "2*", "*2", "(1", "1)", "()", "1..2", "0/0",
            "e", "inf-inf", "π!", &deep, &long,
        ] {
            assert_eq!(value(text), None, "{text}");
        }
    }
}
