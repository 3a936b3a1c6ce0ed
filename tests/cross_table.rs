//! Learnt on squares, driven on circles and straights: OptiOdom's robot (Sousa et al. 2022) against its authors' calibrations.
//!
//! `UMBMARK_OPTIODOM=all cargo test -p umbmark-tests --test all cross_table -- --nocapture` prints the table of docs/studies/optiodom.md.

use std::io::Write;
use std::path::{Path, PathBuf};
use umbmark_core::calibrate::{self, Correction, Method, calibrate};
use umbmark_core::dataset::Dataset;
use umbmark_core::diagnose::{Options, first_model};
use umbmark_core::drive::{DifferentialDrive, Robot};
use umbmark_core::effect::Model;
use umbmark_core::evidence::fit;
use umbmark_core::geometry::wrap;
use umbmark_core::learn::learn;
use umbmark_core::replay::Track;

/// Squares to learn from, and the sets of other paths that were driven within the same days.
struct Days {
    name: &'static str,
    squares: [&'static str; 3],
    circles: [&'static str; 6],
    straights: &'static [&'static str],
}

const DAYS: [Days; 2] = [
    Days {
        name: "June",
        squares: ["230620202042", "230620202258", "230620202317"],
        circles: ["250620202104", "250620202119", "250620202236", "250620202251", "250620202317", "250620202345"],
        straights: &["250620201618", "250620201636", "250620201655", "250620201738"],
    },
    Days {
        name: "December",
        squares: ["231220200029", "231220200045", "231220200048"],
        circles: ["231220200121", "231220200141", "231220200146", "231220200150", "231220200154", "231220200157"],
        straights: &["231220200057", "231220200102", "231220200104"],
    },
];

/// The folder, or a notice that it is not there.
fn optiodom() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/optiodom");
    if folder.is_dir() {
        return Some(folder);
    }
    // Past the harness, which keeps what a passing test prints to itself.
    let _ = writeln!(std::io::stderr(), "skipped: {} is not there", folder.display());
    None
}

/// Whatever the controller of a set believed, ticks are ticks: one nominal robot, 84 mm and 200 mm, for all sets.
fn load(folder: &Path, kind: &str, sets: &[&str]) -> Dataset {
    let mut all: Option<Dataset> = None;
    for set in sets {
        let mut data = umbmark_io::load(folder.join("raw").join(kind).join(set)).unwrap();
        let robot = data.robot.take().unwrap();
        data.robot = Some(Robot { drive: DifferentialDrive::new(0.200, 0.084, 0.084).unwrap().into(), ..robot });
        data.runs.iter_mut().for_each(|run| run.name = format!("{set} {}", run.name));
        match &mut all {
            Some(all) => all.runs.extend(data.runs),
            None => all = Some(data),
        }
    }
    all.unwrap()
}

/// The authors' calibration from a set of squares: rows of `published_diff-METHOD.csv` give L, D_R, D_L \[m\].
fn published(folder: &Path, method: &str, set: &str, robot: &Robot) -> Model {
    let text = std::fs::read_to_string(folder.join(format!("published_diff-{method}.csv"))).unwrap();
    let row = text.lines().find(|line| line.starts_with(&format!("diff/square/{set}/"))).unwrap();
    let cells: Vec<&str> = row.split(',').collect();
    let [wheelbase, right, left] = [8, 9, 10].map(|i| cells[i].parse::<f64>().unwrap());
    let (e_d, e_b, e_s) = (right / left, wheelbase / 0.200, 0.5 * (right + left) / 0.084);
    Correction { e_d, e_b, e_s }.model(robot).unwrap()
}

/// Σ of squared errors of final positions \[m²\] and headings \[rad²\], and their number.
#[derive(Clone, Copy, Default)]
struct Ends([f64; 2], usize);

impl Ends {
    /// What the robot's own effects predict: clock and mounting of a reference belong to the set that they were learnt from.
    fn of(model: &Model, data: &Dataset) -> Ends {
        let mut ends = Ends::default();
        let of_reference = ["reference_delay", "reference_clock_rate", "marker_offset", "marker_yaw"];
        let model = of_reference.iter().fold(model.clone(), |model, effect| model.without(effect));
        for log in data.runs.iter().filter_map(|run| run.log.as_ref()).filter(|log| !log.reference.is_empty()) {
            let end = Track::from_log(log, model.robot()).unwrap().cut_at_last().end(&model.chain());
            let seen = log.reference.last().unwrap();
            let off = wrap(seen.heading.unwrap() - end.heading);
            ends.0[0] += (seen.x - end.x).powi(2) + (seen.y - end.y).powi(2);
            ends.0[1] += off * off;
            ends.1 += 1;
        }
        ends
    }

    fn plus(self, other: Ends) -> Ends {
        Ends([self.0[0] + other.0[0], self.0[1] + other.0[1]], self.1 + other.1)
    }

    /// Root mean square \[mm, degrees\].
    fn rms(&self) -> [f64; 2] {
        let root = |square: f64| (square / self.1.max(1) as f64).sqrt();
        [1e3 * root(self.0[0]), root(self.0[1]).to_degrees()]
    }
}

/// A name, and the model that it makes of squares: of the folder, a set's name, and its data.
type Way = (&'static str, fn(&Path, &str, &Dataset) -> Model);

const WAYS: [Way; 7] = [
    ("nominal", |_, _, data| Model::new(data.robot.as_ref().unwrap())),
    ("authors: UMBmark", |folder, set, data| published(folder, "UMBmark", set, data.robot.as_ref().unwrap())),
    ("authors: Jung & Chung", |folder, set, data| {
        published(folder, "Jung-and-Chung", set, data.robot.as_ref().unwrap())
    }),
    ("authors: OptiOdom", |folder, set, data| published(folder, "Sousa", set, data.robot.as_ref().unwrap())),
    ("calibrate", |_, _, data| {
        let calibration = calibrate(data, &calibrate::Options::default()).unwrap();
        let estimate = calibration.estimate(Method::Exact).unwrap();
        estimate.correction.model(data.robot.as_ref().unwrap()).unwrap()
    }),
    ("E_d, E_b, E_s from tracks", |_, _, data| fit(data, &first_model(data).unwrap()).unwrap().model),
    ("learn", |_, _, data| learn(data, &Options::default()).unwrap().model),
];

fn effects(model: &Model) -> String {
    let part = |part: &umbmark_core::effect::Part| {
        let values: Vec<String> = part.values.iter().map(|value| format!("{value:.5}")).collect();
        format!("{} {}", part.effect.name(), values.join(" "))
    };
    model.parts().iter().map(part).collect::<Vec<_>>().join(", ")
}

/// Errors on other squares, circles and straights of what is learnt from each set of squares.
fn tested(folder: &Path, days: &Days, way: &Way, sets: &[Vec<&str>]) -> Vec<[Ends; 3]> {
    let others = [load(folder, "circular", &days.circles), load(folder, "ivanjko", days.straights)];
    let of_set = |set: &Vec<&str>| {
        let mut errors = [Ends::default(); 3];
        let own = load(folder, "square", set);
        let model = way.1(folder, set[0], &own);
        let _ = writeln!(std::io::stderr(), "  {} {set:?} {}: {}", days.name, way.0, effects(&model));
        let rest: Vec<&str> = days.squares.iter().copied().filter(|other| !set.contains(other)).collect();
        if !rest.is_empty() {
            errors[0] = errors[0].plus(Ends::of(&model, &load(folder, "square", &rest)));
        }
        for (sum, data) in errors[1..].iter_mut().zip(&others) {
            *sum = sum.plus(Ends::of(&model, data));
        }
        errors
    };
    sets.iter().map(of_set).collect()
}

/// The sums of all sets that were learnt from.
fn sum(sets: &[[Ends; 3]]) -> [Ends; 3] {
    sets.iter().fold(Default::default(), |all: [Ends; 3], set| std::array::from_fn(|kind| all[kind].plus(set[kind])))
}

/// By how much one way is worse than another: mean and half the 95 % interval \[mm, degrees\] over the six sets that were learnt from.
fn worse(ours: &[[Ends; 3]], theirs: &[[Ends; 3]], of: impl Fn(&[Ends; 3]) -> Ends) -> [[f64; 2]; 2] {
    /// Student's t at 0.975 with five degrees of freedom.
    const T: f64 = 2.571;
    std::array::from_fn(|unit| {
        let each: Vec<f64> = ours.iter().zip(theirs).map(|(a, b)| of(a).rms()[unit] - of(b).rms()[unit]).collect();
        let n = each.len() as f64;
        let mean = each.iter().sum::<f64>() / n;
        let variance = each.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
        [mean, T * (variance / n).sqrt()]
    })
}

/// A row of the table.
fn tell(days: &str, way: &str, errors: &[Ends; 3]) {
    let cell = |ends: &Ends| {
        let [mm, deg] = ends.rms();
        if ends.1 > 0 { format!("{mm:.1} mm, {deg:.2} deg") } else { "-".to_owned() }
    };
    let [squares, circles, straights] = errors.each_ref().map(cell);
    let all = cell(&together(errors));
    let _ = writeln!(std::io::stderr(), "| {days} | {way} | {squares} | {circles} | {straights} | {all} |");
}

/// Errors on all runs that were not learnt from.
fn together(errors: &[Ends]) -> Ends {
    errors.iter().fold(Ends::default(), |sum, ends| sum.plus(*ends))
}

/// On circles, on straights and on all runs that were not learnt from, of both months, three values fitted to tracks end nearer than any
/// calibration that the authors published; on all runs `calibrate` and `learn` do too, and `learn` does on circles.
fn better_than_published(rows: &[(&str, &str, [Ends; 3])]) {
    let errors = |name: &str| rows.iter().find(|(days, way, _)| *days == "both" && *way == name).unwrap().2;
    let published = ["authors: UMBmark", "authors: Jung & Chung", "authors: OptiOdom"].map(errors);
    for (kind, what) in [(1, "circles"), (2, "straights and spins")] {
        let own = errors("E_d, E_b, E_s from tracks")[kind].rms()[0];
        let best = published.map(|ends| ends[kind].rms()[0]).into_iter().fold(f64::INFINITY, f64::min);
        assert!(own < best, "{what}: {own} mm, published {best} mm");
    }
    let [mm, deg] = errors("learn")[1].rms();
    assert!(
        published.iter().all(|ends| mm < ends[1].rms()[0] && deg < ends[1].rms()[1]),
        "learn, circles: {mm} mm, {deg} deg"
    );
    let best = published.map(|ends| together(&ends).rms()[0]).into_iter().fold(f64::INFINITY, f64::min);
    for way in ["calibrate", "E_d, E_b, E_s from tracks", "learn"] {
        let own = together(&errors(way)).rms()[0];
        assert!(own < best, "{way}: {own} mm, published {best} mm");
    }
}

/// Further effects that `learn` adds cost little on other paths: on average over the sets that were learnt from, it is worse than three values
/// fitted to tracks by at most 2 mm and 0.4 degrees. Squares do not show what circles tell of the wheelbase, and the backlash that squares
/// show moves it by a thousandth.
fn no_worse_than_three_numbers(by_set: &[(&str, Vec<[Ends; 3]>)]) {
    let errors = |name: &str| &by_set.iter().find(|(way, _)| *way == name).unwrap().1;
    for (kind, what) in ["other squares", "circles", "straights and spins", "all"].iter().enumerate() {
        let of = |set: &[Ends; 3]| if kind < 3 { set[kind] } else { together(set) };
        let [mm, deg] = worse(errors("learn"), errors("E_d, E_b, E_s from tracks"), of);
        let _ = writeln!(
            std::io::stderr(),
            "learn is worse by {:.1} ± {:.1} mm, {:.2} ± {:.2} deg on {what}",
            mm[0],
            mm[1],
            deg[0],
            deg[1]
        );
        assert!(mm[0] <= 2.0 && deg[0] <= 0.4, "{what}");
    }
}

#[test]
fn what_squares_teach_holds_on_circles_and_straights() {
    let Some(folder) = optiodom() else { return };
    let all = std::env::var("UMBMARK_OPTIODOM").is_ok_and(|which| which == "all");
    let (mut rows, mut by_set) = (Vec::new(), Vec::new());
    let _ = writeln!(
        std::io::stderr(),
        "| days | calibration | other squares | circles | straights and spins | all of these |"
    );
    for way in WAYS.iter().filter(|way| all || way.0 != "learn") {
        let mut both = Vec::new();
        for days in if all { &DAYS[..] } else { &DAYS[..1] } {
            let each = days.squares.map(|set| vec![set]);
            let errors = tested(&folder, days, way, &each);
            tell(days.name, way.0, &sum(&errors));
            rows.push((days.name, way.0, sum(&errors)));
            both.extend(errors);
            if all && !way.0.starts_with("authors") && way.0 != "nominal" {
                let name = format!("{}, all squares at once", way.0);
                tell(days.name, &name, &sum(&tested(&folder, days, way, &[days.squares.to_vec()])));
            }
        }
        if all {
            tell("both", way.0, &sum(&both));
            rows.push(("both", way.0, sum(&both)));
            by_set.push((way.0, both));
        }
    }
    if all {
        better_than_published(&rows);
        no_worse_than_three_numbers(&by_set);
    }
    let of =
        |name: &str| rows.iter().find(|(days, way, _)| *days == "June" && *way == name).unwrap().2.map(|e| e.rms()[0]);
    let (nominal, calibrated, tracks) = (of("nominal"), of("calibrate"), of("E_d, E_b, E_s from tracks"));
    assert!(calibrated.iter().zip(nominal).all(|(ours, uncalibrated)| *ours < 0.8 * uncalibrated), "{calibrated:?}");
    assert!(
        tracks.iter().zip(nominal).all(|(ours, uncalibrated)| *ours < 0.8 * uncalibrated),
        "{nominal:?} {tracks:?}"
    );
}
