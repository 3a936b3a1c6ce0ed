//! `umbmark paper`: the experiments of Borenstein & Feng (1995), beside their numbers.

use std::io::Write;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use umbmark_core::paper::{
    self, Bench, BothWays, BumpPlace, Cluster, LinkError, Masking, PaperError, PublishedNumber, TableOne, TableTwo,
};
use umbmark_core::result::Paper;
use umbmark_core::watch::Watch;

use crate::Session;
use crate::prose::wrapped;
use crate::table::table;

/// An experiment of the paper.
#[derive(Clone, Copy, Debug, PartialEq, clap::ValueEnum)]
enum Experiment {
    /// Table I: E_max,sys and sigma of every robot
    #[value(name = "table-1")]
    TableOne,
    /// Table II: the extended test with ten bumps of 10 mm
    #[value(name = "table-2")]
    TableTwo,
    /// Figures 2 to 4: two errors that cancel in one direction and add up in the other
    #[value(name = "figure-2")]
    FigureTwo,
    /// Figure 5: two clusters of return positions
    #[value(name = "figure-5")]
    FigureFive,
    /// Figure 6: where the bumps lie
    #[value(name = "figure-6")]
    FigureSix,
    /// Section 3.1: what a figure-eight hides
    #[value(name = "figure-eight")]
    FigureEight,
    /// Section 4.5: the 7 x 4 m rectangle instead of the square
    #[value(name = "rectangle")]
    Rectangle,
    /// All of them
    #[value(name = "all")]
    All,
}

/// Arguments of `paper`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The experiment
    #[arg(value_enum, value_name = "EXPERIMENT", default_value = "all")]
    experiment: Experiment,

    /// Simulated tests of each robot, for the tables
    #[arg(short = 'n', long, default_value_t = 2000, value_name = "N", value_parser = crate::numbers::whole_in::<u64>(10..=10_000_000))]
    trials: u64,
}

/// Adds what an experiment found.
type Run = fn(&Bench, &mut Paper) -> Result<(), PaperError>;

const EXPERIMENTS: [(Experiment, Run); 7] = [
    (Experiment::TableOne, |bench, all| paper::table_one(bench).map(|found| all.table_1 = Some(found))),
    (Experiment::TableTwo, |bench, all| paper::table_two(bench).map(|found| all.table_2 = Some(found))),
    (Experiment::FigureTwo, |_, all| paper::masking().map(|found| all.figure_2 = Some(found))),
    (Experiment::FigureFive, |bench, all| paper::clusters(bench.seed).map(|found| all.figure_5 = Some(found))),
    (Experiment::FigureSix, |_, all| paper::bump_places().map(|found| all.figure_6 = Some(found))),
    (Experiment::FigureEight, |_, all| paper::figure_eight().map(|found| all.figure_eight = Some(found))),
    (Experiment::Rectangle, |_, all| paper::rectangle().map(|found| all.rectangle = Some(found))),
];

pub(super) fn run(arguments: Arguments, session: &mut Session) -> anyhow::Result<ExitCode> {
    let wanted = |experiment: Experiment| [experiment, Experiment::All].contains(&arguments.experiment);
    let (trials, seed) = (arguments.trials, session.seed());
    let mut found = Paper::new(seed);
    for (_, run) in EXPERIMENTS.iter().filter(|(experiment, _)| wanted(*experiment)) {
        session.told("% of the tests", |progress| {
            let stop = AtomicBool::new(false);
            run(&Bench { trials, seed, watch: &Watch::new(&stop, progress) }, &mut found)
        })??;
    }
    if session.json() {
        session.print_json(&found)?;
    } else {
        write!(session.out(), "{}", told(&found))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// All experiments that were made, in words.
pub fn told(all: &Paper) -> String {
    let texts = [
        all.table_1.as_ref().map(table_one),
        all.table_2.as_ref().map(table_two),
        all.figure_2.as_ref().map(masking),
        all.figure_5.as_deref().map(|found| clusters(found, all.seed)),
        all.figure_6.as_deref().map(bump_places),
        all.figure_eight.as_deref().map(figure_eight),
        all.rectangle.as_deref().map(rectangle),
    ];
    wrapped(&texts.into_iter().flatten().collect::<Vec<_>>().join("\n\n\n"))
}

/// Cells of a published number, in a unit of which so many are one of SI.
fn cells(place: &PublishedNumber, factor: f64) -> Vec<String> {
    let [low, high] = place.middle_95;
    let scaled = |value: f64| format!("{:.*}", if factor > 500.0 { 0 } else { 2 }, value * factor);
    vec![
        scaled(place.published),
        scaled(place.mean),
        format!("{} .. {}", scaled(low), scaled(high)),
        format!("{:.1} %", 100.0 * place.share_below_published),
    ]
}

fn table_one(found: &TableOne) -> String {
    let (mut rows, mut notes) = (Vec::new(), String::new());
    for row in &found.rows {
        let mut words = vec![row.row.to_owned()];
        words.extend(cells(&row.e_max_sys_m, 1e3));
        words.extend(cells(&row.sigma_m, 1e3).into_iter().take(2));
        rows.push(words);
        notes += &format!("\n{} (--robot {})\n", row.row, row.robot);
        row.from.sources.iter().for_each(|text| notes += &format!("  from the paper: {text}\n"));
        row.from.assumed.iter().for_each(|text| notes += &format!("  assumed: {text}\n"));
    }
    let error = |e: &LinkError| format!("  {} of {} off by {:.2e}\n", e.parameter, e.effect, e.size);
    let would: String = found.clapper_would_take.iter().map(error).collect();
    let header = ["Table I [mm]", "E_max,sys", "simul.", "middle 95 %", "below it", "sigma", "simul."];
    format!(
        "{}\n\n{} simulated tests of each. \"below it\": the share of them below the published E_max,sys; simul.: their mean.\n\
         Noise with the CLAPPER's published sigma would give 13 mm at most in 95 % of tests (2.71 sigma/sqrt(5)). Its 22 mm are therefore \
         systematic. The paper does not give the cause, and the simulation has none. Each of these alone would be enough:\n{would}{notes}",
        table(&header, rows),
        found.trials
    )
}

fn table_two(found: &TableTwo) -> String {
    let rows = found.columns.iter().map(|column| {
        let exactly = column.heading_noise_rad == 0.0;
        let robot = if exactly { column.robot.to_owned() } else { format!("{} +-0.4", column.robot) };
        let mut row = vec![robot, format!("{:.2}", column.printed_rad.to_degrees())];
        row.extend(cells(&column.recomputed, 1f64.to_degrees()));
        let [least, most] = column.runs_rad.map(f64::to_degrees);
        row.push(format!("{least:.1} .. {most:.1}"));
        row
    });
    let header = ["Table II [deg]", "printed", "Eq. (5)", "simul.", "middle 95 %", "below it", "its runs"];
    let (on, off) = (found.clapper_corrected_rad, found.clapper_uncorrected_rad);
    format!(
        "{}\n\n{} simulated tests of each, ten bumps of 10 mm under the inside wheel on the first leg.\n\
         Eq. (5): half of it, the mean over all runs, from the printed headings; the printed 8.35 of the LabMate needs \
         its two systematic means exchanged. \"its runs\": the least and the largest deviation of a single run.\n\
         The LabMate is assumed to be the calibrated one, whose systematic headings are smaller; the paper does not say which.\n\
         The K2A turns by D/(2 sqrt(3) rho) a bump if three equal wheels share its slip: that rests on the assumed wheels and circle, \
         and is not fitted to the printed number.\n\
         CLAPPER: {:.1} deg with its correction off, {:.3} deg with it: {:.0} times less. \"+-0.4\": the same where each heading is \
         measured to +-0.4 deg (standard deviation 0.4/sqrt(3) deg), as reported, at second hand, for a sonar device in such tests.",
        table(&header, rows),
        found.trials,
        off.to_degrees(),
        on.to_degrees(),
        off / on
    )
}

/// Distances and headings, ccw and cw.
fn both_ways(rows: &[BothWays]) -> String {
    let rows = rows.iter().map(|row| {
        let mut words = vec![row.what.to_owned()];
        for [x, y, heading] in [row.returns.ccw, row.returns.cw] {
            words.push(format!("{:.1}", x.hypot(y) * 1e3));
            words.push(format!("{:.2}", heading.to_degrees()));
        }
        words
    });
    table(&["", "ccw [mm]", "turned [deg]", "cw [mm]", "turned [deg]"], rows)
}

/// Figs. 2 to 4.
fn masking(found: &Masking) -> String {
    format!(
        "Figures 2 to 4: errors that cancel each other in one direction\n\n{}\n\nE_d = {:.5}, E_b = {:.5}, LabMate, 4 x 4 m, \
         exact kinematics without noise",
        both_ways(&found.rows),
        found.e_d,
        found.e_b
    )
}

/// Fig. 5: one test of the uncalibrated LabMate.
fn clusters(found: &[Cluster], seed: u64) -> String {
    let mm = |v: f64| format!("{:.0}", v * 1e3);
    let mut rows = Vec::new();
    for cluster in found.iter() {
        let name = cluster.direction;
        for (number, [x, y]) in cluster.returns_m.iter().enumerate() {
            rows.push(vec![format!("{name} {}", number + 1), mm(*x), mm(*y), String::new()]);
        }
        let [x, y] = cluster.centre_m;
        rows.push(vec![format!("{name} centre of gravity"), mm(x), mm(y), mm(cluster.r_m)]);
    }
    format!(
        "Figure 5: return positions of one test, trc-labmate-nocal, seed {seed}\n\n{}",
        table(&["", "ex [mm]", "ey [mm]", "r [mm]"], rows)
    )
}

/// Fig. 6: ten bumps at the beginning of the first leg, all along it, and at its end.
fn bump_places(found: &[BumpPlace]) -> String {
    let rows = found.iter().map(|place| {
        let shift = format!("{:.0}", place.return_position_m * 1e3);
        vec![place.bumps.to_owned(), shift, format!("{:.2}", place.return_heading_rad.to_degrees())]
    });
    format!(
        "Figure 6: ten 10 mm bumps on the first leg, ccw, LabMate, exact kinematics without noise\n\n{}",
        table(&["", "return position [mm]", "return heading [deg]"], rows)
    )
}

/// What a figure-eight shows of E_d and E_b.
fn figure_eight(found: &[BothWays]) -> String {
    format!(
        "Section 3.1: the figure-eight (two circles of 2 m) hides E_d from a tape measure and E_b from a compass, \
         in both directions of driving: with positions alone it has the shortcoming named in the paper, with headings it does not\n\n{}",
        both_ways(found)
    )
}

/// The 7 x 4 m rectangle beside the square.
fn rectangle(found: &[BothWays]) -> String {
    format!(
        "Section 4.5: the rectangle instead of the square, trc-labmate-nocal, exact kinematics without noise\n\n{}",
        both_ways(found)
    )
}
