//! Text to operations: a Pratt parser.
//!
//! ```text
//! sum      + -      from the left
//! product  * /      from the left
//! minus    -x       so that -x^2 = -(x^2)
//! power    x^n      n a whole number
//! ```

use super::error::{FormulaError, column};
use super::program::{Function, Op, Program};
use super::tokens::{Placed, Token, tokens};
use super::variable::VARIABLES;
use crate::parameter::nearest;
use std::ops::Range;

const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const MINUS: u8 = 3;
const POWER: u8 = 4;
/// Maximum nesting of parentheses, minus signs and functions.
const NESTED: usize = 16;
/// The largest exponent.
const MAX_EXPONENT: f64 = 16.0;

/// Names of functions of two numbers.
const OF_TWO: [(&str, Op); 2] = [("min", Op::Smaller), ("max", Op::Larger)];
/// Names of numbers.
const NUMBERS: [(&str, f64); 1] = [("pi", std::f64::consts::PI)];

/// Compiles a text whose parameters have these names.
pub(super) fn parse(text: &str, parameters: &[&str]) -> Result<Program, FormulaError> {
    let tokens = tokens(text)?;
    let mut parser = Parser { text, tokens, next: 0, parameters, program: Program::default(), nested: 0 };
    parser.expression(SUM)?;
    match parser.peek() {
        Token::End => Ok(parser.program),
        _ => Err(parser.expected("an operator or the end")),
    }
}

/// Whether a name has a meaning in every formula.
pub(super) fn is_taken(name: &str) -> bool {
    builtin_names().any(|taken| taken == name)
}

fn builtin_names() -> impl Iterator<Item = &'static str> {
    let variables = VARIABLES.iter().map(|variable| variable.name);
    let functions = Function::ALL.iter().map(|(name, _)| *name).chain(OF_TWO.iter().map(|(name, _)| *name));
    variables.chain(functions).chain(NUMBERS.iter().map(|(name, _)| *name))
}

struct Parser<'a> {
    text: &'a str,
    tokens: Vec<Placed<'a>>,
    next: usize,
    parameters: &'a [&'a str],
    program: Program,
    nested: usize,
}

impl<'a> Parser<'a> {
    fn peek(&self) -> Token<'a> {
        self.tokens.get(self.next).map_or(Token::End, |(token, _)| *token)
    }

    /// The place of the next word.
    fn here(&self) -> Range<usize> {
        self.tokens.get(self.next).map_or(self.text.len()..self.text.len(), |(_, span)| span.clone())
    }

    fn take(&mut self) -> Placed<'a> {
        let word = (self.peek(), self.here());
        self.next += 1;
        word
    }

    fn take_sign(&mut self, sign: char) -> bool {
        let there = self.peek() == Token::Sign(sign);
        self.next += usize::from(there);
        there
    }

    fn expected(&self, expected: &'static str) -> FormulaError {
        let here = self.here();
        let found = if here.is_empty() { "the end".into() } else { format!("\"{}\"", &self.text[here.clone()]) };
        FormulaError::Expected { column: column(self.text, here.start), expected, found }
    }

    fn push(&mut self, op: Op, span: Range<usize>) -> Result<Range<usize>, FormulaError> {
        if self.program.push(op, span.clone()) {
            return Ok(span);
        }
        Err(FormulaError::TooLong { column: column(self.text, span.start) })
    }

    /// An expression of operators with at least this precedence; returns its place in the text.
    fn expression(&mut self, least: u8) -> Result<Range<usize>, FormulaError> {
        self.nested += 1;
        if self.nested > NESTED {
            return Err(FormulaError::TooLong { column: column(self.text, self.here().start) });
        }
        let mut left = self.operand()?;
        loop {
            let (op, strength) = match self.peek() {
                Token::Sign('+') => (Op::Add, SUM),
                Token::Sign('-') => (Op::Subtract, SUM),
                Token::Sign('*') => (Op::Multiply, PRODUCT),
                Token::Sign('/') => (Op::Divide, PRODUCT),
                Token::Sign('^') => (Op::Power(0), POWER),
                _ => break,
            };
            if strength < least {
                break;
            }
            self.take();
            left = if strength == POWER {
                let (exponent, end) = self.exponent()?;
                self.push(Op::Power(exponent), left.start..end)?
            } else {
                let right = self.expression(strength + 1)?;
                self.push(op, left.start..right.end)?
            };
        }
        self.nested -= 1;
        Ok(left)
    }

    fn operand(&mut self) -> Result<Range<usize>, FormulaError> {
        match self.peek() {
            Token::Number(value) => {
                let (_, span) = self.take();
                self.push(Op::Number(value), span)
            }
            Token::Name(name) => self.name(name),
            Token::Sign('-') => {
                let (_, minus) = self.take();
                let argument = self.expression(MINUS)?;
                self.push(Op::Negate, minus.start..argument.end)
            }
            Token::Sign('(') => {
                let (_, opened) = self.take();
                self.expression(SUM)?;
                Ok(opened.start..self.close()?)
            }
            _ => Err(self.expected("a number, a name or \"(\"")),
        }
    }

    fn close(&mut self) -> Result<usize, FormulaError> {
        let end = self.here().end;
        if self.take_sign(')') { Ok(end) } else { Err(self.expected("an operator or \")\"")) }
    }

    fn name(&mut self, name: &'a str) -> Result<Range<usize>, FormulaError> {
        let (_, span) = self.take();
        let function = Function::ALL.iter().find(|(known, _)| *known == name).map(|(_, f)| (Op::Apply(*f), 1));
        let function = function.or_else(|| OF_TWO.iter().find(|(known, _)| *known == name).map(|(_, op)| (*op, 2)));
        if let Some((op, takes)) = function {
            return self.call(op, takes, span);
        }
        let variable = || VARIABLES.iter().find(|known| known.name == name).map(|known| Op::Variable(known.variable));
        let number = || NUMBERS.iter().find(|(known, _)| *known == name).map(|(_, value)| Op::Number(*value));
        let parameter = self.parameters.iter().position(|known| *known == name).map(Op::Parameter);
        let column = column(self.text, span.start);
        match parameter.or_else(variable).or_else(number) {
            Some(_) if self.peek() == Token::Sign('(') => {
                Err(self.wrong_call(&span, "is not a function; write * to multiply".into()))
            }
            Some(op) => self.push(op, span),
            None => {
                let known = self.parameters.iter().copied().chain(builtin_names().map(|known| -> &str { known }));
                // Names of one or two letters are always similar to another one.
                let nearest = nearest(name, known).filter(|_| name.len() > 2).map(str::to_owned);
                Err(FormulaError::Name { column, name: name.to_owned(), nearest })
            }
        }
    }

    fn call(&mut self, op: Op, takes: usize, span: Range<usize>) -> Result<Range<usize>, FormulaError> {
        let needs = format!("takes {takes} {}", if takes == 1 { "argument" } else { "arguments" });
        if !self.take_sign('(') {
            return Err(self.wrong_call(&span, format!("is a function: it {needs} in parentheses")));
        }
        let mut given = 0;
        if self.peek() != Token::Sign(')') {
            self.expression(SUM)?;
            given = 1;
            while self.take_sign(',') {
                self.expression(SUM)?;
                given += 1;
            }
        }
        let end = self.close()?;
        if given != takes {
            return Err(self.wrong_call(&span, format!("{needs}, got {given}")));
        }
        self.push(op, span.start..end)
    }

    fn wrong_call(&self, name: &Range<usize>, problem: String) -> FormulaError {
        let (column, name) = (column(self.text, name.start), self.text[name.clone()].to_owned());
        FormulaError::Call { column, name, problem }
    }

    /// The whole number after ^, in parentheses or not, and where it ends.
    fn exponent(&mut self) -> Result<(i32, usize), FormulaError> {
        const EXPECTED: &str = "a whole number from -16 to 16 after \"^\" (sqrt takes roots)";
        let opened = self.take_sign('(');
        let sign = if self.take_sign('-') { -1.0 } else { 1.0 };
        let (Token::Number(size), mut end) = (self.peek(), self.here().end) else {
            return Err(self.expected(EXPECTED));
        };
        if size.fract() != 0.0 || size > MAX_EXPONENT {
            return Err(self.expected(EXPECTED));
        }
        self.take();
        if opened {
            end = self.close()?;
        }
        if self.peek() == Token::Sign('^') {
            return Err(self.expected("parentheses round the power that is raised again"));
        }
        Ok(((sign * size) as i32, end))
    }
}
