//! Plans steps: what to unpack, pack and skip next.

use crate::error::check;
use crate::handle::filled;
use crate::options::options;
use crate::{Action, Bin, Budget, PlanInfo, Policy, Queue, Result};
use packcell_sys as sys;
use std::cell::Cell;
use std::marker::PhantomData;
use std::ptr::{self, NonNull};
use std::sync::Arc;

/// Values of the fields of [`PlannerOptions`] and [`PlanInfo`].
pub mod constants {
    pub use packcell_sys::{
        PKC_METHOD_EXACT as METHOD_EXACT, PKC_METHOD_PAPER as METHOD_PAPER,
        PKC_PROOF_BUDGET as PROOF_BUDGET, PKC_PROOF_IMPOSSIBLE as PROOF_IMPOSSIBLE,
        PKC_PROOF_NONE as PROOF_NONE, PKC_PROOF_OPTIMAL as PROOF_OPTIMAL,
        PKC_REPACK_ANYTIME as REPACK_ANYTIME, PKC_REPACK_FULL as REPACK_FULL,
        PKC_REPACK_OFF as REPACK_OFF, PKC_SELECT_ALL as SELECT_ALL, PKC_SELECT_AUTO as SELECT_AUTO,
        PKC_UNLIMITED as UNLIMITED,
    };
}

options! {
    /// How a planner plans.
    PlannerOptions, pkc_planner_options, pkc_planner_options_init
}

/// One step's actions.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// What is known of the plan.
    pub info: PlanInfo,
    /// At most 768.
    pub actions: Vec<Action>,
}

/// Freed by the last of the planner and its cancellers: none of them may outlive it.
#[derive(Debug)]
struct Handle(NonNull<sys::pkc_planner>);

// SAFETY: shared, it serves for pkc_planner_cancel alone, which is for any thread.
unsafe impl Send for Handle {}
// SAFETY: as above.
unsafe impl Sync for Handle {}

impl Drop for Handle {
    fn drop(&mut self) {
        // SAFETY: nobody else has the handle any more.
        unsafe { sys::pkc_planner_free(self.0.as_ptr()) }
    }
}

/// Ends, from any thread, the plan that a [`Planner`] is making.
#[derive(Clone, Debug)]
pub struct Canceller(Arc<Handle>);

impl Canceller {
    /// The plan being made ends with the best so far. A plan begun later is not affected.
    pub fn cancel(&self) -> Result<()> {
        // SAFETY: the handle lives, and this call is for any thread.
        check(unsafe { sys::pkc_planner_cancel(self.0 .0.as_ptr()) })
    }
}

/// Plans the next step of a bin and a queue.
#[derive(Debug)]
pub struct Planner {
    handle: Arc<Handle>,
    not_sync: PhantomData<Cell<()>>,
}

impl Planner {
    /// All memory is taken here. Without a policy it is the default one. The planner keeps what it
    /// needs of the policy.
    pub fn new(options: &PlannerOptions, policy: Option<&Policy>) -> Result<Planner> {
        let policy = policy.map_or(ptr::null_mut(), Policy::as_ptr);
        let mut raw = ptr::null_mut();
        // SAFETY: the struct is of the size that it says, and the policy lives or is NULL.
        check(unsafe { sys::pkc_planner_create(&options.raw(), policy, &mut raw) })?;
        let raw = NonNull::new(raw).expect("packcell succeeds with a handle");
        Ok(Planner {
            handle: Arc::new(Handle(raw)),
            not_sync: PhantomData,
        })
    }

    /// The handle for a call of [`crate::sys`]; it stays this object's own.
    pub fn as_ptr(&self) -> *mut sys::pkc_planner {
        self.handle.0.as_ptr()
    }

    /// What another thread needs to end a plan.
    pub fn canceller(&self) -> Canceller {
        Canceller(Arc::clone(&self.handle))
    }

    /// The next step; always a legal one. Changes neither bin nor queue.
    pub fn plan(&mut self, bin: &Bin, queue: &Queue, budget: &Budget) -> Result<Plan> {
        // SAFETY: the handles live.
        check(unsafe {
            sys::pkc_planner_plan(
                self.as_ptr(),
                bin.as_ptr(),
                queue.as_ptr(),
                &budget.raw(),
                ptr::null_mut(),
            )
        })?;
        self.result()
    }

    /// The same work in slices: copies the state, then [`Planner::step`] plans.
    pub fn begin(&mut self, bin: &Bin, queue: &Queue, budget: &Budget) -> Result<()> {
        // SAFETY: the handles live.
        check(unsafe {
            sys::pkc_planner_begin(self.as_ptr(), bin.as_ptr(), queue.as_ptr(), &budget.raw())
        })
    }

    /// Spends up to so many nodes, at least 1; true when nothing is left to do.
    pub fn step(&mut self, nodes: u64) -> Result<bool> {
        let mut done = 0;
        // SAFETY: the handle lives.
        check(unsafe { sys::pkc_planner_step(self.as_ptr(), nodes, &mut done) })?;
        Ok(done != 0)
    }

    /// The plan, or the best so far.
    pub fn result(&mut self) -> Result<Plan> {
        let mut actions = vec![Action::default(); sys::PKC_MAX_ACTIONS as usize];
        let mut count = 0;
        // SAFETY: the handle lives and the array has as many elements as are said.
        let info = filled(sys::pkc_plan_info_init, |info| unsafe {
            let to = actions.as_mut_ptr();
            sys::pkc_planner_result(self.as_ptr(), info, to, actions.len(), &mut count)
        })?;
        actions.truncate(count);
        Ok(Plan { info, actions })
    }
}
