//! A trial allocates nothing: counted by an allocator of its own, in a process of its own.

#![allow(clippy::unwrap_used)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

use umbmark_core::dataset::ReturnError;
use umbmark_core::drive::Robot;
use umbmark_core::effect::{Model, TestKind};
use umbmark_core::engine::Update;
use umbmark_core::path::Path;
use umbmark_core::simulate::{Odometry, Phase, Simulator, Truth};

struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call is passed on unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's promises are those of the system's allocator.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the pointer came from `alloc` above, that is from the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// After some trials have made room, as many more, with all random effects, ask for no memory.
#[test]
fn a_trial_allocates_nothing() {
    let mut model = random_effects();
    for odometry in [Odometry::EveryTick, Odometry::Sampled { rate: 100.0, update: Update::Arc }, Odometry::Continuous]
    {
        // Room for the most bumps of a leg is made as they come; a few hundred trials have met them.
        count(&model, odometry, 300, 100);
    }
    model.set("backlash", "play_m", 1e-3).unwrap();
    assert!(model.varies());
    count(&model, Odometry::Continuous, 60, 20);
}

fn random_effects() -> Model {
    let mut model = Model::new(&Robot::labmate());
    for (effect, parameter, value) in [
        ("wheelbase", "e_b", 1.01),
        ("wheel_noise", "k_sqrt_m", 1e-3),
        ("bumps", "rate_per_m", 1.5),
        ("placed_bumps", "count", 10.0),
        ("start_pose", "position_sd_m", 1e-3),
        ("reference_noise", "position_sd_m", 1e-3),
    ] {
        model.set(effect, parameter, value).unwrap();
    }
    model
}

fn count(model: &Model, odometry: Odometry, before: u64, after: u64) {
    let values: Vec<f64> = model.values().collect();
    let mut simulator = Simulator::new(model.robot(), &Path::umbmark(), odometry, Phase::Random).unwrap();
    let mut truth = Truth::new(model);
    let (mut cw, mut ccw) = ([ReturnError::default(); 5], [ReturnError::default(); 5]);
    let mut trial = |number: u64| {
        truth.set_values(&values);
        simulator.open(&mut truth, 1, number);
        for test in [TestKind::Systematic, TestKind::Bumps] {
            simulator.test(&mut truth, test, [&mut cw, &mut ccw]);
        }
    };
    (0..before).for_each(&mut trial);
    let so_far = ALLOCATIONS.load(Ordering::Relaxed);
    (0..after).for_each(&mut trial);
    assert_eq!(ALLOCATIONS.load(Ordering::Relaxed) - so_far, 0, "{odometry:?}");
}
