//! Plans a robotic bin-packing cell: items arrive on a conveyor, one or two arms pack them into a
//! bin and may unpack and repack what is already there.
//!
//! Lengths are in bin cells, x to the right, y down; those of a [`Cell`] are in metres, radians and
//! seconds. Every call that can fail gives an [`Error`] with the library's message.
//!
//! Handles free themselves, in any order. [`Policy`] and [`Cell`] are immutable and may be shared by
//! threads. The others may be sent to another thread but not be used by two at once, which the
//! compiler sees:
//!
//! ```compile_fail,E0277
//! let bin = packcell::Bin::new(10, 10).unwrap();
//! std::thread::scope(|s| {
//!     s.spawn(|| bin.info());
//! });
//! ```
//!
//! # Example
//!
//! ```
//! use packcell::{item, Bin, Budget, Planner, PlannerOptions, Policy, Queue};
//!
//! # fn main() -> packcell::Result<()> {
//! let mut bin = Bin::new(10, 10)?;
//! let mut queue = Queue::new(&"D-R5A3O1".parse()?)?;
//! for id in 0..4 {
//!     queue.push(&item(id, 3, 2))?;
//! }
//! let mut planner = Planner::new(&PlannerOptions::default(), Some(&Policy::new("contact")?))?;
//! let plan = planner.plan(&bin, &queue, &Budget::nodes(20_000))?;
//! packcell::apply(&mut bin, &mut queue, &plan.actions)?;
//! assert!(bin.info()?.items > 0);
//! # Ok(())
//! # }
//! ```
#![warn(missing_docs, unsafe_op_in_unsafe_fn)]
#![warn(clippy::undocumented_unsafe_blocks)]

mod bin;
mod cell;
mod error;
mod exact;
mod generator;
mod grid;
mod handle;
mod options;
mod planner;
mod policy;
mod queue;
mod schedule;

pub use bin::{Bin, CELL_FIXED, CELL_FREE};
pub use cell::{Cell, LayoutOptions, Pose};
pub use error::{Error, Result, Status};
pub use exact::{bound_in_order, exact_pack, Bound, Packing};
pub use generator::{Generator, GeneratorOptions, GENERATE_FULL, GENERATE_RANDOM};
pub use grid::{Grid, Size};
pub use options::Budget;
pub use planner::{constants as plan, Canceller, Plan, Planner, PlannerOptions};
pub use policy::{Batch, Evaluation, Measurement, Policy, TrainerOptions};
pub use queue::{Queue, Scenario};
pub use schedule::{Mode, Schedule, Simulation, SimulationOptions, Trace};

/// An item of `w` x `h` cells; `id` is the caller's.
pub use packcell_sys::pkc_item as Item;

/// An action of a plan; its operation is one of [`op`].
pub use packcell_sys::pkc_action as Action;

pub use packcell_sys::{
    pkc_arm_sample as ArmSample, pkc_bin_info as BinInfo, pkc_cell_info as CellInfo,
    pkc_layout_info as LayoutInfo, pkc_place as Place, pkc_placement as Placement,
    pkc_plan_info as PlanInfo, pkc_policy_info as PolicyInfo, pkc_queue_info as QueueInfo,
    pkc_queued as Queued, pkc_schedule_info as ScheduleInfo, pkc_simulation_info as SimulationInfo,
};

/// The functions as they are in C.
pub use packcell_sys as sys;

use error::check;

/// What an action does.
pub mod op {
    pub use packcell_sys::{
        PKC_OP_PACK as PACK, PKC_OP_SKIP as SKIP, PKC_OP_TERMINATE as TERMINATE,
        PKC_OP_UNPACK as UNPACK,
    };
}

/// Flags of an item.
pub mod flags {
    pub use packcell_sys::{PKC_ITEM_NO_ROTATE as NO_ROTATE, PKC_ITEM_PINNED as PINNED};
}

/// What a policy is made of, in [`PolicyInfo`].
pub mod architecture {
    pub use packcell_sys::{
        PKC_ARCH_ACTOR_CRITIC as ACTOR_CRITIC, PKC_ARCH_AFTERSTATE as AFTERSTATE,
        PKC_ARCH_FULLY_CONVOLUTIONAL as FULLY_CONVOLUTIONAL, PKC_ARCH_HEURISTIC as HEURISTIC,
    };
}

/// Whether items are turned, in [`TrainerOptions`].
pub mod rotation {
    pub use packcell_sys::{
        PKC_ROTATION_MIXED as MIXED, PKC_ROTATION_OFF as OFF, PKC_ROTATION_ON as ON,
    };
}

/// What an arm does, in [`ArmSample`].
pub mod activity {
    pub use packcell_sys::{
        PKC_ACTIVITY_GRIP as GRIP, PKC_ACTIVITY_LIFT as LIFT, PKC_ACTIVITY_LOWER as LOWER,
        PKC_ACTIVITY_RELEASE as RELEASE, PKC_ACTIVITY_TRAVEL as TRAVEL, PKC_ACTIVITY_WAIT as WAIT,
    };
}

/// Why an arm waits, in [`ArmSample`] and, as an index, in [`ScheduleInfo`].
pub mod wait {
    pub use packcell_sys::{
        PKC_WAIT_BELT as BELT, PKC_WAIT_BIN as BIN, PKC_WAIT_CELLS as CELLS, PKC_WAIT_DONE as DONE,
        PKC_WAIT_OTHER_ARM as OTHER_ARM, PKC_WAIT_PLANNING as PLANNING, PKC_WAIT_SYNC as SYNC,
    };
}

/// What became of an item, in [`Place`].
pub mod outcome {
    pub use packcell_sys::{
        PKC_PLACE_ABSENT as ABSENT, PKC_PLACE_JAMMED as JAMMED, PKC_PLACE_MISPLACED as MISPLACED,
        PKC_PLACE_OK as OK,
    };
}

/// An item without flags.
pub fn item(id: i32, w: i32, h: i32) -> Item {
    Item { id, w, h, flags: 0 }
}

/// Version of the linked library: major, minor, patch.
pub fn version() -> (u32, u32, u32) {
    // SAFETY: takes nothing.
    let v = unsafe { sys::pkc_version() };
    (v / 10_000, v / 100 % 100, v % 100)
}

/// The hash of a plan: equal plans have equal hashes on every machine and in every language.
pub fn plan_hash(actions: &[Action]) -> Result<u64> {
    let mut hash = 0;
    // SAFETY: the pointer is good for as many actions as are said.
    check(unsafe { sys::pkc_plan_hash(actions.as_ptr(), actions.len(), &mut hash) })?;
    Ok(hash)
}

/// Carries out one step's actions on bin and queue, all or nothing; [`Status::State`] with the
/// action's index when one breaks a rule.
pub fn apply(bin: &mut Bin, queue: &mut Queue, actions: &[Action]) -> Result<()> {
    // SAFETY: both handles live, and the pointer is good for as many actions as are said.
    check(unsafe {
        sys::pkc_step_apply(
            bin.as_ptr(),
            queue.as_ptr(),
            actions.as_ptr(),
            actions.len(),
        )
    })
}

/// Bin, conveyor and buffers as bytes, the same on every machine.
pub fn save_snapshot(bin: &Bin, queue: &Queue) -> Result<Vec<u8>> {
    // SAFETY: both handles live; `fill` gives a pointer that is good for the capacity.
    handle::fill(|bytes, capacity, size| unsafe {
        sys::pkc_snapshot_save(bin.as_ptr(), queue.as_ptr(), bytes, capacity, size)
    })
}

/// A bin and a queue from such bytes; [`Status::Format`] names the first offset that is wrong.
pub fn load_snapshot(bytes: &[u8]) -> Result<(Bin, Queue)> {
    let mut queue = std::ptr::null_mut();
    // SAFETY: the pointer is good for as many bytes as are said.
    let bin = Bin::make(|bin| unsafe {
        sys::pkc_snapshot_load(bytes.as_ptr(), bytes.len(), bin, &mut queue)
    })?;
    let queue = std::ptr::NonNull::new(queue).expect("packcell succeeds with a handle");
    // SAFETY: the call has made it for us.
    Ok((bin, unsafe { Queue::from_raw(queue) }))
}
