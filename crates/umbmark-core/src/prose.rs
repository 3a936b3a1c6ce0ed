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
