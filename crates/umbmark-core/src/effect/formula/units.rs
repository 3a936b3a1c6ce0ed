//! Whether the units of a formula agree, and which units its parameters have.
//!
//! Units are products of powers of metre and second; an angle is a plain number. Parameters, and numbers in the formula, get the unit that
//! makes the formula consistent: sums and comparisons, arguments and the result are equations for their exponents, solved one after the
//! other. So `speed + distance` is refused, and `speed + 0.1` adds 0.1 m/s.

use super::error::FormulaError;
use super::program::{Function, Op, Program};
use std::fmt;
use std::ops::Range;

/// Exponents are halves of whole numbers, or close to it where equations were solved.
const ROUNDING: f64 = 1e-9;

/// A product of powers of metre and second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Unit {
    pub metres: f64,
    pub seconds: f64,
}

impl Unit {
    pub const PLAIN: Unit = Unit { metres: 0.0, seconds: 0.0 };
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let side = |sign: f64| {
            let factor = |(name, exponent): (&str, f64)| match exponent * sign {
                e if (e - 1.0).abs() < ROUNDING => Some(name.to_owned()),
                e if e > ROUNDING => Some(format!("{name}^{}", (e * 1e6).round() / 1e6)),
                _ => None,
            };
            [("m", self.metres), ("s", self.seconds)].into_iter().filter_map(factor).collect::<Vec<_>>().join(" ")
        };
        match (side(1.0).as_str(), side(-1.0).as_str()) {
            ("", "") => Ok(()),
            (above, "") => f.write_str(above),
            ("", below) => write!(f, "1/{below}"),
            (above, below) => write!(f, "{above}/{below}"),
        }
    }
}

/// Exponents of metre and second, and how much of each unknown unit.
type Exponents = Vec<f64>;

/// Refuses a formula whose units do not agree with themselves or with the unit of its result; otherwise the units of its
/// parameters, `None` where they are not determined.
pub(super) fn check(
    text: &str,
    program: &Program,
    parameters: usize,
    result: (&'static str, Unit),
) -> Result<Vec<Option<Unit>>, FormulaError> {
    let mut units = Units { text, program, solved: Vec::new(), width: 2 + parameters + program.ops().len() };
    let all = program.interpret(|i, of, all| units.of_op(i, of, all, parameters))?;
    if let Some(unit) = all.last() {
        let wanted = units.known(result.1);
        if !units.unify(unit, &wanted) {
            return Err(FormulaError::Result {
                acts_on: result.0,
                wanted: named(&Some(result.1)),
                unit: named(&units.unit(unit)),
            });
        }
    }
    Ok((0..parameters).map(|p| units.unit(&units.unknown(p))).collect())
}

struct Units<'a> {
    text: &'a str,
    program: &'a Program,
    /// Unknown units that have been expressed by the others.
    solved: Vec<(usize, Exponents)>,
    width: usize,
}

impl Units<'_> {
    fn known(&self, unit: Unit) -> Exponents {
        let mut exponents = vec![0.0; self.width];
        (exponents[0], exponents[1]) = (unit.metres, unit.seconds);
        exponents
    }

    fn unknown(&self, number: usize) -> Exponents {
        let mut exponents = vec![0.0; self.width];
        exponents[2 + number] = 1.0;
        exponents
    }

    /// The unit, if it contains no unknown.
    fn unit(&self, exponents: &Exponents) -> Option<Unit> {
        let reduced = self.reduced(exponents.clone());
        let known = reduced[2..].iter().all(|e| e.abs() < ROUNDING);
        known.then(|| Unit { metres: reduced[0], seconds: reduced[1] })
    }

    fn reduced(&self, mut exponents: Exponents) -> Exponents {
        for (unknown, instead) in &self.solved {
            let share = std::mem::take(&mut exponents[*unknown]);
            exponents = sum(&exponents, instead, share);
        }
        exponents
    }

    /// Makes two units the same, if they can be.
    fn unify(&mut self, a: &Exponents, b: &Exponents) -> bool {
        let mut rest = self.reduced(sum(a, b, -1.0));
        let Some(pivot) = (2..self.width).find(|i| rest[*i].abs() > ROUNDING) else {
            return rest.iter().all(|e| e.abs() < ROUNDING);
        };
        let share = std::mem::take(&mut rest[pivot]);
        // Unknowns that are solved later do not occur in earlier solutions, so one pass of `reduced` is enough.
        for (_, instead) in &mut self.solved {
            let share_there = std::mem::take(&mut instead[pivot]);
            *instead = sum(instead, &rest, -share_there / share);
        }
        rest.iter_mut().for_each(|e| *e /= -share);
        self.solved.push((pivot, rest));
        true
    }

    fn of_op(
        &mut self,
        i: usize,
        of: &[usize],
        all: &[Exponents],
        parameters: usize,
    ) -> Result<Exponents, FormulaError> {
        let plain = self.known(Unit::PLAIN);
        Ok(match self.program.ops()[i] {
            Op::Number(_) => self.unknown(parameters + i),
            Op::Parameter(index) => self.unknown(index),
            Op::Variable(variable) => self.known(variable.described().dimension),
            Op::Negate | Op::Apply(Function::Abs) => all[of[0]].clone(),
            Op::Add | Op::Subtract | Op::Smaller | Op::Larger => {
                if !self.unify(&all[of[0]], &all[of[1]]) {
                    return Err(self.unlike(of, all));
                }
                all[of[0]].clone()
            }
            Op::Multiply => sum(&all[of[0]], &all[of[1]], 1.0),
            Op::Divide => sum(&all[of[0]], &all[of[1]], -1.0),
            Op::Power(n) => sum(&plain, &all[of[0]], f64::from(n)),
            Op::Apply(Function::Sqrt) => sum(&plain, &all[of[0]], 0.5),
            Op::Apply(Function::Sign) => plain,
            Op::Apply(function) => {
                if !self.unify(&all[of[0]], &plain) {
                    return Err(self.not_plain(function, of[0], &all[of[0]]));
                }
                plain
            }
        })
    }

    fn unlike(&self, of: &[usize], all: &[Exponents]) -> FormulaError {
        let [left, right] = [0, 1].map(|side| self.program.span(of[side]));
        let [left_unit, right_unit] = [0, 1].map(|side| named(&self.unit(&all[of[side]])));
        FormulaError::Units {
            column: self.column(&right),
            left: self.text[left].to_owned(),
            left_unit,
            right: self.text[right].to_owned(),
            right_unit,
        }
    }

    fn not_plain(&self, function: Function, argument: usize, unit: &Exponents) -> FormulaError {
        let span = self.program.span(argument);
        let name = Function::ALL.iter().find(|(_, other)| *other == function).map_or("", |(name, _)| name);
        FormulaError::Argument {
            column: self.column(&span),
            function: name,
            argument: self.text[span].to_owned(),
            unit: named(&self.unit(unit)),
        }
    }

    fn column(&self, span: &Range<usize>) -> usize {
        super::error::column(self.text, span.start)
    }
}

/// a + share b.
fn sum(a: &Exponents, b: &Exponents, share: f64) -> Exponents {
    a.iter().zip(b).map(|(a, b)| a + share * b).collect()
}

/// A unit in a sentence.
fn named(unit: &Option<Unit>) -> String {
    match unit.map(|unit| unit.to_string()) {
        None => "another unit".into(),
        Some(text) if text.is_empty() => "no unit".into(),
        Some(text) => text,
    }
}
