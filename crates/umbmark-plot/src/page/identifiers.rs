//! Names of effects, files and keys in sentences: small, in a typewriter's letters.

use minijinja::Value;

/// A text as HTML, in which commands between backticks and names with an underscore stand as code.
pub(super) fn marked(text: &str) -> Value {
    let mut html = String::with_capacity(text.len() + 16);
    let parts: Vec<&str> = text.split('`').collect();
    let has_pairs = parts.len() % 2 == 1;
    for (place, part) in parts.into_iter().enumerate() {
        match (has_pairs, place % 2) {
            (true, 1) => {
                html.push_str("<code>");
                push_escaped(&mut html, part);
                html.push_str("</code>");
            }
            (false, _) if place > 0 => push_names(&mut html, &format!("`{part}")),
            _ => push_names(&mut html, part),
        }
    }
    Value::from_safe_string(html)
}

fn push_names(html: &mut String, text: &str) {
    let mut rest = text;
    while let Some(start) = rest.find(is_of_name) {
        let (before, from) = rest.split_at(start);
        let (word, after) = from.split_at(from.find(|c| !is_of_name(c)).unwrap_or(from.len()));
        push_escaped(html, before);
        match is_identifier(word) {
            true => html.push_str(&format!("<code>{}</code>", word.replace('_', "_<wbr>"))),
            false => push_escaped(html, word),
        }
        rest = after;
    }
    push_escaped(html, rest);
}

fn is_of_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || matches!(c, '_' | '-')
}

/// Two small letters at least before the first underscore: E_d is a symbol, wheel_noise a name.
fn is_identifier(word: &str) -> bool {
    word.split_once('_').is_some_and(|(first, rest)| {
        first.len() > 1 && !rest.is_empty() && first.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
    })
}

fn push_escaped(html: &mut String, text: &str) {
    for c in text.chars() {
        match c {
            '&' => html.push_str("&amp;"),
            '<' => html.push_str("&lt;"),
            '>' => html.push_str("&gt;"),
            '"' => html.push_str("&quot;"),
            '\'' => html.push_str("&#x27;"),
            c => html.push(c),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_code_and_symbols_are_not() {
        let html = marked("E_d of wheel_noise, cw_01 <b> & E_max,sys").to_string();
        assert_eq!(html, "E_d of <code>wheel_<wbr>noise</code>, <code>cw_<wbr>01</code> &lt;b&gt; &amp; E_max,sys");
    }

    #[test]
    fn commands_are_code_and_a_single_backtick_is_itself() {
        assert_eq!(marked("run `a_b -o <x>` now").to_string(), "run <code>a_b -o &lt;x&gt;</code> now");
        assert_eq!(marked("one ` only").to_string(), "one ` only");
    }

    #[test]
    fn a_name_cannot_bring_html() {
        assert_eq!(marked("a_<script>_b").to_string(), "a_&lt;script&gt;_b");
    }
}
