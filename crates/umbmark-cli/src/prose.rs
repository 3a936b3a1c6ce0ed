//! Text for people, in lines that a terminal of 80 columns holds.

use umbmark_core::prose::unsigned_zeros;

/// Columns of a line.
pub const WIDTH: usize = 80;

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
    for word in unsigned_zeros(text).split_whitespace() {
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

/// What more there is to see.
pub fn details_text(what: &str) -> String {
    format!("\n{}", hanging("", 0, &format!("--verbose prints the tables: {what}.")))
}

/// A name that is no longer than some characters: what is too long loses its middle, because names of logs differ at the end.
pub fn shortened(name: &str, longest: usize) -> String {
    let characters: Vec<char> = name.chars().collect();
    if characters.len() <= longest {
        return name.to_owned();
    }
    let begin = longest / 2;
    let end = longest - begin - 1;
    let part = |part: &[char]| part.iter().collect::<String>();
    format!("{}…{}", part(&characters[..begin]), part(&characters[characters.len() - end..]))
}

/// Lines of prose broken at spaces, each further line indented as the one that it belongs to. Lines of a table, in which two spaces
/// stand between words, stay as they are.
pub fn wrapped(text: &str) -> String {
    let line = |line: &str| {
        let inner = line.trim_start();
        if line.chars().count() <= WIDTH || inner.contains("  ") {
            return format!("{line}\n");
        }
        let indent = line.chars().count() - inner.chars().count();
        hanging("", indent, inner)
    };
    text.lines().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_keep_both_ends_and_short_ones_all() {
        assert_eq!(shortened("rosbag2_2026_11_02-10_31_07", 11), "rosba…31_07");
        assert_eq!(shortened("cw_01", 5), "cw_01");
        assert_eq!(shortened("äöüß", 3), "ä…ß");
    }

    #[test]
    fn prose_is_broken_and_tables_are_not() {
        let prose = format!("  {}end", "word ".repeat(20));
        let row = "a  ".repeat(40);
        let text = wrapped(&format!("{prose}\n{row}\nshort\n"));
        assert_eq!(text.lines().map(|line| line.chars().count()).collect::<Vec<_>>(), [76, 30, 120, 5]);
        assert!(text.lines().nth(1).unwrap().starts_with("  word"));
    }

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
