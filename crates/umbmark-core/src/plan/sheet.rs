//! The sheet to drive by, as text and as a page to print.

use super::{Protocol, ProtocolRun};
use crate::effect::TestKind;

const TITLE: &str = "UMBmark test sheet";

/// What a cell holds before anything was measured: what the run is.
fn cell(column: &str, run: &ProtocolRun) -> String {
    match column {
        "test" => run.test.name().to_owned(),
        "direction" => run.direction.name().to_owned(),
        "run" => run.number.to_string(),
        _ => String::new(),
    }
}

impl Protocol {
    /// Markdown, readable as it is.
    pub fn markdown(&self) -> String {
        let mut text = format!("# {TITLE}: {}\n\n{}\n\n", self.robot, self.summary);
        text += "Date: ____________  Floor: ____________  Load: ____________  Measured by: ____________\n\n";
        for (number, step) in self.steps.iter().enumerate() {
            text += &format!("{}. {step}\n", number + 1);
        }
        let width =
            |column: &str| column.len().max(if column == "test" { TestKind::Systematic.name().len() } else { 9 });
        let row = |cells: &mut dyn Iterator<Item = String>| format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "));
        text += "\n";
        text += &row(&mut self.columns.iter().map(|c| format!("{c:<0$}", width(c))));
        text += &row(&mut self.columns.iter().map(|c| "-".repeat(width(c))));
        for run in &self.runs {
            text += &row(&mut self.columns.iter().map(|c| format!("{:<1$}", cell(c, run), width(c))));
        }
        text
    }

    /// One page of A4 for up to sixty runs: rows are as high as there is room.
    pub fn html(&self) -> String {
        let mut page = format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{TITLE}: {0}</title>\n<style>\n{1}</style>\n\
             </head>\n<body>\n<h1>{TITLE}: {0}</h1>\n<p>{2}</p>\n<p class=\"blanks\"><span>Date</span><span>Floor</span>\
             <span>Load</span><span>Measured by</span></p>\n<ol>\n",
            escaped(&self.robot),
            style(self.runs.len()),
            escaped(&self.summary)
        );
        for step in &self.steps {
            page += &format!("<li>{}</li>\n", escaped(step));
        }
        page += "</ol>\n<table>\n<tr>";
        for column in &self.columns {
            page += &format!("<th>{column}</th>");
        }
        page += "</tr>\n";
        for run in &self.runs {
            page += "<tr>";
            for column in &self.columns {
                page += &format!("<td>{}</td>", cell(column, run));
            }
            page += "</tr>\n";
        }
        page + "</table>\n</body>\n</html>\n"
    }
}

/// The page has some 160 mm for the table.
fn style(rows: usize) -> String {
    let height = (160.0 / (rows + 1) as f64).clamp(2.6, 9.0);
    let size = (height * 1.7).clamp(6.0, 9.5);
    format!(
        "@page {{ size: A4; margin: 12mm; }}\n\
         body {{ font: 9.5pt/1.3 sans-serif; max-width: 186mm; margin: 0 auto; color: #000; background: #fff; }}\n\
         h1 {{ font-size: 14pt; margin: 0 0 2mm; }}\np {{ margin: 0 0 2mm; }}\nol {{ margin: 0 0 3mm; padding-left: 6mm; }}\n\
         .blanks {{ display: flex; gap: 4mm; }}\n.blanks span {{ flex: 1; border-bottom: 0.3mm solid #000; }}\n\
         table {{ border-collapse: collapse; width: 100%; font-size: {size:.1}pt; line-height: 1; break-inside: avoid; }}\n\
         th, td {{ border: 0.2mm solid #000; height: {height:.1}mm; padding: 0 1mm; text-align: left; }}\n"
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
