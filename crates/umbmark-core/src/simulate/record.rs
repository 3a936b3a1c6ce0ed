//! A run written down: what the encoders showed, and where the robot really was.

use super::{Rest, SimulateError, Simulator, Truth, return_error};
use crate::dataset::{ReferencePose, ReturnError, TickLog};
use crate::effect::{Stretch, TestKind};
use crate::engine::{SampledOdometry, TickGeometry, UNITS_PER_TICK, Update};
use crate::geometry::Pose2;
use crate::path::Direction;

/// A simulated run with everything that can be known of it.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Ticks and measured poses.
    pub log: TickLog,
    /// The true pose at every sample of the log.
    pub truth: Vec<Pose2>,
    /// The pose that the robot computed from its ticks, at every sample of the log.
    pub computed: Vec<Pose2>,
    /// Measured minus computed end pose.
    pub returned: ReturnError,
}

/// The robot stands still for so long before the first and after the last move \[s\].
const STANDING: f64 = 1.0;

impl Simulator {
    /// Drives once round the path, reading the counters `rate` times a second and measuring the absolute pose
    /// `reference_rate` times a second, both while standing before and after too.
    ///
    /// The wheel angles are those that [`Simulator::run`] with the same streams would make; the true motion is drawn from
    /// the same distribution, sample by sample.
    pub fn record(
        &mut self,
        truth: &mut Truth,
        direction: Direction,
        test: TestKind,
        [rate, reference_rate]: [f64; 2],
    ) -> Result<Recording, SimulateError> {
        for (what, value) in [("sampling rate", rate), ("reference rate", reference_rate)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(SimulateError::Rate { what, value });
            }
        }
        truth.start();
        let per_tick = self.robot().metres_per_tick();
        let geometry = TickGeometry::new(per_tick.left, per_tick.right, self.robot().drive.wheelbase())?;
        let mut track = SampledOdometry::new(geometry, Update::Arc).track();
        let legs = self.course(direction).legs.clone();
        let rests: Vec<Rest> = std::iter::once([0; 2])
            .chain(legs.iter().map(|leg| leg.stop))
            .map(|count| Rest { count, phase: self.draw_phase() })
            .collect();
        let samples = ((self.course(direction).duration() + 2.0 * STANDING) * rate).ceil() as usize;
        let mut recording = Recording {
            log: TickLog::default(),
            truth: Vec::with_capacity(samples + 1),
            computed: Vec::with_capacity(samples + 1),
            returned: ReturnError::default(),
        };
        let (mut begun, mut next_reference) = (0, 0.0);
        for sample in 0..=samples {
            let time = sample as f64 / rate;
            let driving = time - STANDING;
            // Every move that ended since the last sample is driven to its end, the present one as far as it has come.
            while begun > 0 && begun < legs.len() && driving >= legs[begun].begins || begun == 0 && driving >= 0.0 {
                truth.advance(1.0);
                let leg = &legs[begun];
                let line = rests[begun].line_to(&rests[begun + 1]);
                let stretch = Stretch { index: begun, direction, test, travel: self.per_tick.of(&line) };
                truth.begin(stretch, leg.travel);
                begun += 1;
            }
            let counts = match begun.checked_sub(1) {
                None => [0; 2],
                Some(index) => {
                    let share = legs[index].profile.fraction(driving - legs[index].begins);
                    truth.advance(share);
                    let line = rests[index].line_to(&rests[index + 1]);
                    std::array::from_fn(|wheel| {
                        let angle = line.start()[wheel] + (line.travel()[wheel] as f64 * share) as i64;
                        rests[index].count[wheel] + angle.div_euclid(UNITS_PER_TICK)
                    })
                }
            };
            track.read(counts);
            recording.log.time.push(time);
            recording.log.left.push(counts[0] as f64);
            recording.log.right.push(counts[1] as f64);
            recording.truth.push(truth.pose());
            recording.computed.push(track.pose());
            if time + 1e-9 >= next_reference || sample == samples {
                let pose = truth.measure();
                recording.log.reference.push(ReferencePose {
                    sample,
                    x: pose.x,
                    y: pose.y,
                    heading: Some(pose.heading),
                });
                next_reference += 1.0 / reference_rate;
            }
        }
        let measured = truth.measure();
        recording.returned = return_error(&measured, &track.pose());
        Ok(recording)
    }
}
