//! The paper put to the test: the figures and numbers of `docs/studies/umbmark_paper.md`.
//!
//! ```sh
//! cargo run --release -p umbmark-tests --example study_umbmark
//! ```
//!
//! prints every table and draws the figures into `docs/studies`. A number after it is a factor on the numbers of simulated tests;
//! a second one is another seed.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod bias;
mod bump_places;
mod calibrated;
mod figure;
mod one_direction;
mod shares;
mod susceptibility;

use std::path::Path;
use umbmark_core::calibrate::Correction;
use umbmark_core::drive::Robot;
use umbmark_core::effect::Model;

/// What all parts of the study share.
#[derive(Clone, Copy, Debug)]
pub struct Study<'a> {
    /// Factor on the numbers of simulated tests.
    pub factor: f64,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Where figures go.
    pub folder: &'a Path,
}

impl Study<'_> {
    /// A number of simulated tests, times the factor.
    pub fn tests(&self, usual: u64) -> u64 {
        ((usual as f64 * self.factor) as u64).max(20)
    }
}

/// The paper's robot with E_d and E_b, and wheel noise k \[m^0.5\].
pub fn labmate(e_d: f64, e_b: f64, k: f64) -> Model {
    let mut model = Correction { e_d, e_b, e_s: 1.0 }.model(&Robot::labmate()).unwrap();
    model.set("wheel_noise", "k_sqrt_m", k).unwrap();
    model
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let factor = arguments.next().map_or(1.0, |text| text.parse().expect("a factor on the numbers of tests"));
    let seed = arguments.next().map_or(1, |text| text.parse().expect("a seed"));
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/studies");
    std::fs::create_dir_all(&folder).expect("docs/studies can be made");
    let study = Study { factor, seed, folder: &folder };
    println!("seed {seed}, numbers of tests times {factor}\n");
    bias::study(&study);
    susceptibility::study(&study);
    bump_places::study(&study);
    one_direction::study(&study);
    calibrated::study(&study);
}
