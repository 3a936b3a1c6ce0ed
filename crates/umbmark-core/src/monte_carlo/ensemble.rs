//! What is known of a study so far.

use std::ops::Range;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Metric, Row, Shard, Statistics, Study};

/// The statistics of the trials that are done: of a whole study, of a shard, or of some shards merged.
///
/// It can be written down (serde) at any moment, taken up again by [`Study::resume`](super::Study::resume), and merged with
/// others of the same study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Written")]
pub struct Ensemble {
    study: String,
    shard: Shard,
    all: u64,
    /// Ranges of trials that are done, in order, without overlap or touch.
    done: Vec<Range<u64>>,
    metrics: Vec<(String, Statistics)>,
}

/// An ensemble as it stands in a file, before anything of it is believed.
#[derive(Deserialize)]
struct Written {
    study: String,
    shard: Shard,
    all: u64,
    done: Vec<Range<u64>>,
    metrics: Vec<(String, Statistics)>,
}

impl TryFrom<Written> for Ensemble {
    type Error = String;

    fn try_from(Written { study, shard, all, done, metrics }: Written) -> Result<Ensemble, String> {
        let shard = Shard::new(shard.index(), shard.count()).map_err(|error| error.to_string())?;
        let own = shard.trials(all);
        let mut from = own.start;
        for Range { start, end } in &done {
            if !(from <= *start && start < end && *end <= own.end) {
                return Err(format!(
                    "trials {start} to {end} are no part of trials {from} to {} of shard {shard} that are not done before",
                    own.end
                ));
            }
            from = end.saturating_add(1);
        }
        let trials: u64 = done.iter().map(|range| range.end - range.start).sum();
        for (place, (name, statistics)) in metrics.iter().enumerate() {
            if Metric::named(name).is_err() || metrics[..place].iter().any(|(before, _)| before == name) {
                return Err(format!("\"{name}\" is no metric, or is there twice"));
            }
            if statistics.count() != trials {
                return Err(format!("{trials} trials are done, {} have {name}", statistics.count()));
            }
        }
        Ok(Ensemble { study, shard, all, done, metrics })
    }
}

/// Ensembles that do not belong together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// Two studies.
    #[error("they belong to different studies:\n  {one}\n  {other}")]
    Study {
        /// Description of the one.
        one: String,
        /// Description of the other.
        other: String,
    },
    /// Trials that would count twice.
    #[error("trials {} to {} are in both", trials.start, trials.end - 1)]
    Twice {
        /// The first such range.
        trials: Range<u64>,
    },
}

impl Ensemble {
    /// Nothing done yet of a shard of a study.
    pub fn new(study: &Study, shard: Shard) -> Ensemble {
        let metrics = study.metrics().into_iter().map(|metric| (metric.name().to_owned(), Statistics::new()));
        Ensemble { study: study.identity(), shard, all: study.trials, done: Vec::new(), metrics: metrics.collect() }
    }

    /// The shard that it is of.
    pub fn shard(&self) -> Shard {
        self.shard
    }

    /// Whether it is of this study and shard, so that it can be taken up again.
    pub fn is_of(&self, study: &Study, shard: Shard) -> bool {
        self.study == study.identity() && self.shard == shard && self.all == study.trials
    }

    /// Trials done.
    pub fn trials(&self) -> u64 {
        self.done.iter().map(|range| range.end - range.start).sum()
    }

    /// Trials of the whole study.
    pub fn all(&self) -> u64 {
        self.all
    }

    /// Ranges of trials of the whole study that are not done.
    pub fn missing(&self) -> Vec<Range<u64>> {
        let starts = std::iter::once(0).chain(self.done.iter().map(|range| range.end));
        let ends = self.done.iter().map(|range| range.start).chain([self.all]);
        starts.zip(ends).filter(|(start, end)| start < end).map(|(start, end)| start..end).collect()
    }

    /// The first trial of its shard that is not done.
    pub(super) fn next_trial(&self, all: u64) -> u64 {
        let first = self.shard.trials(all).start;
        self.done.iter().find(|range| range.contains(&first)).map_or(first, |range| range.end)
    }

    /// Takes the trials from number `first` on.
    pub(super) fn take(&mut self, first: u64, rows: &[Row]) {
        let columns: Vec<usize> = self
            .metrics
            .iter()
            .map(|(name, _)| Metric::ALL.iter().position(|m| m.name() == name).unwrap_or(Metric::COUNT))
            .collect();
        self.metrics.par_iter_mut().zip(columns).for_each(|((_, statistics), column)| {
            rows.iter().filter_map(|row| row.get(column)).for_each(|value| statistics.take(*value));
        });
        self.add_range(first..first + rows.len() as u64);
    }

    fn add_range(&mut self, range: Range<u64>) {
        if range.is_empty() {
            return;
        }
        let place = self.done.partition_point(|other| other.start < range.start);
        self.done.insert(place, range);
        let mut joined: Vec<Range<u64>> = Vec::with_capacity(self.done.len());
        for range in self.done.drain(..) {
            match joined.last_mut() {
                Some(last) if last.end == range.start => last.end = range.end,
                _ => joined.push(range),
            }
        }
        self.done = joined;
    }

    /// Takes all trials of `other`, which must be of the same study and have no trials in common.
    pub fn merge(&mut self, other: &Ensemble) -> Result<(), MergeError> {
        let names = |e: &Ensemble| e.metrics.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
        if self.study != other.study || self.all != other.all || names(self) != names(other) {
            return Err(MergeError::Study { one: self.described(), other: other.described() });
        }
        for one in &self.done {
            for two in &other.done {
                let both = one.start.max(two.start)..one.end.min(two.end);
                if !both.is_empty() {
                    return Err(MergeError::Twice { trials: both });
                }
            }
        }
        for ((_, statistics), (_, more)) in self.metrics.iter_mut().zip(&other.metrics) {
            statistics.merge(more);
        }
        other.done.iter().for_each(|range| self.add_range(range.clone()));
        self.shard = Shard::WHOLE;
        Ok(())
    }

    fn described(&self) -> String {
        format!("{} trials of {}", self.all, self.study)
    }

    /// Its metrics and their statistics, in order.
    pub fn statistics(&self) -> impl Iterator<Item = (Metric, &Statistics)> {
        self.metrics
            .iter()
            .filter_map(|(name, statistics)| Some((Metric::ALL.into_iter().find(|m| m.name() == name)?, statistics)))
    }

    /// The statistics of one metric, if the study has it.
    pub fn get(&self, metric: Metric) -> Option<&Statistics> {
        self.statistics().find(|(m, _)| *m == metric).map(|(_, s)| s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drive::Robot;
    use crate::effect::Model;
    use std::ops::ControlFlow;

    #[test]
    fn an_ensemble_that_cannot_be_true_is_refused() {
        let mut model = Model::new(&Robot::labmate());
        model.set("wheel_noise", "k_sqrt_m", 1e-3).unwrap();
        let study = Study { runs: [1, 1], ..Study::new(model, 50, 3) };
        let good = serde_json::to_value(study.run(|_| ControlFlow::Continue(())).unwrap()).unwrap();
        assert!(serde_json::from_value::<Ensemble>(good.clone()).is_ok());
        let range = |start: u64, end: u64| serde_json::json!({ "start": start, "end": end });
        let forged = [
            ("/done", serde_json::json!([])),
            ("/done", serde_json::json!([range(0, 25), range(0, 25)])),
            ("/done", serde_json::json!([range(25, 50), range(0, 25)])),
            ("/done", serde_json::json!([range(0, 60)])),
            ("/done", serde_json::json!([range(50, 0)])),
            ("/done", serde_json::json!([range(0, u64::MAX)])),
            ("/all", serde_json::json!(10)),
            ("/shard/index", serde_json::json!(7)),
            ("/shard/count", serde_json::json!(0)),
            ("/metrics/0/0", serde_json::json!("speed")),
            ("/metrics/0/0", good["metrics"][1][0].clone()),
            ("/metrics/0/1", serde_json::to_value(Statistics::new()).unwrap()),
        ];
        for (key, value) in forged {
            let mut changed = good.clone();
            *changed.pointer_mut(key).unwrap() = value.clone();
            assert!(serde_json::from_value::<Ensemble>(changed).is_err(), "{key} {value}");
        }
    }
}
