//! Whether items fit together, decided exactly.

use crate::error::check;
use crate::handle::zeros;
use crate::{Bin, Budget, Item, Placement, Result};
use packcell_sys as sys;

/// Whether all items fit.
#[derive(Clone, Debug, PartialEq)]
pub enum Packing {
    /// They do, in this way; in the items' order.
    Found(Vec<Placement>),
    /// They do not.
    Impossible,
    /// The budget ended first.
    Undecided,
}

/// How many of the next items fit together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bound {
    /// Items from the first on, without one left out.
    pub count: usize,
    /// False when the budget ended first: the count is an upper bound only.
    pub exact: bool,
}

/// Can all items be placed on the bin's free cells, without moving what is there? At most 16384.
pub fn exact_pack(bin: &Bin, items: &[Item], rotation: bool, budget: &Budget) -> Result<Packing> {
    let mut placements = zeros(items.len())?;
    let mut answer = 0;
    let mut nodes = 0;
    // SAFETY: the handle lives, and both arrays have as many elements as are said.
    check(unsafe {
        sys::pkc_exact_pack(
            bin.as_ptr(),
            items.as_ptr(),
            items.len(),
            rotation.into(),
            &budget.raw(),
            placements.as_mut_ptr(),
            &mut answer,
            &mut nodes,
        )
    })?;
    Ok(match answer {
        sys::PKC_PACKING_FOUND => Packing::Found(placements),
        sys::PKC_PACKING_IMPOSSIBLE => Packing::Impossible,
        _ => Packing::Undecided,
    })
}

/// The clairvoyant bound: no planner without a buffer packs more of these items into this bin.
pub fn bound_in_order(bin: &Bin, items: &[Item], rotation: bool, budget: &Budget) -> Result<Bound> {
    let mut count = 0;
    let mut answer = 0;
    // SAFETY: the handle lives, and the array has as many elements as are said.
    check(unsafe {
        sys::pkc_bound_in_order(
            bin.as_ptr(),
            items.as_ptr(),
            items.len(),
            rotation.into(),
            &budget.raw(),
            &mut count,
            &mut answer,
        )
    })?;
    Ok(Bound {
        count,
        exact: answer != sys::PKC_PACKING_BUDGET,
    })
}
