//! Numbers of things in sentences.

/// So many things, by the word for one of them: "1 log", "2 logs", "0 bodies".
///
/// ```
/// use umbmark_core::prose::counted;
/// assert_eq!(counted(1, "run"), "1 run");
/// assert_eq!(counted(3, "more pair"), "3 more pairs");
/// assert_eq!([0, 2].map(|n| counted(n, "body")), ["0 bodies", "2 bodies"]);
/// assert_eq!(counted(2, "pass"), "2 passes");
/// ```
pub fn counted(count: usize, noun: &str) -> String {
    format!("{count} {}", of(count, noun))
}

/// "a", "a and b", "a, b and c".
///
/// ```
/// use umbmark_core::prose::listed;
/// assert_eq!(listed(&["wheelbase"]), "wheelbase");
/// assert_eq!(listed(&["E_d", "E_b", "E_s"]), "E_d, E_b and E_s");
/// ```
pub fn listed<S: AsRef<str>>(words: &[S]) -> String {
    let words: Vec<&str> = words.iter().map(S::as_ref).collect();
    match words.as_slice() {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [rest @ .., last] => format!("{} and {last}", rest.join(", ")),
    }
}

/// The word for one thing or for several of them, as their number asks for.
pub fn of(count: usize, noun: &str) -> String {
    let vowel_before_y = ["ay", "ey", "oy", "uy"].iter().any(|end| noun.ends_with(end));
    match noun {
        _ if count == 1 => noun.to_owned(),
        _ if noun.ends_with('y') && !vowel_before_y => format!("{}ies", &noun[..noun.len() - 1]),
        _ if ["s", "x", "ch", "sh"].iter().any(|end| noun.ends_with(end)) => format!("{noun}es"),
        _ => format!("{noun}s"),
    }
}

/// The text without minus zeros: a number that rounds to nothing has no sign.
///
/// ```
/// use umbmark_core::prose::unsigned_zeros;
/// assert_eq!(unsigned_zeros("-0 degrees, (-0.00 to -0.05), run-01, 1e-0"), "0 degrees, (0.00 to -0.05), run-01, 1e-0");
/// ```
pub fn unsigned_zeros(text: &str) -> String {
    let mut kept = String::with_capacity(text.len());
    let mut before = ' ';
    for (place, character) in text.char_indices() {
        let number = &text[place + character.len_utf8()..];
        let is_minus_zero = character == '-' && !before.is_alphanumeric() && !"-._".contains(before) && {
            let digits = number.trim_start_matches(['0', '.']);
            number.starts_with('0') && !digits.starts_with(|next: char| next.is_alphanumeric())
        };
        if !is_minus_zero {
            kept.push(character);
        }
        before = character;
    }
    kept
}
