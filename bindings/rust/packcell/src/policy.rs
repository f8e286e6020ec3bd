//! The low level: where an item goes.

use crate::error::{c_string, check, field_text, text};
use crate::handle::{c_path, fill, filled, handle, zeros};
use crate::options::options;
use crate::{Bin, Error, PolicyInfo, Result};
use packcell_sys as sys;
use std::os::raw::c_void;
use std::path::Path;
use std::ptr;

handle! {
    /// Gives an item its position. Immutable; threads may share it.
    Policy, pkc_policy, pkc_policy_free
}

// SAFETY: the library never changes a policy.
unsafe impl Sync for Policy {}

/// Pairs of one call, as the library has it.
const MOST_PAIRS: usize = 1 << 20;

/// What actor and critic say about an item; by position, the last for "no position".
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Evaluation {
    /// W*H + 1.
    pub logits: Vec<f32>,
    /// W*H + 1, 0 where the item does not fit.
    pub probabilities: Vec<f32>,
    /// Of the bin.
    pub value: f32,
}

/// The same for many pairs of a bin and an item.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Batch {
    /// One a pair.
    pub positions: Vec<i32>,
    /// W*H + 1 a pair.
    pub probabilities: Vec<f32>,
    /// One a pair.
    pub values: Vec<f32>,
}

options! {
    /// How a training goes, and what [`Policy::measure`] plays: bins, items and rotation. Trainings
    /// themselves are for [`crate::sys`].
    TrainerOptions, pkc_trainer_options, pkc_trainer_options_init
}

/// What [`Policy::measure`] finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Mean utilisation, 0..1.
    pub mean: f64,
    /// Half the width of its 95 % interval.
    pub half_width: f64,
}

impl Policy {
    /// By name: "default", "contact", ...; see [`Policy::builtins`].
    pub fn new(name: &str) -> Result<Policy> {
        let name = c_string("name", name.as_bytes())?;
        // SAFETY: the text ends with a zero.
        Policy::make(|out| unsafe { sys::pkc_policy_create(name.as_ptr(), out) })
    }

    /// Names that [`Policy::new`] knows.
    pub fn builtins() -> Vec<String> {
        // SAFETY: any index may be asked for.
        let names = (0..).map(|i| unsafe { sys::pkc_policy_builtin(i) });
        // SAFETY: names are static, and end with a zero.
        names
            .take_while(|n| !n.is_null())
            .map(|n| unsafe { text(n) })
            .collect()
    }

    /// A learned policy from a weight blob.
    pub fn load(bytes: &[u8]) -> Result<Policy> {
        let data = bytes.as_ptr().cast::<c_void>();
        // SAFETY: the array has as many elements as are said.
        Policy::make(|out| unsafe { sys::pkc_policy_load(data, bytes.len(), out) })
    }

    /// The same from a file.
    pub fn load_file(path: impl AsRef<Path>) -> Result<Policy> {
        let path = c_path(path.as_ref())?;
        // SAFETY: the text ends with a zero.
        Policy::make(|out| unsafe { sys::pkc_policy_load_file(path.as_ptr(), out) })
    }

    /// The weight blob; [`crate::Status::Unsupported`] for a heuristic.
    pub fn save(&self) -> Result<Vec<u8>> {
        // SAFETY: the handle lives and `fill` gives room for the capacity.
        fill(|to: *mut u8, capacity, size| unsafe {
            sys::pkc_policy_save(self.as_ptr(), to.cast::<c_void>(), capacity, size)
        })
    }

    /// The same into a file, all or nothing.
    pub fn save_file(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = c_path(path.as_ref())?;
        // SAFETY: the handle lives and the text ends with a zero.
        check(unsafe { sys::pkc_policy_save_file(self.as_ptr(), path.as_ptr()) })
    }

    /// Its name.
    pub fn name(&self) -> String {
        // SAFETY: the handle lives.
        unsafe { text(sys::pkc_policy_name(self.as_ptr())) }
    }

    /// Where it comes from.
    pub fn info(&self) -> Result<PolicyInfo> {
        // SAFETY: the handle lives.
        filled(sys::pkc_policy_info_init, |info| unsafe {
            sys::pkc_policy_get_info(self.as_ptr(), info)
        })
    }

    /// How it learned: "a3c", "td-afterstate"; "" for a heuristic.
    pub fn learner(&self) -> Result<String> {
        Ok(field_text(&self.info()?.learner))
    }

    /// The position x + y*W of an item that covers `w` x `h` cells; W*H is "no position".
    pub fn select(&self, bin: &Bin, w: i32, h: i32) -> Result<i32> {
        let mut position = 0;
        // SAFETY: the handles live.
        check(unsafe { sys::pkc_policy_select(self.as_ptr(), bin.as_ptr(), w, h, &mut position) })?;
        Ok(position)
    }

    /// What a learned policy says about such an item.
    pub fn evaluate(&self, bin: &Bin, w: i32, h: i32) -> Result<Evaluation> {
        let positions = positions(bin)?;
        let mut out = Evaluation {
            logits: vec![0.0; positions],
            probabilities: vec![0.0; positions],
            value: 0.0,
        };
        let mut count = 0;
        // SAFETY: the handles live, and both arrays have so many positions.
        check(unsafe {
            sys::pkc_policy_evaluate(
                self.as_ptr(),
                bin.as_ptr(),
                w,
                h,
                out.logits.as_mut_ptr(),
                out.probabilities.as_mut_ptr(),
                positions,
                &mut count,
                &mut out.value,
            )
        })?;
        Ok(out)
    }

    /// [`Policy::select`] for many bins of the same sides, each with an item's w and h; faster than
    /// one by one.
    pub fn select_batch(&self, pairs: &[(&Bin, i32, i32)]) -> Result<Vec<i32>> {
        let mut positions = vec![0; pairs.len()];
        // SAFETY: there is one position a pair.
        unsafe {
            self.batch(
                pairs,
                positions.as_mut_ptr(),
                ptr::null_mut(),
                ptr::null_mut(),
            )
        }?;
        Ok(positions)
    }

    /// The same with probabilities and values, of a learned policy.
    pub fn evaluate_batch(&self, pairs: &[(&Bin, i32, i32)]) -> Result<Batch> {
        let count = pairs.len();
        // Room is made before the library can refuse.
        let each = match pairs.first() {
            Some((bin, _, _)) if count <= MOST_PAIRS => positions(bin)?,
            Some(_) => {
                return Err(Error::argument(format!(
                    "count {count}: must be 1..{MOST_PAIRS}"
                )))
            }
            None => 0,
        };
        let mut out = Batch {
            positions: zeros(count)?,
            probabilities: zeros(count * each)?,
            values: zeros(count)?,
        };
        // SAFETY: the sizes are those of the header; all bins must have the sides of the first,
        // which the library checks before it stores anything.
        unsafe {
            self.batch(
                pairs,
                out.positions.as_mut_ptr(),
                out.probabilities.as_mut_ptr(),
                out.values.as_mut_ptr(),
            )
        }?;
        Ok(out)
    }

    /// Packs so many bins, 1..2^32, of a held-out stream; bins, items and rotation are those of the
    /// options.
    pub fn measure(&self, options: &TrainerOptions, seed: u64, bins: u64) -> Result<Measurement> {
        let (mut mean, mut half_width) = (0.0, 0.0);
        // SAFETY: the handle lives.
        check(unsafe {
            sys::pkc_policy_measure(
                self.as_ptr(),
                &options.raw(),
                seed,
                bins,
                &mut mean,
                &mut half_width,
            )
        })?;
        Ok(Measurement { mean, half_width })
    }

    /// # Safety
    /// The outputs are NULL, or have room for one position a pair, W*H + 1 probabilities a pair and
    /// one value a pair; W and H are those of the first bin.
    unsafe fn batch(
        &self,
        pairs: &[(&Bin, i32, i32)],
        positions: *mut i32,
        probabilities: *mut f32,
        values: *mut f32,
    ) -> Result<()> {
        let bins: Vec<*const sys::pkc_bin> =
            pairs.iter().map(|p| p.0.as_ptr() as *const _).collect();
        let sizes: Vec<i32> = pairs.iter().flat_map(|p| [p.1, p.2]).collect();
        // SAFETY: the handles live, and the inputs are as long as is said; the outputs are the
        // caller's promise.
        check(unsafe {
            sys::pkc_policy_evaluate_batch(
                self.as_ptr(),
                bins.as_ptr(),
                sizes.as_ptr(),
                pairs.len(),
                positions,
                probabilities,
                values,
            )
        })
    }
}

/// W*H + 1.
fn positions(bin: &Bin) -> Result<usize> {
    let info = bin.info()?;
    Ok((info.w * info.h + 1) as usize)
}
