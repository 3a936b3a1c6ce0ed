//! A formula compiled into operations on a stack.

use super::variable::{Middle, Variable};
use crate::effect::Here;
use crate::geometry::{Displacement2, Real};
use crate::parameter::Role;
use std::ops::Range;

/// Maximum depth of the stack, and that of most formulas.
pub(super) const DEPTH: usize = 16;
const SHALLOW: usize = 4;
/// Maximum number of operations of a formula.
pub(super) const LONGEST: usize = 256;

/// One operation. It takes its arguments from the stack and leaves its result there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Op {
    Number(f64),
    Parameter(usize),
    Variable(Variable),
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power(i32),
    Apply(Function),
    Smaller,
    Larger,
}

impl Op {
    /// How many arguments it takes.
    pub fn arity(&self) -> usize {
        match self {
            Op::Number(_) | Op::Parameter(_) | Op::Variable(_) => 0,
            Op::Negate | Op::Power(_) | Op::Apply(_) => 1,
            Op::Add | Op::Subtract | Op::Multiply | Op::Divide | Op::Smaller | Op::Larger => 2,
        }
    }
}

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Sin,
    Cos,
    Tan,
    Exp,
    Log,
    Sqrt,
    Abs,
    Sign,
    Tanh,
}

impl Function {
    pub const ALL: [(&'static str, Function); 9] = [
        ("sin", Function::Sin),
        ("cos", Function::Cos),
        ("tan", Function::Tan),
        ("exp", Function::Exp),
        ("log", Function::Log),
        ("sqrt", Function::Sqrt),
        ("abs", Function::Abs),
        ("sign", Function::Sign),
        ("tanh", Function::Tanh),
    ];

    /// The function of a number; where it has a corner, |x| at 0, its slope there is 0.
    #[inline]
    fn of<T: Real>(self, x: T) -> T {
        let v = x.value();
        match self {
            Function::Sin => x.sine_cosine().0,
            Function::Cos => x.sine_cosine().1,
            Function::Tan => {
                let (sine, cosine) = x.sine_cosine();
                sine / cosine
            }
            Function::Exp => x.exponential(),
            Function::Log => x.mapped(libm::log(v), 1.0 / v),
            Function::Sqrt => x.mapped(v.sqrt(), 0.5 / v.sqrt()),
            Function::Abs => x.mapped(v.abs(), sign(v)),
            Function::Sign => T::from(sign(v)),
            Function::Tanh => {
                let t = libm::tanh(v);
                x.mapped(t, 1.0 - t * t)
            }
        }
    }
}

/// -1, 0 or 1; NaN for NaN.
fn sign(v: f64) -> f64 {
    if v == 0.0 { 0.0 } else { v.signum() }
}

/// x^n by repeated squaring: the same bits on every machine.
#[inline]
fn power<T: Real>(x: T, n: i32) -> T {
    let (mut square, mut left, mut product) = (x, n.unsigned_abs(), T::from(1.0));
    while left > 0 {
        if left & 1 == 1 {
            product *= square;
        }
        square *= square;
        left >>= 1;
    }
    if n < 0 { T::from(1.0) / product } else { product }
}

/// Operations in order, each with the part of the text whose value it computes.
#[derive(Clone, Debug, Default)]
pub(super) struct Program {
    ops: Vec<Op>,
    spans: Vec<Range<usize>>,
    waiting: usize,
    /// The largest number of values that wait at the same time.
    deepest: usize,
}

impl Program {
    /// Adds an operation; whether there was room for it.
    pub fn push(&mut self, op: Op, span: Range<usize>) -> bool {
        self.waiting = self.waiting + 1 - op.arity();
        self.deepest = self.deepest.max(self.waiting);
        self.ops.push(op);
        self.spans.push(span);
        self.waiting <= DEPTH && self.ops.len() <= LONGEST
    }

    pub fn ops(&self) -> &[Op] {
        &self.ops
    }

    /// The part of the text whose value operation `i` computes.
    pub fn span(&self, i: usize) -> Range<usize> {
        self.spans[i].clone()
    }

    /// The value in the middle of a piece with this motion, for values or derivatives.
    #[inline]
    pub fn evaluate<T: Real>(&self, parameters: &[T], at: &Here<T>, motion: &Displacement2<T>) -> T {
        self.watched(parameters, at, motion, |_, _| ())
    }

    /// [`Program::evaluate`], calling `watch` with each operation's number and result.
    #[inline]
    pub fn watched<T: Real>(
        &self,
        parameters: &[T],
        at: &Here<T>,
        motion: &Displacement2<T>,
        watch: impl FnMut(usize, T),
    ) -> T {
        // A stack of 16 numbers with derivatives is a kilobyte, and clearing it takes longer than most formulas.
        if self.deepest <= SHALLOW {
            self.on_stack::<SHALLOW, T>(parameters, at, motion, watch)
        } else {
            self.on_stack::<DEPTH, T>(parameters, at, motion, watch)
        }
    }

    #[inline]
    fn on_stack<const SIZE: usize, T: Real>(
        &self,
        parameters: &[T],
        at: &Here<T>,
        motion: &Displacement2<T>,
        mut watch: impl FnMut(usize, T),
    ) -> T {
        let mut middle = Middle::new(at, motion);
        // The topmost value is in `top`, those below it in `below`.
        let mut below = [T::from(0.0); SIZE];
        let (mut count, mut top) = (0, T::from(0.0));
        for (i, op) in self.ops.iter().enumerate() {
            match op.arity() {
                0 => {
                    below[count] = top;
                    count += 1;
                }
                2 => count -= 1,
                _ => {}
            }
            top = match *op {
                Op::Number(number) => T::from(number),
                Op::Parameter(index) => parameters[index],
                Op::Variable(variable) => variable.of(at, &mut middle),
                Op::Negate => -top,
                Op::Add => below[count] + top,
                Op::Subtract => below[count] - top,
                Op::Multiply => below[count] * top,
                Op::Divide => below[count] / top,
                Op::Power(n) => power(top, n),
                Op::Apply(function) => function.of(top),
                Op::Smaller => {
                    if top.value() < below[count].value() {
                        top
                    } else {
                        below[count]
                    }
                }
                Op::Larger => {
                    if top.value() > below[count].value() {
                        top
                    } else {
                        below[count]
                    }
                }
            };
            watch(i, top);
        }
        top
    }

    /// Another interpretation of the operations: `result` computes the result of each from the indices of its arguments and all earlier
    /// results.
    pub fn interpret<D, E>(&self, mut result: impl FnMut(usize, &[usize], &[D]) -> Result<D, E>) -> Result<Vec<D>, E> {
        let (mut stack, mut results): (Vec<usize>, Vec<D>) = Default::default();
        for (i, op) in self.ops.iter().enumerate() {
            let arguments = stack.split_off(stack.len() - op.arity());
            results.push(result(i, &arguments, &results)?);
            stack.push(i);
        }
        Ok(results)
    }

    /// The roles of its parameters: those in which it is linear are sizes (all of them if it is linear in none). The others are shapes,
    /// which have no influence while the sizes are 0.
    pub fn roles(&self, parameters: usize) -> Vec<Role> {
        let linear = |p: usize| if self.degree(p) == 1 { Role::Size } else { Role::Shape };
        let roles: Vec<Role> = (0..parameters).map(linear).collect();
        if roles.contains(&Role::Size) { roles } else { vec![Role::Size; parameters] }
    }

    /// Degree of the formula in a parameter: 0, 1, or 2 for all else.
    fn degree(&self, parameter: usize) -> u8 {
        let of_op = |i: usize, of: &[usize], all: &[u8]| -> Result<u8, std::convert::Infallible> {
            let degrees = || of.iter().map(|argument| all[*argument]);
            Ok(match self.ops[i] {
                Op::Parameter(index) => u8::from(index == parameter),
                Op::Number(_) | Op::Variable(_) => 0,
                Op::Negate | Op::Add | Op::Subtract | Op::Power(1) => degrees().max().unwrap_or(0),
                Op::Multiply => degrees().sum::<u8>().min(2),
                Op::Divide if all[of[1]] == 0 => all[of[0]],
                _ => 2 * degrees().max().unwrap_or(0).min(1),
            })
        };
        let Ok(degrees) = self.interpret(of_op);
        degrees.last().copied().unwrap_or(0)
    }
}
