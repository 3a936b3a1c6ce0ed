use std::time::Instant;
use umbmark_core::{
    dataset::Dataset,
    diagnose::{Options, explore::*},
    likelihood::*,
};
fn main() {
    for dir in std::env::args().skip(1) {
        let data = Dataset::load(&dir).unwrap();
        let robot = data.nominal_robot().unwrap().clone();
        let observed = Observed::new(&data, &robot).unwrap();
        println!(
            "== {dir}: {} runs, {} blocks, {} poses",
            observed.runs.len(),
            observed.runs.iter().map(|r| r.blocks.len()).sum::<usize>(),
            observed.runs.iter().map(|r| r.seen.len()).sum::<usize>()
        );
        let t = Instant::now();
        let f = learn(&observed, &Options::default(), &mut |s| {
            println!(
                "{:6.2?} {:?} {:?} p {:?} inside {:.2} mm {:.3} mrad held out {:.2} mm {:.3} mrad {}",
                t.elapsed(),
                s.added,
                s.class,
                s.p,
                1e3 * s.inside.position,
                1e3 * s.inside.heading.unwrap_or(0.0),
                1e3 * s.heldout.position,
                1e3 * s.heldout.heading.unwrap_or(0.0),
                s.note
            )
        })
        .unwrap();
        println!("{:?} {:?}", t.elapsed(), f.noise);
    }
}
