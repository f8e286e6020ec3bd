// What the arms do and when, and what becomes of it in a simulation.
'use strict';

const raw = require('../raw.js');
const check = require('./check.js');
const { Handle, adopt } = require('./handle.js');
const { Bin } = require('./bin.js');
const { Cell } = require('./cell.js');
const { Queue, Scenario } = require('./queue.js');

const { ok, integer, number } = check;

class Schedule extends Handle {
  // `mode` is PKC_MODE_*.
  constructor(cell, scenario, mode = raw.PKC_MODE_COORDINATED) {
    const args = [Scenario.raw(scenario), integer(mode, 'mode')];
    const handle = Cell.pointer(cell, 'cell');
    super(Schedule, raw.pkc_schedule_free,
      (out) => raw.pkc_schedule_create(handle, ...args, out));
  }

  // `bin` and `queue` are those before the step.
  addStep(bin, queue, actions) {
    const all = check.actions(actions);
    ok(raw.pkc_schedule_add_step(Schedule.pointer(this, 'schedule'), Bin.pointer(bin, 'bin'),
      Queue.pointer(queue, 'queue'), all, all.length));
  }

  putAside(item, time) {
    const schedule = Schedule.pointer(this, 'schedule');
    ok(raw.pkc_schedule_put_aside(schedule, integer(item, 'item'), number(time, 'time')));
  }

  info() {
    const schedule = Schedule.pointer(this, 'schedule');
    return check.info('pkc_schedule_info', (info) => raw.pkc_schedule_get_info(schedule, info));
  }

  sample(arm, time) {
    const sample = {};
    const schedule = Schedule.pointer(this, 'schedule');
    ok(raw.pkc_schedule_sample(schedule, integer(arm, 'arm'), number(time, 'time'), sample));
    return sample;
  }

  simulate(options) {
    const all = check.options('pkc_simulation_options', options, 'options');
    const schedule = Schedule.pointer(this, 'schedule');
    return adopt(Simulation, raw.pkc_simulation_free,
      (out) => raw.pkc_simulate(schedule, all, out));
  }

  // `kind` is PKC_TRACE_*; `period`, in seconds, is that of the CSV files.
  writeTrace(kind, path, { simulation, period = 0.01 } = {}) {
    const schedule = Schedule.pointer(this, 'schedule');
    ok(raw.pkc_trace_write_file(schedule, Simulation.pointer(simulation, 'simulation'),
      integer(kind, 'kind'), number(period, 'period'), check.string(path, 'path')));
  }
}

// A run of a schedule; Schedule.simulate makes one.
class Simulation extends Handle {
  constructor() {
    throw new TypeError('Simulation: made by Schedule.simulate');
  }

  info() {
    const simulation = Simulation.pointer(this, 'simulation');
    return check.info('pkc_simulation_info',
      (info) => raw.pkc_simulation_get_info(simulation, info));
  }

  places() {
    const simulation = Simulation.pointer(this, 'simulation');
    return check.fill(check.objects, (...to) => raw.pkc_simulation_places(simulation, ...to));
  }
}

module.exports = { Schedule, Simulation };
