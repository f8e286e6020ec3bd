// A planned step is scheduled, simulated and written down.
'use strict';

const test = require('node:test');
const assert = require('node:assert/strict');
const fs = require('node:fs');
const os = require('node:os');
const path = require('node:path');
const packcell = require(process.env.PACKCELL_NODE);

// A library built without the cell says so.
function cellOf(preset) {
  try {
    return new packcell.Cell(preset);
  } catch (e) {
    assert.equal(e.code, 'PKC_E_UNSUPPORTED');
    return null;
  }
}

test('a step goes through the cell', () => {
  const cell = cellOf('ur5e');
  if (cell === null) return;
  assert.ok(packcell.Cell.presets().includes('ur5e'));
  const info = cell.info();
  assert.equal(info.name, 'ur5e');
  cell.check('D-R5A3O1');
  const again = packcell.Cell.load(cell.save());
  assert.deepEqual(again.info(), info);

  const bin = new packcell.Bin(info.bin_w, info.bin_h);
  const queue = new packcell.Queue('D-R5A3O1');
  for (let id = 0; id < 4; ++id) queue.push({ id, w: 2, h: 1 });
  const schedule = new packcell.Schedule(cell, 'D-R5A3O1');
  cell.close(); // the schedule keeps what it needs
  const plan = new packcell.Planner().plan(bin, queue, { nodes: 1000 });
  const actions = again.allocate(queue, plan.actions);
  assert.equal(actions.length, plan.actions.length);
  schedule.addStep(bin, queue, actions);
  packcell.apply(bin, queue, actions);

  const times = schedule.info();
  assert.ok(times.steps === 1 && times.makespan > 0 && typeof times.hash === 'bigint');
  const sample = schedule.sample(0, times.makespan / 2);
  const joints = again.inverse(0, sample.tool);
  assert.ok(Math.abs(again.forward(0, joints)[0] - sample.tool[0]) < 1e-6);

  const simulation = schedule.simulate({ seed: 2 });
  assert.equal(simulation.info().jams, 0);
  assert.equal(simulation.places().length, bin.items().length);
  assert.equal(schedule.simulate({ seed: 2 }).info().hash, simulation.info().hash);

  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'packcell-'));
  try {
    const file = path.join(folder, 'gantt.svg');
    schedule.writeTrace(packcell.PKC_TRACE_GANTT, file, { simulation });
    assert.match(fs.readFileSync(file, 'utf8'), /<svg/);
  } finally {
    fs.rmSync(folder, { recursive: true });
  }

  assert.throws(() => schedule.sample(0, times.makespan + 1), { code: 'PKC_E_ARGUMENT' });
  assert.throws(() => schedule.sample(0, NaN), { code: 'PKC_E_ARGUMENT' });
  assert.throws(() => schedule.putAside(99, 0), { code: 'PKC_E_STATE' });
  assert.throws(() => again.inverse(0, [1, 2]), { message: 'pose has 2 elements: must have 4' });
  assert.throws(() => again.forward(0, joints.subarray(1)), RangeError);
  assert.throws(() => again.forward(0, 'abcdef'), TypeError);
});

test('a layout is never worse', () => {
  const cell = cellOf('scara');
  if (cell === null) return;
  const moved = cell.optimizeLayout('D-R5A3O1', { evaluations: 20 });
  assert.ok(moved.info.after <= moved.info.before);
  moved.cell.check('D-R5A3O1');
});

test('a simulation comes from a schedule alone', () => {
  assert.throws(() => new packcell.Simulation(), TypeError);
});
