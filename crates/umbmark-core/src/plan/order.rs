//! The order of the runs, and what a drift within the session does to the estimates.

use super::expected::displaced;
use super::{PlanError, Setting, Sought, means};
use crate::diagnose::base_model;
use crate::evidence::ends::{Ends, Fitted};
use crate::geometry::wrap;
use crate::path::Direction;
use nalgebra::Vector3;

/// In which order the runs of both directions are driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// All clockwise runs first: the paper's order.
    Blocks,
    /// Clockwise and counter-clockwise in turn.
    Alternating,
    /// In turn, each pair the other way round than the one before: cw ccw, ccw cw, cw ccw, ...
    Mirrored,
}

impl Order {
    /// All of them.
    pub const ALL: [Order; 3] = [Order::Blocks, Order::Alternating, Order::Mirrored];

    /// Its name in files and flags.
    pub fn name(self) -> &'static str {
        match self {
            Order::Blocks => "blocks",
            Order::Alternating => "alternating",
            Order::Mirrored => "mirrored",
        }
    }

    /// The directions of n + n runs, one after the other.
    pub fn sequence(self, n: usize) -> Vec<Direction> {
        let [cw, ccw] = Direction::BOTH;
        match self {
            Order::Blocks => [vec![cw; n], vec![ccw; n]].concat(),
            Order::Alternating => [cw, ccw].repeat(n),
            Order::Mirrored => (0..n).flat_map(|pair| if pair % 2 == 0 { [cw, ccw] } else { [ccw, cw] }).collect(),
        }
    }
}

/// What one size that grows evenly through the session does to the estimates of E_d and E_b.
#[derive(Clone, Debug, PartialEq)]
pub struct Drift {
    /// The order of the runs.
    pub order: Order,
    /// The effect that drifts.
    pub effect: &'static str,
    /// Its size.
    pub parameter: &'static str,
    /// By how much it changes from the start of the session to its end.
    pub change: f64,
    /// For each fitted parameter: its name, the error of its estimate against the mean of the session, and the same in
    /// standard errors of the planned test.
    pub errors: Vec<(&'static str, f64, f64)>,
}

/// For each order and each drifting size, the errors of the estimates with n + n runs.
pub fn drifts(setting: &Setting, n: usize, drifting: &[Sought]) -> Result<Vec<Drift>, PlanError> {
    let mut found = Vec::new();
    for sought in drifting {
        for order in Order::ALL {
            found.push(drift(setting, n, sought, order)?);
        }
    }
    Ok(found)
}

fn drift(setting: &Setting, n: usize, sought: &Sought, order: Order) -> Result<Drift, PlanError> {
    let (effect, parameter) = (sought.effect.about.name, sought.parameter.name);
    let mut moved = setting.truth.clone();
    let before = moved.get(effect, parameter).unwrap_or(sought.parameter.default.resolve(setting.robot()));
    moved.set(effect, parameter, before + sought.departure)?;
    let shifts = [0, 1].map({
        let after = means(&setting.path, &moved)?;
        move |i: usize| {
            let (a, b) = (after[i], setting.means[i]);
            Vector3::new(a.x - b.x, a.y - b.y, wrap(a.heading.unwrap_or(0.0) - b.heading.unwrap_or(0.0)))
        }
    });
    let sequence = order.sequence(n);
    // From -1/2 to 1/2 over the session: what is estimated is its mean.
    let time = |place: usize| (place as f64 + 0.5) / sequence.len() as f64 - 0.5;
    let fit = |share: f64| -> Result<Fitted, PlanError> {
        let shift = |place: usize| shifts[sequence[place] as usize] * (share * time(place));
        let ends = Ends::new(&displaced(setting, &sequence, shift))?;
        Ok(Fitted::new(&ends, &base_model(setting.robot())?)?)
    };
    let (still, drifted) = (fit(0.0)?, fit(1.0)?);
    let errors = still.estimates.iter().zip(&drifted.estimates);
    Ok(Drift {
        order,
        effect,
        parameter,
        change: sought.departure,
        errors: errors.map(|(a, b)| (a.parameter, b.value - a.value, (b.value - a.value) / a.standard_error)).collect(),
    })
}
