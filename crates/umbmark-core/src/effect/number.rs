//! Derivatives of a model's predictions by numbers that it has or may have.

use super::{Chain, Changes, Model, ModelError, find};
use crate::geometry::{Dual, LANES, seeded};

/// A number by which predictions are differentiated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number {
    /// Its effect. If the model lacks it, it is added at its default values, without influence.
    pub effect: &'static str,
    /// The number.
    pub parameter: &'static str,
    /// Other numbers of an effect that the model lacks (a length, a threshold, a place), and their values.
    pub shapes: Shapes,
}

/// The largest number of shapes of one effect that have other values than the usual ones while its sizes are asked for.
pub const MAX_SHAPES: usize = 3;

/// Names and values of shapes.
pub type Shapes = [Option<(&'static str, f64)>; MAX_SHAPES];

/// A chain that carries derivatives by some of a list of numbers.
#[derive(Clone, Debug)]
pub struct Derived {
    /// The chain: lane k carries the derivative by the k-th of `numbers`.
    pub chain: Chain<Dual>,
    /// The same without derivatives.
    pub plain: Chain<f64>,
    /// Places in the list.
    pub numbers: Vec<usize>,
    /// Whether they change only the measurement, so that no motion must be replayed.
    pub seen_only: bool,
}

impl Number {
    /// A number of an effect whose shapes, where the model lacks it, have their usual values.
    pub fn of(effect: &'static str, parameter: &'static str) -> Number {
        Number { effect, parameter, shapes: Shapes::default() }
    }

    /// Whether it changes only the measurement.
    fn seen_only(&self) -> bool {
        find(self.effect).is_ok_and(|entry| !entry.changes.include(Changes::MOTION))
    }
}

impl Model {
    /// Chains that carry derivatives by some of the [values](Model::values), [`LANES`] at a time, and how many each carries.
    pub fn chains<'a>(&'a self, values: &'a [usize]) -> impl Iterator<Item = (Chain<Dual>, usize)> + 'a {
        values.chunks(LANES).map(|places| (self.chain_with(&seeded(self.values(), places)), places.len()))
    }

    /// Chains that carry derivatives by all of a list of numbers, [`LANES`] at a time. Effects that the model lacks share one chain: at
    /// their defaults they do not influence each other.
    pub fn derived(&self, numbers: &[Number]) -> Result<Vec<Derived>, ModelError> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (index, number) in numbers.iter().enumerate() {
            let agrees = |other: &usize| {
                let other = &numbers[*other];
                (other.effect != number.effect || other.shapes == number.shapes)
                    && other.seen_only() == number.seen_only()
            };
            match groups.iter_mut().find(|group| group.len() < LANES && group.iter().all(agrees)) {
                Some(group) => group.push(index),
                None => groups.push(vec![index]),
            }
        }
        groups.into_iter().map(|group| self.derived_together(numbers, group)).collect()
    }

    fn derived_together(&self, list: &[Number], numbers: Vec<usize>) -> Result<Derived, ModelError> {
        let mut with = self.clone();
        for Number { effect, shapes, .. } in numbers.iter().map(|index| list[*index]) {
            with.add(effect)?;
            for (parameter, value) in shapes.into_iter().flatten() {
                with.set(effect, parameter, value)?;
            }
        }
        let place = |index: &usize| {
            let Number { effect, parameter, .. } = list[*index];
            let unknown = || ModelError::UnknownParameter { effect, name: parameter.to_owned(), nearest: None };
            with.place_of(effect, parameter).ok_or_else(unknown)
        };
        let places: Vec<usize> = numbers.iter().map(place).collect::<Result<_, _>>()?;
        let seen_only = numbers.iter().all(|index| list[*index].seen_only());
        let (chain, plain) = (with.chain_with(&seeded(with.values(), &places)), with.chain());
        Ok(Derived { chain, plain, numbers, seen_only })
    }
}
