use std::time::Instant;
use umbmark_core::{dataset::Dataset, diagnose::{Options, explore::*}, effect::Model, likelihood::*};
fn main() {
    for dir in std::env::args().skip(1) {
        let data = Dataset::load(&dir).unwrap();
        let robot = data.nominal_robot().unwrap().clone();
        let t = Instant::now();
        let observed = Observed::new(&data, &robot).unwrap();
        println!("== {dir}: {} runs, {} blocks, {} poses, load {:?}", observed.runs.len(), observed.runs.iter().map(|r| r.blocks.len()).sum::<usize>(), observed.runs.iter().map(|r| r.seen.len()).sum::<usize>(), t.elapsed());
        let mut model = Model::new(&robot);
        for n in ["wheel_diameter_ratio", "wheelbase", "scale"] { model.add(n).unwrap().free = true; }
        let t = Instant::now();
        let fitted = observed.fit(&model, &Noise::default()).unwrap();
        println!("fit {:?}: {:?} noise {:?}", t.elapsed(), fitted.model.values().collect::<Vec<_>>(), fitted.noise);
        let t = Instant::now();
        let exam = Examination::new(&observed, fitted).unwrap();
        println!("exam {:?} noise {:?}", t.elapsed(), exam.fitted.noise);
        let t = Instant::now();
        let mut found: Vec<usize> = vec![];
        for _ in 0..3 {
            let f = look(&exam, &found, false, &Options::default());
            let s = look(&exam, &found, true, &Options::default());
            println!("look {:?}", t.elapsed());
            for x in f.iter().take(5) {
                let su = suspect(&exam, x, &found).unwrap();
                println!("  {:28} drop {:9.1} F {:9.1} p_f {:.1e} flips {:.4}  {:?} {:?}", su.best, su.expected_drop, su.f, x.p_f, x.p_flips, su.estimate.iter().map(|e| format!("{}={:.5}±{:.5}", e.parameter, e.value, e.standard_error)).collect::<Vec<_>>(), su.class);
            }
            for x in s.iter().take(3) {
                println!("     smooth {:?} drop {:9.1} p_f {:.1e} flips {:.4}", exam.asked[x.answer.asked].question, x.answer.drop, x.p_f, x.p_flips);
            }
            if !f[0].certified(&Options::default()) { break; }
            found.extend(&f[0].answer.columns);
        }
    }
}
