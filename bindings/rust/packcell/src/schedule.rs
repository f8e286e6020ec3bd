//! What the arms do and when, and what becomes of it in a simulation.

use crate::error::check;
use crate::handle::{c_path, fill, filled, handle};
use crate::options::options;
use crate::{
    Action, ArmSample, Bin, Cell, Place, Queue, Result, Scenario, ScheduleInfo, SimulationInfo,
};
use packcell_sys as sys;
use std::path::Path;
use std::ptr;

/// How two arms are coordinated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Mode {
    /// The paper's: atomic actions in common slots, one step a time.
    SyncPaper = sys::PKC_MODE_SYNC_PAPER as isize,
    /// Asynchronous; one arm at a time over the bin.
    ZoneMutex = sys::PKC_MODE_ZONE_MUTEX as isize,
    /// Asynchronous; kept apart by their footprints alone.
    Coordinated = sys::PKC_MODE_COORDINATED as isize,
}

/// What [`Schedule::write_trace`] writes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Trace {
    /// Chrome trace events (JSON).
    Chrome,
    /// CSV: time, joints, tools and clearance, every so many seconds.
    Timeline(f64),
    /// CSV: set-points of arm 0 or 1, every so many seconds.
    Joints(i32, f64),
    /// SVG.
    Gantt,
    /// One HTML page.
    Replay,
}

handle! {
    /// What the arms, the belt and the planner do and when.
    Schedule, pkc_schedule, pkc_schedule_free
}

impl Schedule {
    /// An empty schedule; it keeps what it needs of the cell.
    pub fn new(cell: &Cell, scenario: &Scenario, mode: Mode) -> Result<Schedule> {
        // SAFETY: the handle lives.
        Schedule::make(|out| unsafe {
            sys::pkc_schedule_create(cell.as_ptr(), &scenario.raw(), mode as i32, out)
        })
    }

    /// Adds the work of a step that was planned for bin and queue: those before the step.
    pub fn add_step(&mut self, bin: &Bin, queue: &Queue, actions: &[Action]) -> Result<()> {
        // SAFETY: the handles live and the array has as many elements as are said.
        check(unsafe {
            sys::pkc_schedule_add_step(
                self.as_ptr(),
                bin.as_ptr(),
                queue.as_ptr(),
                actions.as_ptr(),
                actions.len(),
            )
        })
    }

    /// The item let go over the bin at `time` did not fit: its arm takes it to its buffer.
    pub fn put_aside(&mut self, item: i32, time: f64) -> Result<()> {
        // SAFETY: the handle lives.
        check(unsafe { sys::pkc_schedule_put_aside(self.as_ptr(), item, time) })
    }

    /// Makespan, waits and hash.
    pub fn info(&self) -> Result<ScheduleInfo> {
        // SAFETY: the handle lives.
        filled(sys::pkc_schedule_info_init, |info| unsafe {
            sys::pkc_schedule_get_info(self.as_ptr(), info)
        })
    }

    /// An arm at a time, 0..makespan.
    pub fn sample(&self, arm: i32, time: f64) -> Result<ArmSample> {
        let mut sample = ArmSample::default();
        // SAFETY: the handle lives.
        check(unsafe { sys::pkc_schedule_sample(self.as_ptr(), arm, time, &mut sample) })?;
        Ok(sample)
    }

    /// Runs what the schedule has so far.
    pub fn simulate(&self, options: &SimulationOptions) -> Result<Simulation> {
        // SAFETY: the handle lives.
        Simulation::make(|out| unsafe { sys::pkc_simulate(self.as_ptr(), &options.raw(), out) })
    }

    /// Writes the schedule, all or nothing; a simulation adds the poses of its run.
    pub fn write_trace(
        &self,
        simulation: Option<&Simulation>,
        trace: Trace,
        path: impl AsRef<Path>,
    ) -> Result<()> {
        const ANY: f64 = 0.01; // a legal period, of which these kinds make nothing
        let (kind, period) = match trace {
            Trace::Chrome => (sys::PKC_TRACE_CHROME, ANY),
            Trace::Timeline(period) => (sys::PKC_TRACE_TIMELINE, period),
            Trace::Joints(0, period) => (sys::PKC_TRACE_JOINTS_0, period),
            Trace::Joints(1, period) => (sys::PKC_TRACE_JOINTS_1, period),
            Trace::Joints(arm, _) => {
                return Err(crate::Error::argument(format!("arm {arm}: must be 0..1")))
            }
            Trace::Gantt => (sys::PKC_TRACE_GANTT, ANY),
            Trace::Replay => (sys::PKC_TRACE_REPLAY, ANY),
        };
        let path = c_path(path.as_ref())?;
        let simulation = simulation.map_or(ptr::null_mut(), Simulation::as_ptr);
        // SAFETY: the handle lives and the text ends with a zero.
        check(unsafe {
            sys::pkc_trace_write_file(self.as_ptr(), simulation, kind, period, path.as_ptr())
        })
    }
}

options! {
    /// How a schedule is run.
    SimulationOptions, pkc_simulation_options, pkc_simulation_options_init
}

handle! {
    /// A run of a schedule.
    Simulation, pkc_simulation, pkc_simulation_free
}

impl Simulation {
    /// Counts, worst errors and hash.
    pub fn info(&self) -> Result<SimulationInfo> {
        // SAFETY: the handle lives.
        filled(sys::pkc_simulation_info_init, |info| unsafe {
            sys::pkc_simulation_get_info(self.as_ptr(), info)
        })
    }

    /// What became of each item, in the order of their times.
    pub fn places(&self) -> Result<Vec<Place>> {
        // SAFETY: the handle lives and `fill` gives room for the capacity.
        fill(|to, capacity, count| unsafe {
            sys::pkc_simulation_places(self.as_ptr(), to, capacity, count)
        })
    }
}
