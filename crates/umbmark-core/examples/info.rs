use umbmark_core::{dataset::Dataset, likelihood::*, effect::Model};
fn main() {
    let dir = std::env::args().nth(1).unwrap();
    let data = Dataset::load(&dir).unwrap();
    let robot = data.nominal_robot().unwrap().clone();
    let observed = Observed::new(&data, &robot).unwrap();
    let mut model = Model::new(&robot);
    for n in ["wheel_diameter_ratio", "wheelbase", "scale"] { model.add(n).unwrap().free = true; }
    let fitted = observed.fit(&model, &Noise::default(), &[]).unwrap();
    println!("{:?}", fitted.noise);
    let cols = observed.columns(&fitted.model, &[0]);
    let run = &observed.runs[0];
    let w = fitted.noise.whiten(run, &[&cols[0][0]]);
    let mut acc = std::collections::BTreeMap::new();
    let mut k = 0;
    let mut prev = usize::MAX;
    for (row, b) in w.rows().zip(&w.block) {
        if *b != prev { k = 0; prev = *b; } else { k += 1; }
        let g = &run.blocks[*b].growth;
        let turning = g.way < 0.005;
        *acc.entry((turning, k)).or_insert(0.0) += row[0] * row[0];
    }
    println!("info by (turning, row): {:?}; total {:?} -> sd/run {:.2e}", acc, acc.values().sum::<f64>(), 1.0 / acc.values().sum::<f64>().sqrt());
    let mut per = vec![[0.0; 3]; run.blocks.len()]; let mut k = 0; let mut prev = usize::MAX;
    for (row, b) in w.rows().zip(&w.block) { if *b != prev { k = 0; prev = *b; } else { k += 1; } per[*b][k] = row[0] * row[0]; }
    for b in 0..140 { println!("{b} way {:.4} count {} {:?} info {:?}", run.blocks[b].growth.way, run.blocks[b].count, run.blocks[b].place, per[b].map(|v| v as i64)); }
    for b in 130..1 { println!("{:?} {:?}", run.blocks[b].growth.way, (run.blocks[b].place, run.blocks[b].count, cols[0][0][b])); }
}
