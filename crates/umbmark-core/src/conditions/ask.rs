//! How a condition is asked for: beside which others, compared with what, and by which columns.

use super::between::between;
use super::clusters::{Cluster, Combined, Regression};
use super::of_runs::OfRun;
use super::{Against, Asked, AskedCondition, AtLevel, Difference, Estimate, Number, Shared};
use crate::dataset::stated::{Condition, Kind, SESSION};
use crate::diagnose::Options;
use nalgebra::{DMatrix, DVector};

/// A column of which less than this share is left beside others is theirs.
const SAME: f64 = 1e-9;
/// An amount is compared with sessions if it had as many values in them.
const FEWEST_AMOUNTS: usize = 3;
/// A condition is compared with sessions where each of its levels was met in so many.
const FEWEST_SESSIONS: usize = 2;
/// All that is known before anything is asked.
pub(super) struct All<'a> {
    pub conditions: &'a [Condition],
    pub numbers: &'a [(Number, String)],
    pub said: &'a [OfRun],
    pub options: &'a Options,
}

/// Columns by which numbers differ between runs: a row each run.
struct Design {
    runs: Vec<usize>,
    columns: DMatrix<f64>,
}

impl Design {
    /// The mean of a column over the runs.
    fn mean(&self, column: usize) -> f64 {
        self.columns.column(column).mean()
    }
}

impl All<'_> {
    fn session(&self) -> Option<usize> {
        self.conditions.iter().position(|condition| condition.names.iter().any(|name| name == SESSION))
    }

    /// Asks all numbers whether they depend on one condition.
    pub fn ask(&self, place: usize) -> (AskedCondition, Vec<Asked>) {
        let condition = &self.conditions[place];
        let runs: Vec<usize> = (0..self.said.len()).filter(|run| condition.of_runs[*run].is_some()).collect();
        let (beside, mut like) = self.beside(place, &runs);
        let against = self.against(place, &mut like);
        let design = self.design(place, &beside, runs);
        let counts = match &condition.kind {
            Kind::Amount(_) => vec![design.runs.len()],
            Kind::Levels(levels) => (0..levels.len())
                .map(|level| condition.of_runs.iter().filter(|own| **own == Some(level as f64)).count())
                .collect(),
        };
        let names = |places: &[usize]| places.iter().map(|other| self.conditions[*other].names[0].clone()).collect();
        let (beside, like) = (names(&beside), names(&like));
        let of = AskedCondition { condition: condition.clone(), runs: counts, beside, like, against };
        let regression = Regression::new(&self.clusters(&design, against));
        let answer = |number: usize| self.answer(regression.as_ref()?, &design, place, number);
        let answers = (0..self.numbers.len()).filter_map(answer).collect();
        (of, answers)
    }

    /// Conditions whose effect is fitted along, and those that cannot be told from this one.
    fn beside(&self, place: usize, runs: &[usize]) -> (Vec<usize>, Vec<usize>) {
        let condition = &self.conditions[place];
        let others: Vec<usize> = (0..self.conditions.len())
            .filter(|other| *other != place)
            .filter(|other| {
                let other = &self.conditions[*other];
                runs.iter().all(|run| other.of_runs[*run].is_some()) && !condition.is_determined_by(other)
            })
            .collect();
        let is_free = |others: &[usize]| {
            let rank = |own: bool| {
                let mut columns = vec![DVector::from_element(runs.len(), 1.0)];
                let all = others.iter().chain(own.then_some(&place));
                for other in all {
                    let of = |column| {
                        DVector::from_iterator(runs.len(), runs.iter().map(|run| self.column(*other, *run, column)))
                    };
                    columns.extend((0..self.conditions[*other].width()).map(of));
                }
                rank(&columns)
            };
            rank(true) == rank(false) + condition.width()
        };
        if is_free(&others) {
            return (others, Vec::new());
        }
        let without = |left_out: &usize| {
            let rest: Vec<usize> = others.iter().copied().filter(|other| other != left_out).collect();
            is_free(&rest)
        };
        let like: Vec<usize> = others.iter().copied().filter(without).collect();
        match like.first() {
            Some(first) => (others.iter().copied().filter(|other| other != first).collect(), like),
            None => (Vec::new(), others),
        }
    }

    fn column(&self, condition: usize, run: usize, column: usize) -> f64 {
        self.conditions[condition].column(run, column)
    }

    /// Sessions, where they tell the values of a condition and there are several of each.
    fn against(&self, place: usize, like: &mut Vec<usize>) -> Against {
        let condition = &self.conditions[place];
        let Some(session) = self.session().filter(|session| *session != place) else { return Against::Runs };
        let sessions = &self.conditions[session];
        if !condition.is_determined_by(sessions) {
            return Against::Runs;
        }
        let counts = condition.values_of(sessions);
        let is_repeated = match condition.kind {
            Kind::Levels(_) => counts.values().all(|count| *count >= FEWEST_SESSIONS),
            Kind::Amount(_) => counts.len() >= FEWEST_AMOUNTS,
        };
        if is_repeated {
            return Against::Sessions;
        }
        like.push(session);
        Against::Runs
    }

    /// A column for each level, or one of ones and one of the amount; then those of other conditions.
    fn design(&self, place: usize, beside: &[usize], runs: Vec<usize>) -> Design {
        let condition = &self.conditions[place];
        let mean = runs.iter().filter_map(|run| condition.of_runs[*run]).sum::<f64>() / runs.len().max(1) as f64;
        let own = |run: usize| -> Vec<f64> {
            let value = condition.of_runs[run].unwrap_or(f64::NAN);
            match &condition.kind {
                Kind::Levels(levels) => {
                    (0..levels.len()).map(|level| f64::from(u8::from(value == level as f64))).collect()
                }
                Kind::Amount(_) => vec![1.0, value - mean],
            }
        };
        let row = |run: &usize| {
            let others = beside
                .iter()
                .flat_map(|other| (0..self.conditions[*other].width()).map(|column| self.column(*other, *run, column)));
            own(*run).into_iter().chain(others).collect::<Vec<f64>>()
        };
        let rows: Vec<Vec<f64>> = runs.iter().map(row).collect();
        let width = rows.first().map_or(0, Vec::len);
        Design { columns: DMatrix::from_fn(runs.len(), width, |row, column| rows[row][column]), runs }
    }

    /// The rows of runs, or of sessions: a column for each number and each column of the design.
    fn clusters(&self, design: &Design, against: Against) -> Vec<Cluster> {
        let width = design.columns.ncols();
        let of_run = |(row, run): (usize, &usize)| {
            let OfRun { rows, right } = &self.said[*run];
            let spread = DMatrix::from_fn(rows.nrows(), rows.ncols() * width, |at, column| {
                rows[(at, column / width)] * design.columns[(row, column % width)]
            });
            Cluster { rows: spread, right: right.clone() }
        };
        let of_runs: Vec<Cluster> = design.runs.iter().enumerate().map(of_run).collect();
        let sessions = self.session().filter(|_| against == Against::Sessions).map(|place| &self.conditions[place]);
        let Some(sessions) = sessions else {
            return of_runs.into_iter().filter(|cluster| cluster.rows.nrows() > 0).collect();
        };
        let mut together: Vec<(Option<u64>, Vec<Cluster>)> = Vec::new();
        for (run, cluster) in design.runs.iter().zip(of_runs) {
            let session = sessions.of_runs[*run].map(f64::to_bits);
            match together.iter_mut().find(|(known, _)| *known == session) {
                Some((_, clusters)) => clusters.push(cluster),
                None => together.push((session, vec![cluster])),
            }
        }
        together.into_iter().map(|(_, clusters)| stacked(&clusters)).collect()
    }

    fn answer(&self, regression: &Regression, design: &Design, place: usize, number: usize) -> Option<Asked> {
        let condition = &self.conditions[place];
        let width = design.columns.ncols();
        let at = |column: usize| number * width + column;
        let level = 1.0 - self.options.size;
        let (named, meaning) = self.numbers[number].clone();
        let answer = |tested: &Combined, p: f64| Asked {
            number: named,
            meaning: meaning.clone(),
            condition: place,
            p,
            p_adjusted: p,
            levels: Vec::new(),
            between: None,
            largest: None,
            slope: None,
            seen: f64::NAN,
            errors: Vec::new(),
            freedom: tested.freedom,
        };
        let Kind::Levels(levels) = &condition.kind else {
            let slope = regression.combined(&[vec![(at(1), 1.0)]])?;
            let (p, estimate) = (slope.p()?, Estimate::of(&slope, level));
            return Some(Asked { slope: Some(estimate), errors: vec![estimate.standard_error], ..answer(&slope, p) });
        };
        // Others at their mean.
        let others: Vec<(usize, f64)> = (levels.len()..width)
            .filter(|column| regression.has(at(*column)))
            .map(|column| (at(column), design.mean(column)))
            .collect();
        let of_level = |k: usize| {
            let found = regression.combined(&[[&[(at(k), 1.0)], &others[..]].concat()])?;
            Some((k, Estimate::of(&found, level)))
        };
        let shown: Vec<(usize, Estimate)> = (0..levels.len()).filter_map(of_level).collect();
        let (first, rest) = shown.split_first()?;
        let contrasts: Vec<Vec<(usize, f64)>> =
            rest.iter().map(|(k, _)| vec![(at(*k), 1.0), (at(first.0), -1.0)]).collect();
        if contrasts.is_empty() {
            return None;
        }
        let tested = regression.combined(&contrasts)?;
        let p = tested.p()?;
        let difference = |(high, _): &(usize, Estimate), (low, _): &(usize, Estimate)| {
            let found = regression.combined(&[vec![(at(*high), 1.0), (at(*low), -1.0)]])?;
            let (high, low) = (levels[*high].clone(), levels[*low].clone());
            Some(Difference { high, low, by: Estimate::of(&found, level) })
        };
        let pairs = shown.iter().enumerate().flat_map(|(k, a)| shown[k + 1..].iter().map(move |b| (a, b)));
        let in_order = |(a, b): (&(usize, Estimate), &(usize, Estimate))| {
            if a.1.value >= b.1.value { difference(a, b) } else { difference(b, a) }
        };
        let pairs: Vec<Difference> = pairs.filter_map(in_order).collect();
        let errors = pairs.iter().map(|pair| pair.by.standard_error).collect();
        let largest = pairs.into_iter().max_by(|a, b| a.by.value.total_cmp(&b.by.value));
        let values: Vec<f64> = shown.iter().map(|(_, own)| own.value).collect();
        let deviations: Vec<f64> = shown.iter().map(|(_, own)| own.standard_error).collect();
        let between = between(&values, &deviations, level);
        let pooled = between.as_ref().map_or(values, |between| between.pooled.clone());
        let at_level =
            |((k, own), pooled): (&(usize, Estimate), f64)| AtLevel { level: levels[*k].clone(), own: *own, pooled };
        let at_levels = shown.iter().zip(pooled).map(at_level).collect();
        Some(Asked { levels: at_levels, between, largest, errors, ..answer(&tested, p) })
    }

    /// The values of all numbers, with those that depend on conditions at the mean of these.
    pub fn numbers_of(&self, asked: &[Asked]) -> Option<Vec<Shared>> {
        let level = 1.0 - self.options.size;
        let shown: Vec<&Asked> = asked.iter().filter(|asked| asked.is_shown(self.options.size)).collect();
        let is_known = |run: &usize| shown.iter().all(|asked| self.conditions[asked.condition].of_runs[*run].is_some());
        let runs: Vec<usize> = (0..self.said.len()).filter(is_known).collect();
        let mean = |condition: usize, column: usize| {
            runs.iter().map(|run| self.column(condition, *run, column)).sum::<f64>() / runs.len().max(1) as f64
        };
        let mut columns: Vec<Column> = (0..self.numbers.len()).map(|number| Column { number, of: None }).collect();
        for (own, (number, _)) in self.numbers.iter().enumerate() {
            for asked in shown.iter().filter(|asked| asked.number == *number) {
                let place = asked.condition;
                let of = |column| Column { number: own, of: Some((place, column, mean(place, column))) };
                columns.extend((0..self.conditions[place].width()).map(of));
            }
        }
        let cluster = |run: &usize| {
            let OfRun { rows, right } = &self.said[*run];
            let factor = |Column { of, .. }: &Column| {
                of.map_or(1.0, |(place, column, mean)| self.column(place, *run, column) - mean)
            };
            let rows = DMatrix::from_fn(rows.nrows(), columns.len(), |row, k| {
                rows[(row, columns[k].number)] * factor(&columns[k])
            });
            Cluster { rows, right: right.clone() }
        };
        let clusters: Vec<Cluster> = runs.iter().map(cluster).filter(|cluster| cluster.rows.nrows() > 0).collect();
        let regression = Regression::new(&clusters)?;
        let of = |(place, (number, meaning)): (usize, &(Number, String))| {
            let value = Estimate::of(&regression.combined(&[vec![(place, 1.0)]])?, level);
            let depends_on =
                shown.iter().filter(|asked| asked.number == *number).map(|asked| asked.condition).collect();
            Some(Shared { number: *number, meaning: meaning.clone(), value, depends_on })
        };
        let numbers: Vec<Shared> = self.numbers.iter().enumerate().filter_map(of).collect();
        (!numbers.is_empty()).then_some(numbers)
    }
}

/// A column of the fit of all numbers: one number, by itself or times a column of a condition less its mean.
struct Column {
    number: usize,
    of: Option<(usize, usize, f64)>,
}

fn stacked(clusters: &[Cluster]) -> Cluster {
    let height = clusters.iter().map(|cluster| cluster.rows.nrows()).sum();
    let width = clusters.first().map_or(0, |cluster| cluster.rows.ncols());
    let (mut rows, mut right, mut from) = (DMatrix::zeros(height, width), DVector::zeros(height), 0);
    for cluster in clusters {
        let own = cluster.rows.nrows();
        rows.rows_mut(from, own).copy_from(&cluster.rows);
        right.rows_mut(from, own).copy_from(&cluster.right);
        from += own;
    }
    Cluster { rows, right }
}

/// How many of some columns are independent.
fn rank(columns: &[DVector<f64>]) -> usize {
    let mut kept: Vec<DVector<f64>> = Vec::new();
    for column in columns {
        let whole = column.norm();
        let mut left = column.clone();
        // Twice is enough.
        for _ in 0..2 {
            for own in &kept {
                let along = own.dot(&left);
                left -= own * along;
            }
        }
        if whole > 0.0 && left.norm_squared() > SAME * whole * whole {
            kept.push(left.normalize());
        }
    }
    kept.len()
}
