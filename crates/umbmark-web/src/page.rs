//! The files of the page, which are part of the program.

use umbmark_plot::Tone;
use umbmark_plot::page::PLOTLY;

/// A file: its name, its type and its text.
type File = (&'static str, &'static str, &'static str);

const SCRIPT: &str = "text/javascript; charset=utf-8";

const FILES: [File; 13] = [
    ("", "text/html; charset=utf-8", include_str!("../front/index.html")),
    ("style.css", "text/css; charset=utf-8", include_str!("../front/style.css")),
    ("app.js", SCRIPT, include_str!("../front/app.js")),
    ("server.js", SCRIPT, include_str!("../front/server.js")),
    ("elements.js", SCRIPT, include_str!("../front/elements.js")),
    ("marks.js", SCRIPT, include_str!("../front/marks.js")),
    ("data.js", SCRIPT, include_str!("../front/data.js")),
    ("drive.js", SCRIPT, include_str!("../front/drive.js")),
    ("model.js", SCRIPT, include_str!("../front/model.js")),
    ("story.js", SCRIPT, include_str!("../front/story.js")),
    ("figures.js", SCRIPT, include_str!("../front/figures.js")),
    ("cloud.js", SCRIPT, include_str!("../front/cloud.js")),
    ("plotly.js", SCRIPT, PLOTLY),
];

/// The file of a name, with its type.
pub fn file(name: &str) -> Option<(&'static str, Vec<u8>)> {
    if name == "tones.css" {
        return Some(("text/css; charset=utf-8", tones().into_bytes()));
    }
    FILES.iter().find(|(own, ..)| *own == name).map(|(_, kind, text)| (*kind, text.as_bytes().to_vec()))
}

/// The colours by meaning, those of all figures.
fn tones() -> String {
    let of = |colour: fn(Tone) -> &'static str| {
        Tone::ALL.iter().map(|tone| format!(" --{}: {};", tone.name(), colour(*tone))).collect::<String>()
    };
    let (light, dark) = (of(Tone::on_white), of(Tone::on_black));
    format!(
        ":root {{{light} }}\n@media screen and (prefers-color-scheme: dark) {{ :root:not([data-theme=\"light\"]) {{{dark} }} }}\n\
         @media screen {{ :root[data-theme=\"dark\"] {{{dark} }} }}\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_that_the_page_names_is_there_and_none_is_elsewhere() {
        let mut named = 0;
        for (name, kind, text) in FILES.iter().filter(|(name, ..)| *name != "plotly.js") {
            for quoted in text.split(['"', '\'']).filter(|word| word.ends_with(".js") || word.ends_with(".css")) {
                let own = quoted.trim_start_matches("./");
                assert!(file(own).is_some(), "{name} names {quoted}");
                named += 1;
            }
            let far =
                ["http://", "https://", "//cdn"].iter().any(|far| text.replace("http://www.w3.org/", "").contains(far));
            assert!(!far, "{name} ({kind}) names another place");
        }
        assert!(named > 12, "{named}");
        assert!(file("../Cargo.toml").is_none() && file("nothing.js").is_none());
    }
}
