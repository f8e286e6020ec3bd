// The cell: arms, belt, bin and buffers, in metres and radians.
'use strict';

const raw = require('../raw.js');
const check = require('./check.js');
const { Handle, adopt } = require('./handle.js');
const { Queue, Scenario } = require('./queue.js');

const { ok, integer } = check;

class Cell extends Handle {
  constructor(preset) {
    const text = check.string(preset, 'preset');
    super(Cell, raw.pkc_cell_free, (out) => raw.pkc_cell_create(text, out));
  }

  static presets() {
    return check.names(raw.pkc_cell_preset);
  }

  // From the JSON text of a cell.json.
  static load(json) {
    if (typeof json !== 'string') throw check.wrong('json', 'a string');
    const text = check.bytes(Buffer.from(json), 'json');
    return adopt(Cell, raw.pkc_cell_free, (out) => raw.pkc_cell_load(...text, out));
  }

  static loadFile(path) {
    const text = check.string(path, 'path');
    return adopt(Cell, raw.pkc_cell_free, (out) => raw.pkc_cell_load_file(text, out));
  }

  save() {
    const cell = Cell.pointer(this, 'cell');
    return check.fill((n) => Buffer.alloc(n), (...to) => raw.pkc_cell_save(cell, ...to)).toString();
  }

  saveFile(path) {
    ok(raw.pkc_cell_save_file(Cell.pointer(this, 'cell'), check.string(path, 'path')));
  }

  info() {
    const cell = Cell.pointer(this, 'cell');
    return check.info('pkc_cell_info', (info) => raw.pkc_cell_get_info(cell, info));
  }

  // Throws if the arms do not reach the belt's zones as the scenario says.
  check(scenario) {
    const struct = Scenario.raw(scenario);
    ok(raw.pkc_cell_check(Cell.pointer(this, 'cell'), struct));
  }

  inverse(arm, pose) {
    const args = [integer(arm, 'arm'), check.numbers(pose, 'pose', 4)];
    const joints = new Float64Array(raw.PKC_MAX_JOINTS);
    ok(raw.pkc_cell_inverse(Cell.pointer(this, 'cell'), ...args, joints));
    return joints;
  }

  forward(arm, joints) {
    const args = [integer(arm, 'arm'), check.numbers(joints, 'joints', raw.PKC_MAX_JOINTS)];
    const pose = new Float64Array(4);
    ok(raw.pkc_cell_forward(Cell.pointer(this, 'cell'), ...args, pose));
    return pose;
  }

  // A cell of its own, with bases, buffers and homes moved for the shortest mean transfer.
  optimizeLayout(scenario, options) {
    const args = [Scenario.raw(scenario),
      check.options('pkc_layout_options', options, 'options')];
    const info = check.options('pkc_layout_info');
    const cell = Cell.pointer(this, 'cell');
    const moved = adopt(Cell, raw.pkc_cell_free,
      (out) => raw.pkc_cell_optimize_layout(cell, ...args, info, out));
    return { cell: moved, info: check.tidy(info) };
  }

  // The actions with the arms of packs from the belt named anew.
  allocate(queue, actions) {
    const all = check.actions(actions);
    const cell = Cell.pointer(this, 'cell');
    ok(raw.pkc_allocate(cell, Queue.pointer(queue, 'queue'), all, all.length));
    return all;
  }
}

module.exports = { Cell };
