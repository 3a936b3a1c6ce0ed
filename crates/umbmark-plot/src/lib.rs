//! Figures of UMBmark studies, drawn the same in a page, a paper and a terminal.
//!
//! A [`study::Study`] is a dataset beside a model, each part of it worked out once. A [`kind::FigureKind`] builds a [`figure::Figure`] from
//! it: numbers, their meaning and three sentences. [`render`] draws figures as Plotly's JSON, SVG, PNG, PDF and characters;
//! [`page`] puts a whole study on one page.
//!
//! ```no_run
//! use umbmark_core::dataset::Dataset;
//! use umbmark_plot::{kind, render::svg, study::{Options, Study}};
//! let study = Study::new("my robot", umbmark_io::load("my_robot")?, None, Options::default());
//! let figure = (kind::find("return_errors").unwrap().build)(&study)?;
//! println!("{}", svg::svg(&figure, &svg::Style::default()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod figure;
pub mod kind;
pub mod page;
pub mod render;
mod scale;
pub mod study;
mod thin;
mod tone;

pub use tone::Tone;
