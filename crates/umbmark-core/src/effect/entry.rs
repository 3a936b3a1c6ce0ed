//! An effect as data.

use super::laws::{
    BodyLaw, BumpLaw, ClockLaw, DiffusionLaw, FilterLaw, LinkLaw, MeasurementLaw, SightLaw, StartLaw, WheelLaw,
};
use super::{
    About, Bump, CATALOGUE, Changes, Effect, Filter, Here, MAX_PARAMETERS, Shown, Sight, Stretch, Tried, WheelVariance,
};
use crate::drive::{DriveKind, DriveKinds, LinkReading, Robot, WheelTravel};
use crate::geometry::{Displacement2, Dual, Instructions, Pose2, Real};
use crate::random::Stream;

/// The deterministic part of an effect, for one kind of number.
#[derive(Clone, Copy, Debug)]
pub struct MeanLaws<T: Real> {
    /// See [`StartLaw::start`].
    pub start: fn(&[T]) -> Pose2<T>,
    /// See [`WheelLaw::wheels`].
    pub wheels: fn(&[T], &Here<T>, &mut WheelTravel<T>),
    /// See [`BodyLaw::body`].
    pub body: fn(&[T], &Here<T>, &mut Displacement2<T>),
    /// See [`LinkLaw::link`].
    pub link: fn(&[T], &mut LinkReading<T>),
    /// See [`ClockLaw::late`].
    pub late: fn(&[T], f64, &mut T),
    /// See [`FilterLaw::filter`].
    pub filter: fn(&[T], &mut Filter<T>),
    /// See [`SightLaw::seen`].
    pub seen: fn(&[T], &Sight, &mut Pose2<T>),
}

impl<T: Real> MeanLaws<T> {
    /// Changes nothing.
    const fn nothing() -> MeanLaws<T> {
        MeanLaws {
            start: |_| Pose2::IDENTITY.lift(),
            wheels: |_, _, _| (),
            body: |_, _, _| (),
            link: |_, _| (),
            late: |_, _, _| (),
            filter: |_, _| (),
            seen: |_, _, _| (),
        }
    }
}

/// The random part of an effect.
#[derive(Clone, Copy, Debug)]
pub struct RandomLaws {
    /// See [`DiffusionLaw::diffusion`].
    pub diffusion: fn(&[f64], &WheelTravel) -> WheelVariance,
    /// See [`BumpLaw::bumps`].
    pub bumps: fn(&[f64], &Stretch, &mut Stream, &mut Vec<Bump>),
    /// See [`StartLaw::start_scatter`].
    pub start_scatter: fn(&[f64], &mut Stream) -> Pose2,
    /// See [`MeasurementLaw::measured`].
    pub measured: fn(&[f64], &mut Stream, &mut Pose2),
}

impl RandomLaws {
    /// Changes nothing.
    pub const NOTHING: RandomLaws = RandomLaws {
        diffusion: |_, _| WheelVariance { left: 0.0, right: 0.0 },
        bumps: |_, _, _, _| (),
        start_scatter: |_, _| Pose2::IDENTITY,
        measured: |_, _, _| (),
    };
}

/// An effect as data: from the catalogue, or from a program that adds its own with [`Model::add_entry`](crate::effect::Model::add_entry).
///
/// ```
/// use umbmark_core::{drive::Robot, geometry::{Displacement2, Real}, parameter::Parameter};
/// use umbmark_core::effect::{About, ActsOn, BodyLaw, Here, Effect, Entry, Model};
/// struct Draught;
/// impl Effect for Draught {
///     const ABOUT: About = About {
///         name: "draught",
///         title: "a door left open",
///         acts_on: ActsOn::Body,
///         parameters: &[Parameter::size("push_m_per_m", "", "m/m", 1e-3, (-1.0, 1.0), "drift to the left per metre")],
///         equation: "sideways ← sideways + k · length",
///         physics: "Wind.",
///         signature: "A drift to the left on every leg.",
///         confused_with: &["crab"],
///         separated_by: "closing the door",
///         source: "none",
///     };
///     fn varies(p: &[f64]) -> bool {
///         p[0] != 0.0
///     }
/// }
/// impl BodyLaw for Draught {
///     fn body<T: Real>(p: &[T], at: &Here<T>, motion: &mut Displacement2<T>) {
///         motion.sideways += p[0] * at.length;
///     }
/// }
/// static DRAUGHT: Entry = Entry::of::<Draught>().body::<Draught>();
/// let mut model = Model::new(&Robot::labmate());
/// model.add_entry(&DRAUGHT)?.free = true;
/// model.set("draught", "push_m_per_m", 2e-3)?;
/// assert!(model.varies() && model.set("draught", "push_m_per_m", 2.0).is_err());
/// # Ok::<(), umbmark_core::effect::ModelError>(())
/// ```
#[derive(Debug)]
pub struct Entry {
    /// What people should know of it.
    pub about: About,
    drives: DriveKinds,
    /// What its laws change.
    pub changes: Changes,
    /// See [`Effect::means`].
    pub means: fn(&[f64], &Robot) -> String,
    /// See [`Effect::unknown_scale`].
    pub unknown_scale: fn(&[f64]) -> f64,
    /// See [`Effect::is_credible`].
    pub is_credible: fn(&[f64]) -> bool,
    /// See [`Effect::varies`].
    pub varies: fn(&[f64]) -> bool,
    /// See [`Effect::tried`].
    pub tried: fn(&Shown) -> Vec<Tried>,
    /// See [`Effect::powers`].
    pub powers: fn() -> &'static [&'static Entry],
    /// Whether it is the floor's: it stays there when the robot goes elsewhere.
    pub is_of_floor: bool,
    /// Whether its signature is in proportion to what other effects do: it is computed anew when these are fitted anew.
    pub(crate) rests_on_others: bool,
    pub(crate) values: MeanLaws<f64>,
    /// For each of the [`Instructions`], in their order.
    pub(super) duals: [MeanLaws<Dual>; 3],
    pub(crate) scatter: RandomLaws,
}

/// Makes the functions that list a law whose code is the same for all register widths.
macro_rules! laws {
    ($($(#[$about:meta])* $name:ident: $Law:ident changes $Change:ident,)+) => {
        $($(#[$about])*
        pub const fn $name<E: $Law>(mut self) -> Entry {
            self.values.$name = E::$name::<f64>;
            self.duals[0].$name = E::$name::<Dual>;
            self.duals[1].$name = E::$name::<Dual>;
            self.duals[2].$name = E::$name::<Dual>;
            self.changes = self.changes.and(Changes::$Change);
            self
        })+
    };
}

impl Entry {
    /// The entry of an effect; its laws are listed after it. One with more than [`MAX_PARAMETERS`] parameters does not compile.
    pub const fn of<E: Effect>() -> Entry {
        assert!(E::ABOUT.parameters.len() <= MAX_PARAMETERS);
        Entry {
            about: E::ABOUT,
            drives: E::DRIVES,
            changes: Changes::NOTHING,
            means: E::means,
            unknown_scale: E::unknown_scale,
            is_credible: E::is_credible,
            varies: E::varies,
            tried: E::tried,
            powers: E::powers,
            is_of_floor: false,
            rests_on_others: false,
            values: MeanLaws::nothing(),
            duals: [MeanLaws::nothing(), MeanLaws::nothing(), MeanLaws::nothing()],
            scatter: RandomLaws::NOTHING,
        }
    }

    /// Lists its law of the wheels.
    pub const fn wheels<E: WheelLaw>(mut self) -> Entry {
        self.values.wheels = E::wheels::<f64>;
        let [plain, four, eight] = wheels::<E>();
        self.duals[0].wheels = plain;
        self.duals[1].wheels = four;
        self.duals[2].wheels = eight;
        self.changes = self.changes.and(Changes::WHEELS);
        self
    }

    /// Lists its law of the body.
    pub const fn body<E: BodyLaw>(mut self) -> Entry {
        self.values.body = E::body::<f64>;
        let [plain, four, eight] = body::<E>();
        self.duals[0].body = plain;
        self.duals[1].body = four;
        self.duals[2].body = eight;
        self.changes = self.changes.and(Changes::BODY);
        self
    }

    laws! {
        /// Lists its law of the link between two trucks.
        link: LinkLaw changes LINK,
        /// Lists its law of the clock.
        late: ClockLaw changes CLOCK,
        /// Lists its law of the filter of what is measured.
        filter: FilterLaw changes FILTER,
        /// Lists its law of what is measured.
        seen: SightLaw changes SEEN,
    }

    /// Lists its law of START.
    pub const fn start<E: StartLaw>(mut self) -> Entry {
        self.values.start = E::start::<f64>;
        self.duals[0].start = E::start::<Dual>;
        self.duals[1].start = E::start::<Dual>;
        self.duals[2].start = E::start::<Dual>;
        self.scatter.start_scatter = E::start_scatter;
        self.changes = self.changes.and(Changes::START).and(Changes::START_SCATTER);
        self
    }

    /// Lists its law of noise on the wheels.
    pub const fn diffusion<E: DiffusionLaw>(mut self) -> Entry {
        self.scatter.diffusion = E::diffusion;
        self.changes = self.changes.and(Changes::DIFFUSION);
        self
    }

    /// Says that it is the floor's.
    pub const fn of_floor(self) -> Entry {
        Entry { is_of_floor: true, ..self }
    }

    /// Says that its signature is in proportion to what other effects do.
    pub const fn resting_on_others(self) -> Entry {
        Entry { rests_on_others: true, ..self }
    }

    /// Lists its law of bumps.
    pub const fn bumps<E: BumpLaw>(mut self) -> Entry {
        self.scatter.bumps = E::bumps;
        self.changes = self.changes.and(Changes::BUMPS);
        self
    }

    /// Lists its law of noise of measurements.
    pub const fn measured<E: MeasurementLaw>(mut self) -> Entry {
        self.scatter.measured = E::measured;
        self.changes = self.changes.and(Changes::MEASURED);
        self
    }

    /// The drives that may have it: those of [`Effect::DRIVES`], and those that name it.
    pub fn drives(&self) -> DriveKinds {
        let adopting = DriveKind::ALL.iter().filter(|kind| kind.adopts(self.about.name));
        adopting.fold(self.drives, |drives, kind| drives.and(*kind))
    }

    /// Effects that look the same: those that it [names](About::confused_with), and those that name it.
    pub fn confused_with(&self) -> Vec<&'static str> {
        let mut alike = self.about.confused_with.to_vec();
        let naming = CATALOGUE.iter().filter(|other| other.about.confused_with.contains(&self.about.name));
        alike.extend(naming.map(|other| other.about.name).filter(|name| !self.about.confused_with.contains(name)));
        alike
    }

    /// A number that names the effect's random stream: a hash of its name (FNV-1a), so that the order of the catalogue
    /// does not matter.
    pub(crate) fn purpose(&self) -> u64 {
        self.about
            .name
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325, |hash: u64, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Entry) -> bool {
        self.about.name == other.about.name
    }
}

/// A kind of number with which effects can be evaluated.
pub trait Evaluate: Real {
    /// The deterministic part of an effect for this kind of number.
    fn mean(entry: &Entry) -> &MeanLaws<Self>;
}

impl Evaluate for f64 {
    fn mean(entry: &Entry) -> &MeanLaws<f64> {
        &entry.values
    }
}

impl Evaluate for Dual {
    fn mean(entry: &Entry) -> &MeanLaws<Dual> {
        &entry.duals[Instructions::best() as usize]
    }
}

/// A law of derivatives compiled for registers of each width: for each of the [`Instructions`], in their order.
macro_rules! for_each_width {
    ($law:ident of $Law:ident on $Moved:ty) => {
        const fn $law<E: $Law>() -> [fn(&[Dual], &Here<Dual>, &mut $Moved); 3] {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx512f,avx512dq")]
                fn eight<E: $Law>(p: &[Dual], at: &Here<Dual>, moved: &mut $Moved) {
                    E::$law(p, at, moved);
                }
                #[target_feature(enable = "avx2")]
                fn four<E: $Law>(p: &[Dual], at: &Here<Dual>, moved: &mut $Moved) {
                    E::$law(p, at, moved);
                }
                // SAFETY: `Evaluate::mean` hands these out to machines only that were found to have such registers.
                [
                    E::$law,
                    |p, at, moved| unsafe { four::<E>(p, at, moved) },
                    |p, at, moved| unsafe { eight::<E>(p, at, moved) },
                ]
            }
            #[cfg(not(target_arch = "x86_64"))]
            [E::$law; 3]
        }
    };
}
for_each_width!(wheels of WheelLaw on WheelTravel<Dual>);
for_each_width!(body of BodyLaw on Displacement2<Dual>);
