//! Tests of the command, one program: a file here is a module.

#![allow(clippy::unwrap_used)]

mod apply;
mod bad_flags;
mod begin;
mod book;
mod changed;
mod conditions;
mod data;
mod embedded;
mod export;
mod faults;
mod formula;
mod interrupt;
mod laws;
mod r#loop;
mod mc;
mod memory;
mod open;
mod paper;
mod plan;
mod python_classes;
mod python_keys;
mod report;
mod returns;
mod robot_numbers;
mod score_calibrate;
mod sensitivity;
mod simulate;
mod solve;
mod streams;
mod survey;
mod terminal;
mod together;
mod watch;
