//! Tests of the files, one program: a file here is a module.

#![allow(clippy::unwrap_used)]

mod bad_input;
mod clocks_real;
mod dataset_errors;
mod dataset_reading;
mod dataset_real;
mod dataset_writing;
mod edges;
mod joined_tables;
mod mcap_bad_input;
mod mcap_log;
mod mcap_reading;
mod mcap_real;
mod optiodom;
#[path = "bad_input/sentences.rs"]
mod sentences;
