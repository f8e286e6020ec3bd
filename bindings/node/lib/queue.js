// Who sees and reaches what, the conveyor with the arms' buffers, and steps and snapshots of both.
'use strict';

const raw = require('../raw.js');
const check = require('./check.js');
const { Handle, adopt } = require('./handle.js');
const { Bin } = require('./bin.js');

const { ok, integer, fill } = check;

// Four whole numbers; by name, "D-R5A3O1", or by field.
class Scenario {
  constructor(fields = {}) {
    let all;
    if (typeof fields === 'string') {
      all = check.options('pkc_scenario');
      ok(raw.pkc_scenario_parse(check.string(fields, 'name'), all));
    } else {
      if (fields === null || typeof fields !== 'object') {
        throw check.wrong('scenario', 'a name or an object');
      }
      all = check.options('pkc_scenario', { ...fields }, 'scenario');
    }
    Object.assign(this, check.tidy(all));
  }

  toString() {
    const name = Buffer.alloc(32);
    ok(raw.pkc_scenario_name(Scenario.raw(this), name, name.length));
    return name.toString('utf8', 0, name.indexOf(0));
  }

  // The struct of a Scenario or of a name.
  static raw(scenario) {
    if (typeof scenario === 'string') scenario = new Scenario(scenario);
    if (scenario === null || scenario === undefined) return null;
    if (!(scenario instanceof Scenario)) throw check.wrong('scenario', 'a Scenario or a name');
    return check.options('pkc_scenario', { ...scenario }, 'scenario');
  }
}

class Queue extends Handle {
  constructor(scenario) {
    const struct = Scenario.raw(scenario);
    super(Queue, raw.pkc_queue_free, (out) => raw.pkc_queue_create(struct, out));
  }

  clone() {
    const queue = Queue.pointer(this, 'queue');
    return adopt(Queue, raw.pkc_queue_free, (out) => raw.pkc_queue_clone(queue, out));
  }

  push(item) {
    const given = check.item(item);
    ok(raw.pkc_queue_push(Queue.pointer(this, 'queue'), given));
  }

  remove(id) {
    ok(raw.pkc_queue_remove(Queue.pointer(this, 'queue'), integer(id, 'id')));
  }

  removeItems(ids) {
    const all = check.integers(ids, 'ids');
    ok(raw.pkc_queue_remove_items(Queue.pointer(this, 'queue'), all, all.length));
  }

  putInBuffer(item, arm) {
    const args = [check.item(item), integer(arm, 'arm')];
    ok(raw.pkc_queue_put_in_buffer(Queue.pointer(this, 'queue'), ...args));
  }

  setAlphaLeft(alphaLeft) {
    ok(raw.pkc_queue_set_alpha_left(Queue.pointer(this, 'queue'), integer(alphaLeft, 'alphaLeft')));
  }

  scenario() {
    const queue = Queue.pointer(this, 'queue');
    return new Scenario(
      check.info('pkc_scenario', (scenario) => raw.pkc_queue_get_scenario(queue, scenario)));
  }

  info() {
    const queue = Queue.pointer(this, 'queue');
    return check.info('pkc_queue_info', (info) => raw.pkc_queue_get_info(queue, info));
  }

  belt() {
    const queue = Queue.pointer(this, 'queue');
    return fill(check.objects, (...to) => raw.pkc_queue_belt(queue, ...to));
  }

  buffer() {
    const queue = Queue.pointer(this, 'queue');
    return fill(check.objects, (...to) => raw.pkc_queue_buffer(queue, ...to));
  }
}

// Carries out one step's actions, all or nothing.
function apply(bin, queue, actions) {
  const all = check.actions(actions);
  ok(raw.pkc_step_apply(Bin.pointer(bin, 'bin'), Queue.pointer(queue, 'queue'), all, all.length));
}

function planHash(actions) {
  const all = check.actions(actions);
  const hash = [0];
  ok(raw.pkc_plan_hash(all, all.length, hash));
  return BigInt(hash[0]);
}

function saveSnapshot(bin, queue) {
  const handles = [Bin.pointer(bin, 'bin'), Queue.pointer(queue, 'queue')];
  return fill((n) => Buffer.alloc(n), (...to) => raw.pkc_snapshot_save(...handles, ...to));
}

function loadSnapshot(snapshot) {
  const all = check.bytes(snapshot, 'snapshot');
  const queues = [null];
  const bin = adopt(Bin, raw.pkc_bin_free,
    (out) => raw.pkc_snapshot_load(...all, out, queues));
  const queue = adopt(Queue, raw.pkc_queue_free, (out) => {
    [out[0]] = queues;
    return raw.PKC_OK;
  });
  return { bin, queue };
}

module.exports = { Scenario, Queue, apply, planHash, saveSnapshot, loadSnapshot };
