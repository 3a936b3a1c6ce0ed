//! How many robots are good enough, and the cheapest tolerances that make enough of them so.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::atomic;

use statrs::distribution::{Beta, Binomial, ContinuousCDF, DiscreteCDF};

use super::{Correlation, Estimate, Evaluator, Inputs, Response, SensitivityError, Tests, Watch, evaluate};
use crate::monte_carlo::{Distribution, Quantity};
use crate::random::Stream;
use crate::stats::Interval;

/// Purpose of the streams that robots are drawn from.
const ROBOTS: u64 = 22;

/// Robots that one thread draws at a time.
const CHUNK: u64 = 256;

/// A parameter and the grades of tolerance that it can be had in.
#[derive(Clone, Debug)]
pub struct Varied {
    /// The parameter.
    pub quantity: Quantity,
    /// Its grades; the first is what it is now.
    pub grades: Vec<Grade>,
}

/// A grade of tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grade {
    /// How the parameter is distributed over robots of this grade.
    pub distribution: Distribution,
    /// What the grade costs, in any unit.
    pub cost: f64,
}

/// The goal: a share of robots with an output of at most some size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Which output, from 0.
    pub output: usize,
    /// The most that its size may be.
    pub at_most: f64,
    /// The share of robots that must keep it, in (0, 1).
    pub share: f64,
}

/// The robots that some tolerances make.
#[derive(Clone, Debug, PartialEq)]
pub struct Population {
    /// Sizes of the output, in order.
    sizes: Vec<f64>,
}

impl Population {
    /// Sizes of the output of all robots, in order.
    pub fn sizes(&self) -> &[f64] {
        &self.sizes
    }

    /// The size that a share `q` of all robots keeps, with the distribution-free interval of order statistics.
    pub fn quantile(&self, q: f64) -> Estimate {
        let n = self.sizes.len();
        let place = |rank: u64| self.sizes[(rank as usize).min(n - 1)];
        // The number of robots below the true quantile is binomial.
        let ranks = Binomial::new(q, n as u64).map(|below| [0.025, 0.975].map(|p| below.inverse_cdf(p)));
        let [low, high] = ranks.map_or([f64::NAN; 2], |[low, high]| [place(low.saturating_sub(1)), place(high)]);
        Estimate { value: place((q * (n - 1) as f64).round() as u64), interval: Interval { low, high } }
    }

    /// The share of robots that keep a size, with the interval of Clopper & Pearson.
    pub fn share_within(&self, size: f64) -> Estimate {
        let (n, kept) = (self.sizes.len() as f64, self.sizes.partition_point(|s| *s <= size) as f64);
        let beta = |a: f64, b: f64, p: f64| Beta::new(a, b).map_or(f64::NAN, |beta| beta.inverse_cdf(p));
        let low = if kept == 0.0 { 0.0 } else { beta(kept, n - kept + 1.0, 0.025) };
        let high = if kept == n { 1.0 } else { beta(kept + 1.0, n - kept, 0.975) };
        Estimate { value: kept / n, interval: Interval { low, high } }
    }
}

/// A choice of grades, one a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// The place of each parameter's grade in its list.
    pub grades: Vec<usize>,
    /// The sum of their costs.
    pub cost: f64,
    /// The robots that it makes.
    pub robots: Population,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Findings {
    /// The first grade of every parameter.
    pub now: Choice,
    /// One parameter at another grade than now, for each that there is.
    pub alone: Vec<Choice>,
    /// The last grade of every parameter.
    pub last: Choice,
    /// The cheapest choice that keeps the target, judged by robots that the search did not see.
    pub cheapest: Option<Choice>,
    /// Choices that were looked at in the search.
    pub looked_at: u64,
    /// Whether the search stopped before all choices that could be cheapest were looked at.
    pub partial: bool,
}

/// Parameters with their grades, on tests of robots.
#[derive(Clone, Debug)]
pub struct Tolerances<'a> {
    /// What a robot of given values does.
    pub tests: &'a Tests,
    /// The parameters and their grades.
    pub parameters: &'a [Varied],
    /// How they go together.
    pub correlations: &'a [Correlation],
    /// Robots drawn to judge a choice.
    pub robots: u64,
    /// Seed of all draws.
    pub seed: u64,
}

/// The most choices that a search looks at.
pub const MOST_CHOICES: u64 = 1_000_000;

impl Tolerances<'_> {
    /// The robots that a choice of grades makes: those numbered from `first` on. Robot i of every choice has the same random
    /// numbers, so that choices differ by their grades alone.
    fn population(
        &self,
        grades: &[usize],
        output: usize,
        first: u64,
        count: u64,
        watch: &Watch,
    ) -> Result<Population, SensitivityError> {
        let chosen = self.parameters.iter().zip(grades);
        let varied: Vec<_> = chosen.map(|(one, grade)| (one.quantity, one.grades[*grade].distribution)).collect();
        let inputs = Inputs::new(Tests::inputs(&varied), self.correlations)?;
        let robots = |evaluator: &mut Evaluator, chunk: usize| {
            let numbers = first + chunk as u64 * CHUNK..first + ((chunk as u64 + 1) * CHUNK).min(count);
            let (mut row, mut values) = (vec![0.0; inputs.count()], vec![0.0; inputs.count()]);
            let mut outputs = vec![0.0; self.tests.outputs()];
            let mut sizes = Vec::with_capacity(CHUNK as usize);
            for number in numbers {
                let mut stream = Stream::new(self.seed, ROBOTS, number);
                // Half a step away from 0, which no quantile function likes.
                row.iter_mut().for_each(|u| *u = stream.uniform() + 0.25 * f64::EPSILON);
                inputs.coordinates(&mut row);
                inputs.values(&row, &mut values);
                evaluate(evaluator, &values, number, &mut outputs)?;
                sizes.push(outputs[output].abs());
            }
            Ok(sizes)
        };
        let quiet = Watch::new(watch.stop, &|_| ());
        let pieces = quiet.pieces(self.tests, count.div_ceil(CHUNK) as usize, robots)?;
        let pieces: Option<Vec<Vec<f64>>> = pieces.into_iter().collect();
        let mut sizes = pieces.ok_or(SensitivityError::Stopped)?.concat();
        sizes.sort_by(f64::total_cmp);
        Ok(Population { sizes })
    }

    fn choice(&self, grades: &[usize], output: usize, watch: &Watch) -> Result<Choice, SensitivityError> {
        let robots = self.population(grades, output, 0, self.robots, watch)?;
        Ok(Choice { grades: grades.to_vec(), cost: self.cost(grades), robots })
    }

    fn cost(&self, grades: &[usize]) -> f64 {
        self.parameters.iter().zip(grades).map(|(one, grade)| one.grades[*grade].cost).sum()
    }

    /// How good the robots are now and with every last grade, what each other grade would do by itself, and the cheapest choice of grades that keeps the
    /// target.
    ///
    /// Choices are looked at in the order of their cost. One is dropped as soon as the share of its robots that keep the limit
    /// is surely too small (by more than Clopper & Pearson's interval, asked of more and more robots). The first that seems to
    /// keep the target is drawn anew, and taken where the lower end of the new interval keeps it too: what was picked for its
    /// luck is not believed.
    pub fn search(&self, target: &Target, watch: &Watch) -> Result<Findings, SensitivityError> {
        if !(100..=100_000_000).contains(&self.robots) {
            let allowed = "from 100 to 100000000";
            return Err(SensitivityError::Count { what: "robots", allowed, value: self.robots });
        }
        let first = vec![0; self.parameters.len()];
        let now = self.choice(&first, target.output, watch)?;
        let mut alone = Vec::new();
        let others = self.parameters.iter().enumerate().flat_map(|(i, one)| (1..one.grades.len()).map(move |g| (i, g)));
        for (parameter, grade) in others {
            let mut grades = first.clone();
            grades[parameter] = grade;
            alone.push(self.choice(&grades, target.output, watch)?);
        }
        let last: Vec<usize> = self.parameters.iter().map(|one| one.grades.len() - 1).collect();
        let last = self.choice(&last, target.output, watch)?;
        let (mut looked_at, mut partial) = (0, false);
        let mut cheapest = None;
        for grades in ByCost::new(self.parameters) {
            if looked_at == MOST_CHOICES || watch.stop.load(atomic::Ordering::Relaxed) {
                partial = true;
                break;
            }
            looked_at += 1;
            (watch.progress)(looked_at as f64 / self.choices());
            match self.judged(&grades, target, watch) {
                Ok(found @ Some(_)) => {
                    cheapest = found;
                    break;
                }
                Err(SensitivityError::Stopped) => partial = true,
                other => drop(other?),
            }
        }
        Ok(Findings { now, alone, last, cheapest, looked_at, partial })
    }

    fn choices(&self) -> f64 {
        self.parameters.iter().map(|one| one.grades.len() as f64).product()
    }

    /// The choice, if it keeps the target.
    fn judged(&self, grades: &[usize], target: &Target, watch: &Watch) -> Result<Option<Choice>, SensitivityError> {
        let mut count = (self.robots / 16).max(100).min(self.robots);
        loop {
            let share = self.population(grades, target.output, 0, count, watch)?.share_within(target.at_most);
            if share.interval.high < target.share || (count == self.robots && share.value < target.share) {
                return Ok(None);
            }
            if count == self.robots {
                break;
            }
            count = (4 * count).min(self.robots);
        }
        let robots = self.population(grades, target.output, self.robots, self.robots, watch)?;
        let keeps = robots.share_within(target.at_most).interval.low >= target.share;
        Ok(keeps.then(|| Choice { grades: grades.to_vec(), cost: self.cost(grades), robots }))
    }
}

/// All choices of grades, cheapest first.
struct ByCost {
    /// For each parameter, its grades as (cost, place), cheapest first.
    ladders: Vec<Vec<(f64, usize)>>,
    open: BinaryHeap<Open>,
}

/// A choice whose dearer neighbours are not listed yet.
#[derive(PartialEq)]
struct Open {
    cost: f64,
    /// The rung of each ladder, and the parameter from which on neighbours may differ: each choice is then met once.
    rungs: Vec<usize>,
    from: usize,
}

impl Eq for Open {}

impl Ord for Open {
    /// The cheapest is the greatest; of equals, the first by its rungs.
    fn cmp(&self, other: &Open) -> Ordering {
        other.cost.total_cmp(&self.cost).then_with(|| other.rungs.cmp(&self.rungs))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Open) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl ByCost {
    fn new(parameters: &[Varied]) -> ByCost {
        let ladder = |one: &Varied| {
            let mut ladder: Vec<(f64, usize)> = one.grades.iter().enumerate().map(|(i, g)| (g.cost, i)).collect();
            ladder.sort_by(|a, b| a.0.total_cmp(&b.0));
            ladder
        };
        let ladders: Vec<_> = parameters.iter().map(ladder).collect();
        let mut all = ByCost { ladders, open: BinaryHeap::new() };
        all.push(vec![0; parameters.len()], 0);
        all
    }

    fn push(&mut self, rungs: Vec<usize>, from: usize) {
        let cost = self.ladders.iter().zip(&rungs).map(|(ladder, rung)| ladder[*rung].0).sum();
        self.open.push(Open { cost, rungs, from });
    }
}

impl Iterator for ByCost {
    type Item = Vec<usize>;

    fn next(&mut self) -> Option<Vec<usize>> {
        let Open { rungs, from, .. } = self.open.pop()?;
        for parameter in from..rungs.len() {
            if rungs[parameter] + 1 < self.ladders[parameter].len() {
                let mut dearer = rungs.clone();
                dearer[parameter] += 1;
                self.push(dearer, parameter);
            }
        }
        Some(self.ladders.iter().zip(&rungs).map(|(ladder, rung)| ladder[*rung].1).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;
    use crate::effect::Model;
    use crate::monte_carlo::Study;
    use crate::sensitivity::Noise;
    use crate::stats::normal_quantile;

    fn study() -> Study {
        Study::new(Model::new(&Robot::labmate()), 1, 1)
    }

    fn parameter(name: &str, grades: &[(f64, f64)]) -> Varied {
        let grade =
            |(sd, cost): &(f64, f64)| Grade { distribution: Distribution::Normal { mean: 1.0, sd: *sd }, cost: *cost };
        Varied { quantity: Quantity::find(name, &study()).unwrap(), grades: grades.iter().map(grade).collect() }
    }

    fn tests(parameters: &[Varied]) -> Tests {
        let varied: Vec<_> = parameters.iter().map(|one| (one.quantity, one.grades[0].distribution)).collect();
        Tests::new(&study(), &varied, Noise::Absent).unwrap()
    }

    fn search(parameters: &[Varied], target: &Target) -> Findings {
        let tests = tests(parameters);
        let tolerances = Tolerances { tests: &tests, parameters, correlations: &[], robots: 4000, seed: 1 };
        Watch::nobody(|watch| tolerances.search(target, watch)).unwrap()
    }

    /// E_max,sys by E_b alone, exactly: after each quarter turn by π/(2 E_b), four sides of 4 m end at a distance of
    /// 4 |sin 4φ / sin φ|... with φ half of that turn: 4 |sin(π/E_b) / sin(π/(4 E_b))|.
    fn e_max(e_b: f64) -> f64 {
        let half = std::f64::consts::FRAC_PI_4 / e_b;
        4.0 * (libm::sin(4.0 * half) / libm::sin(half)).abs()
    }

    /// E_max,sys grows with |E_b - 1|, so its quantiles are those of |E_b - 1| carried over. Of 40 seeds, 95 % intervals should
    /// hold it in 38; 34 or more are asked for (p < 0.01 for a correct interval).
    #[test]
    fn the_quantile_of_e_max_sys_is_that_of_the_wheelbase_carried_over() {
        let parameters = [parameter("eb", &[(0.004, 0.0)])];
        let tests = tests(&parameters);
        let deviation = normal_quantile(0.975) * 0.004;
        let exact = 0.5 * (e_max(1.0 + deviation) + e_max(1.0 - deviation));
        let mut held = 0;
        for seed in 0..40 {
            let all = Tolerances { tests: &tests, parameters: &parameters, correlations: &[], robots: 2000, seed };
            let robots = Watch::nobody(|watch| all.population(&[0], 0, 0, 2000, watch)).unwrap();
            let found = robots.quantile(0.95);
            assert!((found.value / exact - 1.0).abs() < 0.1, "{found:?} {exact}");
            held += usize::from(found.interval.contains(exact));
        }
        assert!((34..=40).contains(&held), "{held} of 40");
    }

    /// By E_b alone 95 % of robots keep 50 mm where its standard deviation is 0.05/(e_max slope)/1.96: 0.00143. Of two grades
    /// on both sides of it the first that keeps the target is 0.0012; E_d at 1e-7 does nothing and is not bought.
    #[test]
    fn the_cheapest_choice_is_the_first_that_the_formula_allows() {
        let slope = (e_max(1.001) - e_max(0.999) + 2.0 * e_max(0.999)) / 2e-3;
        let needed = 0.05 / slope / normal_quantile(0.975);
        assert!((needed - 0.001434).abs() < 2e-5, "{needed}");
        let parameters = [
            parameter("ed", &[(1e-7, 0.0), (1e-8, 1.0)]),
            parameter("eb", &[(0.004, 0.0), (0.0016, 5.0), (0.0012, 9.0), (0.0005, 30.0)]),
        ];
        let target = Target { output: 0, at_most: 0.05, share: 0.95 };
        let found = search(&parameters, &target);
        let cheapest = found.cheapest.unwrap();
        assert_eq!((cheapest.grades.as_slice(), cheapest.cost), (&[0, 2][..], 9.0));
        assert!(cheapest.robots.share_within(0.05).interval.low >= 0.95);
        assert!(found.now.robots.share_within(0.05).interval.high < 0.95 && found.alone.len() == 4);
        // Dearer ones were not looked at: 0, 1, 5, 6 and 9 units of cost.
        assert_eq!((found.looked_at, found.partial), (5, false));
        let beyond = Target { at_most: 1e-6, ..target };
        let none = search(&parameters, &beyond);
        assert_eq!((none.cheapest, none.looked_at, none.partial), (None, 8, false));
    }

    #[test]
    fn choices_come_in_the_order_of_their_cost_each_once() {
        let parameters = [
            parameter("ed", &[(1e-3, 3.0), (1e-4, 0.0), (1e-5, 7.0)]),
            parameter("eb", &[(1e-3, 1.0), (1e-4, 2.0)]),
            parameter("es", &[(1e-3, 0.0), (1e-4, 2.5)]),
        ];
        let all: Vec<Vec<usize>> = ByCost::new(&parameters).collect();
        assert_eq!((all.len(), all[0].as_slice()), (12, &[1, 0, 0][..]));
        let tests = tests(&parameters);
        let of = Tolerances { tests: &tests, parameters: &parameters, correlations: &[], robots: 100, seed: 1 };
        assert!(all.windows(2).all(|pair| of.cost(&pair[0]) <= of.cost(&pair[1]) && pair[0] != pair[1]));
        let mut sorted = all.clone();
        sorted.sort();
        sorted.dedup();
        assert_eq!(sorted.len(), 12);
    }
}
