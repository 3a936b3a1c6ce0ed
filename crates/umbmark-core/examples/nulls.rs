use umbmark_core::{
    dataset::Dataset,
    diagnose::{Options, explore::*},
    effect::Model,
    likelihood::*,
};
fn main() {
    for dir in std::env::args().skip(1) {
        let data = Dataset::load(&dir).unwrap();
        let robot = data.nominal_robot().unwrap().clone();
        let observed = Observed::new(&data, &robot).unwrap();
        let mut model = Model::new(&robot);
        for n in ["wheel_diameter_ratio", "wheelbase", "scale"] {
            model.add(n).unwrap().free = true;
        }
        let fitted = observed.fit(&model, &Noise::default(), &[]).unwrap();
        let truth: String = std::fs::read_to_string(format!("{dir}.truth.json")).unwrap();
        let get = |k: &str| {
            truth
                .split(&format!("\"{k}\": "))
                .nth(1)
                .unwrap()
                .split([',', '\n'])
                .next()
                .unwrap()
                .parse::<f64>()
                .unwrap()
        };
        let cov = fitted.covariance.clone().unwrap();
        let v: Vec<f64> = fitted.model.values().collect();
        let z: Vec<f64> =
            ["e_d", "e_b", "e_s"].iter().enumerate().map(|(i, k)| (v[i] - get(k)) / cov[(i, i)].sqrt()).collect();
        let sd: Vec<f64> = (0..3).map(|i| cov[(i, i)].sqrt()).collect();
        let exam = Examination::new(fitted).unwrap();
        let f = look(&exam, &[], false, &Options::default());
        let s = look(&exam, &[], true, &Options::default());
        let before = held_out(&exam);
        let (after, _) = nested(&exam);
        println!(
            "z {:?} sd {:?} | best {} drop {:.1} p_f {:.3} flips {:.3} | smooth {:.1} p_f {:.1e} flips {:.3} | {:.2} -> {:.2} noise {:.2e} {:.2e} {:.2e} {:.2e} {:.2e}",
            z.iter().map(|z| (z * 100.0).round() / 100.0).collect::<Vec<_>>(),
            sd,
            exam.asked[f[0].answer.asked].effect().unwrap().about.name,
            f[0].answer.drop,
            f.iter().map(|f| f.p_f).fold(1.0, f64::min),
            f.iter().map(|f| f.p_flips).fold(1.0, f64::min),
            s[0].answer.drop,
            s[0].p_f,
            s.iter().map(|f| f.p_flips).fold(1.0, f64::min),
            1e3 * before.position,
            1e3 * after.position,
            exam.fitted.noise.heading_per_metre,
            exam.fitted.noise.heading_per_radian,
            exam.fitted.noise.forward_per_metre,
            exam.fitted.noise.reference_position,
            exam.fitted.noise.reference_heading
        );
    }
}
