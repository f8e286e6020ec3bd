//! From the millimetres of a real bin to cells and back.

use crate::error::check;
use crate::options::options;
use crate::Result;
use packcell_sys as sys;

options! {
    /// A real bin and its cells, in millimetres, up to 1e6; the default is the paper's. A side has
    /// `floor((side - 2 * margin) / cell)` cells, an item takes `ceil((side + clearance) / cell)`.
    Grid, pkc_grid, pkc_grid_init
}

/// Sides in cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// To the right.
    pub w: i32,
    /// Down.
    pub h: i32,
}

impl Grid {
    /// Cells of the bin's sides.
    pub fn bin(&self) -> Result<Size> {
        let (mut w, mut h) = (0, 0);
        // SAFETY: all pointers are to values of this function's.
        check(unsafe { sys::pkc_grid_bin(&self.raw(), &mut w, &mut h) })?;
        Ok(Size { w, h })
    }

    /// Cells that an item of `width` x `height` millimetres takes.
    pub fn item(&self, width: f64, height: f64) -> Result<Size> {
        let (mut w, mut h) = (0, 0);
        // SAFETY: all pointers are to values of this function's.
        check(unsafe { sys::pkc_grid_item(&self.raw(), width, height, &mut w, &mut h) })?;
        Ok(Size { w, h })
    }

    /// Centre of a `w` x `h` rectangle of cells at cell (x, y), in millimetres to the right and down
    /// from the inside top-left corner of the bin: where an item is put down with its own centre.
    pub fn centre(&self, x: i32, y: i32, w: i32, h: i32) -> Result<(f64, f64)> {
        let (mut right, mut down) = (0.0, 0.0);
        // SAFETY: all pointers are to values of this function's.
        check(unsafe { sys::pkc_grid_centre(&self.raw(), x, y, w, h, &mut right, &mut down) })?;
        Ok((right, down))
    }
}
