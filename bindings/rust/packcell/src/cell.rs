//! The cell: arms, belt, bin and buffers, in metres and radians.

use crate::error::{c_string, check, field_text, text};
use crate::handle::{c_path, fill, filled, fresh, handle};
use crate::options::options;
use crate::{Action, CellInfo, Error, LayoutInfo, Queue, Result, Scenario};
use packcell_sys as sys;
use std::os::raw::c_char;
use std::path::Path;

/// x, y and z of a tool's tip, and its yaw.
pub type Pose = [f64; 4];

options! {
    /// How a layout is looked for.
    LayoutOptions, pkc_layout_options, pkc_layout_options_init
}

handle! {
    /// The description of a cell. Immutable; threads may share it.
    Cell, pkc_cell, pkc_cell_free
}

// SAFETY: the library never changes a cell.
unsafe impl Sync for Cell {}

impl Cell {
    /// By name: "ur5e", "paper", ...; see [`Cell::presets`].
    pub fn new(preset: &str) -> Result<Cell> {
        let preset = c_string("preset", preset.as_bytes())?;
        // SAFETY: the text ends with a zero.
        Cell::make(|out| unsafe { sys::pkc_cell_create(preset.as_ptr(), out) })
    }

    /// Names that [`Cell::new`] knows.
    pub fn presets() -> Vec<String> {
        // SAFETY: any index may be asked for.
        let names = (0..).map(|i| unsafe { sys::pkc_cell_preset(i) });
        // SAFETY: names are static, and end with a zero.
        names
            .take_while(|n| !n.is_null())
            .map(|n| unsafe { text(n) })
            .collect()
    }

    /// From the JSON text of a cell.json.
    pub fn load(json: &str) -> Result<Cell> {
        let text = json.as_ptr().cast::<c_char>();
        // SAFETY: the array has as many elements as are said.
        Cell::make(|out| unsafe { sys::pkc_cell_load(text, json.len(), out) })
    }

    /// The same from a file.
    pub fn load_file(path: impl AsRef<Path>) -> Result<Cell> {
        let path = c_path(path.as_ref())?;
        // SAFETY: the text ends with a zero.
        Cell::make(|out| unsafe { sys::pkc_cell_load_file(path.as_ptr(), out) })
    }

    /// The description as JSON text; loading it gives the same cell.
    pub fn save(&self) -> Result<String> {
        // SAFETY: the handle lives and `fill` gives room for the capacity.
        let bytes = fill(|to: *mut u8, capacity, size| unsafe {
            sys::pkc_cell_save(self.as_ptr(), to.cast::<c_char>(), capacity, size)
        })?;
        String::from_utf8(bytes).map_err(|e| Error::argument(format!("the cell's text: {e}")))
    }

    /// The same into a file.
    pub fn save_file(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = c_path(path.as_ref())?;
        // SAFETY: the handle lives and the text ends with a zero.
        check(unsafe { sys::pkc_cell_save_file(self.as_ptr(), path.as_ptr()) })
    }

    /// Arms, bin, buffers and times.
    pub fn info(&self) -> Result<CellInfo> {
        // SAFETY: the handle lives.
        filled(sys::pkc_cell_info_init, |info| unsafe {
            sys::pkc_cell_get_info(self.as_ptr(), info)
        })
    }

    /// Its name.
    pub fn name(&self) -> Result<String> {
        Ok(field_text(&self.info()?.name))
    }

    /// Whether the arms reach the belt's zones as the scenario says; an error with zone and distance
    /// if not.
    pub fn check(&self, scenario: &Scenario) -> Result<()> {
        // SAFETY: the handle lives.
        check(unsafe { sys::pkc_cell_check(self.as_ptr(), &scenario.raw()) })
    }

    /// Joints at which the arm's tool is at a pose.
    pub fn inverse(&self, arm: i32, pose: &Pose) -> Result<[f64; 6]> {
        let mut joints = [0.0; 6];
        // SAFETY: the handle lives, and the arrays are as long as the header says.
        check(unsafe {
            sys::pkc_cell_inverse(self.as_ptr(), arm, pose.as_ptr(), joints.as_mut_ptr())
        })?;
        Ok(joints)
    }

    /// And back.
    pub fn forward(&self, arm: i32, joints: &[f64; 6]) -> Result<Pose> {
        let mut pose = [0.0; 4];
        // SAFETY: the handle lives, and the arrays are as long as the header says.
        check(unsafe {
            sys::pkc_cell_forward(self.as_ptr(), arm, joints.as_ptr(), pose.as_mut_ptr())
        })?;
        Ok(pose)
    }

    /// A cell with bases, buffers and homes moved for the shortest mean transfer.
    pub fn optimize_layout(
        &self,
        scenario: &Scenario,
        options: &LayoutOptions,
    ) -> Result<(Cell, LayoutInfo)> {
        let mut info = fresh(sys::pkc_layout_info_init)?;
        // SAFETY: the handle lives.
        let cell = Cell::make(|out| unsafe {
            sys::pkc_cell_optimize_layout(
                self.as_ptr(),
                &scenario.raw(),
                &options.raw(),
                &mut info,
                out,
            )
        })?;
        Ok((cell, info))
    }

    /// Names the arms of a step's packs from the belt anew, so that each item goes to the nearest arm
    /// that reaches it. The queue is the one before the step.
    pub fn allocate(&self, queue: &Queue, actions: &mut [Action]) -> Result<()> {
        // SAFETY: the handles live and the array has as many elements as are said.
        check(unsafe {
            sys::pkc_allocate(
                self.as_ptr(),
                queue.as_ptr(),
                actions.as_mut_ptr(),
                actions.len(),
            )
        })
    }
}
