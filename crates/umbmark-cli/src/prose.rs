//! Text for people, in lines that a terminal of 80 columns holds.

/// Columns of a line.
const WIDTH: usize = 80;

/// `text` after `head`, broken at spaces; further lines are indented as far as the text of the first one.
///
/// A head wider than `indent` stands on a line of its own.
pub fn hanging(head: &str, indent: usize, text: &str) -> String {
    let mut lines = String::new();
    let mut line = format!("{head:<indent$}");
    if head.chars().count() >= indent && !head.is_empty() {
        lines.push_str(head);
        lines.push('\n');
        line = " ".repeat(indent);
    }
    let mut fresh = true;
    for word in text.split_whitespace() {
        if !fresh && line.chars().count() + 1 + word.chars().count() > WIDTH {
            lines.push_str(line.trim_end());
            lines.push('\n');
            line = " ".repeat(indent);
            fresh = true;
        }
        if !fresh {
            line.push(' ');
        }
        line.push_str(word);
        fresh = false;
    }
    lines.push_str(line.trim_end());
    lines.push('\n');
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_text_hangs_below_its_first_word_and_fits_the_line() {
        let text = "a cable is laid ten times under the wheel that faces the inside of the square, over the first leg";
        let lines = hanging("  physics", 12, text);
        assert_eq!(
            lines,
            "  physics   a cable is laid ten times under the wheel that faces the inside of\n            \
             the square, over the first leg\n"
        );
        assert_eq!(hanging("a long head", 4, "text"), "a long head\n    text\n");
        assert_eq!(hanging("", 2, ""), "\n");
    }
}
