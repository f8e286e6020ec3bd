//! Items to plan with.

use crate::error::{c_string, check};
use crate::handle::{handle, zeros};
use crate::options::options;
use crate::{Error, Item, Result};
use packcell_sys as sys;

pub use sys::{PKC_GENERATE_FULL as GENERATE_FULL, PKC_GENERATE_RANDOM as GENERATE_RANDOM};

/// Items of one call, as the library has it; room for them is made before it can refuse.
const MOST: usize = 1 << 24;

options! {
    /// What items are like; equal options give equal items on every machine.
    GeneratorOptions, pkc_generator_options, pkc_generator_options_init
}

impl GeneratorOptions {
    /// Sets mean and sigma: "text" or "table".
    pub fn preset(&mut self, preset: &str) -> Result<()> {
        let preset = c_string("preset", preset.as_bytes())?;
        let mut raw = self.raw();
        // SAFETY: the struct is initialised, and the text ends with a zero.
        check(unsafe { sys::pkc_generator_preset(&mut raw, preset.as_ptr()) })?;
        **self = raw;
        Ok(())
    }
}

handle! {
    /// A stream of items, or of sets of items that fill a bin.
    Generator, pkc_generator, pkc_generator_free
}

impl Generator {
    /// Begins a stream.
    pub fn new(options: &GeneratorOptions) -> Result<Generator> {
        // SAFETY: the struct is initialised.
        Generator::make(|out| unsafe { sys::pkc_generator_create(&options.raw(), out) })
    }

    /// [`GENERATE_RANDOM`]: fills the slice with the stream's next items. [`GENERATE_FULL`]: the next
    /// set, for which W*H elements always suffice. Returns how many items there are.
    pub fn fill(&mut self, items: &mut [Item]) -> Result<usize> {
        let mut count = 0;
        // SAFETY: the pointer is good for as many items as are said.
        check(unsafe {
            sys::pkc_generator_next(self.as_ptr(), items.as_mut_ptr(), items.len(), &mut count)
        })?;
        Ok(count)
    }

    /// The same as a vector, of at most `most` items, 0..2^24.
    pub fn items(&mut self, most: usize) -> Result<Vec<Item>> {
        if most > MOST {
            return Err(Error::argument(format!("most {most}: must be 0..{MOST}")));
        }
        let mut items = zeros(most)?;
        let count = self.fill(&mut items)?;
        items.truncate(count);
        Ok(items)
    }
}
