//! Who sees and reaches what, and the conveyor with the arms' buffers.

use crate::error::{c_string, check, field_text};
use crate::handle::{fill, filled, handle};
use crate::options::options;
use crate::{Error, Item, QueueInfo, Queued, Result};
use packcell_sys as sys;
use std::fmt;
use std::str::FromStr;

options! {
    /// How many arms there are and how many items each sees and reaches; `"D-R5A3O1".parse()` makes
    /// one.
    Scenario, pkc_scenario, pkc_scenario_init
}

impl FromStr for Scenario {
    type Err = Error;

    fn from_str(name: &str) -> Result<Scenario> {
        let name = c_string("name", name.as_bytes())?;
        let mut scenario = Scenario::default();
        // SAFETY: the text ends with a zero, and the struct is initialised.
        check(unsafe { sys::pkc_scenario_parse(name.as_ptr(), &mut *scenario) })?;
        Ok(scenario)
    }
}

impl fmt::Display for Scenario {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut name = [0; 32];
        // SAFETY: the array has as many bytes as are said.
        let status = unsafe { sys::pkc_scenario_name(&self.raw(), name.as_mut_ptr(), name.len()) };
        if status == sys::PKC_OK {
            f.write_str(&field_text(&name))
        } else {
            write!(f, "{:?}", self.0)
        }
    }
}

handle! {
    /// The conveyor with its regions, and one buffer an arm.
    Queue, pkc_queue, pkc_queue_free
}

impl Queue {
    /// An empty conveyor.
    pub fn new(scenario: &Scenario) -> Result<Queue> {
        // SAFETY: the struct is of the size that it says.
        Queue::make(|out| unsafe { sys::pkc_queue_create(&scenario.raw(), out) })
    }

    /// A queue of its own with the same contents.
    pub fn try_clone(&self) -> Result<Queue> {
        // SAFETY: the handle lives.
        Queue::make(|out| unsafe { sys::pkc_queue_clone(self.as_ptr(), out) })
    }

    /// An item arrives at the conveyor's end.
    pub fn push(&mut self, item: &Item) -> Result<()> {
        // SAFETY: the handle lives.
        check(unsafe { sys::pkc_queue_push(self.as_ptr(), item) })
    }

    /// An item leaves without being packed.
    pub fn remove(&mut self, id: i32) -> Result<()> {
        // SAFETY: the handle lives.
        check(unsafe { sys::pkc_queue_remove(self.as_ptr(), id) })
    }

    /// Several items leave at once, all or none.
    pub fn remove_items(&mut self, ids: &[i32]) -> Result<()> {
        // SAFETY: the handle lives and the array has as many elements as are said.
        check(unsafe { sys::pkc_queue_remove_items(self.as_ptr(), ids.as_ptr(), ids.len()) })
    }

    /// An item is put into an arm's buffer from without.
    pub fn put_in_buffer(&mut self, item: &Item, arm: i32) -> Result<()> {
        // SAFETY: the handle lives.
        check(unsafe { sys::pkc_queue_put_in_buffer(self.as_ptr(), item, arm) })
    }

    /// Arranges the regions anew, as if so many items had stayed in arm 0's.
    pub fn set_alpha_left(&mut self, alpha_left: i32) -> Result<()> {
        // SAFETY: the handle lives.
        check(unsafe { sys::pkc_queue_set_alpha_left(self.as_ptr(), alpha_left) })
    }

    /// What the queue was made for.
    pub fn scenario(&self) -> Result<Scenario> {
        let mut scenario = Scenario::default();
        // SAFETY: the handle lives.
        check(unsafe { sys::pkc_queue_get_scenario(self.as_ptr(), &mut *scenario) })?;
        Ok(scenario)
    }

    /// Counts of items and regions.
    pub fn info(&self) -> Result<QueueInfo> {
        // SAFETY: the handle lives.
        filled(sys::pkc_queue_info_init, |info| unsafe {
            sys::pkc_queue_get_info(self.as_ptr(), info)
        })
    }

    /// The conveyor's items in arrival order.
    pub fn belt(&self) -> Result<Vec<Queued>> {
        // SAFETY: the handle lives and `fill` gives room for the capacity.
        fill(|to, capacity, count| unsafe {
            sys::pkc_queue_belt(self.as_ptr(), to, capacity, count)
        })
    }

    /// The buffered items in the order they were unpacked.
    pub fn buffer(&self) -> Result<Vec<Queued>> {
        // SAFETY: the handle lives and `fill` gives room for the capacity.
        fill(|to, capacity, count| unsafe {
            sys::pkc_queue_buffer(self.as_ptr(), to, capacity, count)
        })
    }
}
