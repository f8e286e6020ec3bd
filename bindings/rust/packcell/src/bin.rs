//! The bin that items are packed into.

use crate::error::check;
use crate::handle::{fill, filled, handle};
use crate::{BinInfo, Item, Placement, Result};
use packcell_sys as sys;

/// In [`Bin::cells`]: nothing is there.
pub const CELL_FREE: i32 = sys::PKC_CELL_FREE;
/// In [`Bin::cells`]: taken by [`Bin::block`].
pub const CELL_FIXED: i32 = sys::PKC_CELL_FIXED;

handle! {
    /// A bin of cells, with the items in it.
    Bin, pkc_bin, pkc_bin_free
}

impl Bin {
    /// An empty bin of `w` x `h` cells, each 1..128.
    pub fn new(w: i32, h: i32) -> Result<Bin> {
        // SAFETY: `out` is a place for the handle.
        Bin::make(|out| unsafe { sys::pkc_bin_create(w, h, out) })
    }

    /// A bin of its own with the same contents.
    pub fn try_clone(&self) -> Result<Bin> {
        // SAFETY: the handle lives.
        Bin::make(|out| unsafe { sys::pkc_bin_clone(self.as_ptr(), out) })
    }

    /// Removes every item; fixed cells stay.
    pub fn clear(&mut self) -> Result<()> {
        // SAFETY: the handle lives.
        check(unsafe { sys::pkc_bin_clear(self.as_ptr()) })
    }

    /// Marks the free cells of a rectangle as taken from the start.
    pub fn block(&mut self, x: i32, y: i32, w: i32, h: i32) -> Result<()> {
        // SAFETY: the handle lives.
        check(unsafe { sys::pkc_bin_block(self.as_ptr(), x, y, w, h) })
    }

    /// Puts an item at (x, y), turned by a quarter if `rot` is 1.
    pub fn pack(&mut self, item: &Item, x: i32, y: i32, rot: i32) -> Result<()> {
        // SAFETY: the handle lives.
        check(unsafe { sys::pkc_bin_pack(self.as_ptr(), item, x, y, rot) })
    }

    /// Takes an item out, and says where it was.
    pub fn unpack(&mut self, id: i32) -> Result<Placement> {
        let mut placement = Placement::default();
        // SAFETY: the handle lives.
        check(unsafe { sys::pkc_bin_unpack(self.as_ptr(), id, &mut placement) })?;
        Ok(placement)
    }

    /// Sides, counts and hash.
    pub fn info(&self) -> Result<BinInfo> {
        // SAFETY: the handle lives.
        filled(sys::pkc_bin_info_init, |info| unsafe {
            sys::pkc_bin_get_info(self.as_ptr(), info)
        })
    }

    /// The packed items in packing order.
    pub fn items(&self) -> Result<Vec<Placement>> {
        // SAFETY: the handle lives and `fill` gives room for the capacity.
        fill(|to, capacity, count| unsafe {
            sys::pkc_bin_items(self.as_ptr(), to, capacity, count)
        })
    }

    /// W*H cells by index x + y*W: an item's id, [`CELL_FREE`] or [`CELL_FIXED`].
    pub fn cells(&self) -> Result<Vec<i32>> {
        // SAFETY: the handle lives and `fill` gives room for the capacity.
        fill(|to, capacity, count| unsafe {
            sys::pkc_bin_cells(self.as_ptr(), to, capacity, count)
        })
    }

    /// W*H + 1 bytes, 1 where the top-left corner of an item that covers `w` x `h` cells may lie; the
    /// last is "no position".
    pub fn feasible(&self, w: i32, h: i32) -> Result<Vec<u8>> {
        // SAFETY: the handle lives and `fill` gives room for the capacity.
        fill(|to, capacity, count| unsafe {
            sys::pkc_bin_feasible(self.as_ptr(), w, h, to, capacity, count)
        })
    }

    /// The contact reward of a free rectangle: occupied cells and walls around it, 0..2(w+h).
    pub fn contact(&self, x: i32, y: i32, w: i32, h: i32) -> Result<i32> {
        let mut reward = 0;
        // SAFETY: the handle lives.
        check(unsafe { sys::pkc_bin_contact(self.as_ptr(), x, y, w, h, &mut reward) })?;
        Ok(reward)
    }
}
