//! The words of a formula.

use super::error::{FormulaError, column};
use std::ops::Range;

/// A word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Token<'a> {
    Number(f64),
    Name(&'a str),
    Sign(char),
    End,
}

/// A word and where it stands.
pub(super) type Placed<'a> = (Token<'a>, Range<usize>);

/// The words of a text, and its end.
pub(super) fn tokens(text: &str) -> Result<Vec<Placed<'_>>, FormulaError> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        let (token, length) = match first {
            _ if first.is_whitespace() => {
                at += first.len_utf8();
                continue;
            }
            '+' | '-' | '*' | '/' | '^' | '(' | ')' | ',' => (Token::Sign(first), 1),
            '0'..='9' | '.' => number(text, at)?,
            _ if first.is_ascii_alphabetic() || first == '_' => {
                let length = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(rest.len());
                (Token::Name(&rest[..length]), length)
            }
            found => return Err(FormulaError::Character { column: column(text, at), found }),
        };
        found.push((token, at..at + length));
        at += length;
    }
    found.push((Token::End, text.len()..text.len()));
    Ok(found)
}

/// A number: digits with a point anywhere among them, and an exponent.
fn number(text: &str, at: usize) -> Result<(Token<'_>, usize), FormulaError> {
    let rest = &text.as_bytes()[at..];
    let digits = |from: usize| rest[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let mut length = digits(0);
    if rest.get(length) == Some(&b'.') {
        length += 1 + digits(length + 1);
    }
    if matches!(rest.get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(rest.get(length + 1), Some(b'+' | b'-')));
        let exponent = digits((length + 1 + sign).min(rest.len()));
        length += if exponent > 0 { 1 + sign + exponent } else { 0 };
    }
    let word = &text[at..at + length];
    let value = word.parse().ok().filter(|value: &f64| value.is_finite());
    let wrong = || FormulaError::Expected {
        column: column(text, at),
        expected: "a finite number",
        found: format!("\"{word}\""),
    };
    Ok((Token::Number(value.ok_or_else(wrong)?), length))
}
