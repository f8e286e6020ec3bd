// Bins, queues, policies, planners and the exact packer do what the header says.
'use strict';

const test = require('node:test');
const assert = require('node:assert/strict');
const packcell = require(process.env.PACKCELL_NODE);

function queueOf(scenario, sizes) {
  const queue = new packcell.Queue(scenario);
  sizes.forEach(([w, h], id) => queue.push({ id, w, h }));
  return queue;
}

test('the library is the one of the header', () => assert.equal(packcell.version(), '0.1.0'));

test('a bin holds what is packed', () => {
  const bin = new packcell.Bin(10, 10);
  bin.block(9, 9, 1, 1);
  bin.pack({ id: 7, w: 2, h: 3 }, 0, 0, 1);
  const { hash, ...info } = bin.info();
  assert.deepEqual(info, { w: 10, h: 10, items: 1, occupied_cells: 7, fixed_cells: 1 });
  assert.equal(typeof hash, 'bigint');
  const cells = bin.cells();
  assert.ok(cells instanceof Int32Array);
  assert.deepEqual([cells[0], cells[3], cells[99]],
    [7, packcell.PKC_CELL_FREE, packcell.PKC_CELL_FIXED]);
  assert.equal(bin.feasible(10, 1).length, 101);
  assert.equal(bin.contact(3, 0, 1, 1), 2);

  const copy = bin.clone();
  const placement = bin.unpack(7);
  assert.deepEqual(placement, { item: { id: 7, w: 2, h: 3, flags: 0 }, x: 0, y: 0, rot: 1 });
  assert.deepEqual(bin.items(), []);
  assert.deepEqual(copy.items(), [placement]);
  bin.clear();
  assert.equal(bin.info().occupied_cells, 1);
});

test('a scenario has a name', () => {
  const scenario = new packcell.Scenario('D-R5A3O1');
  assert.deepEqual({ ...scenario }, { robots: 2, recognized: 5, accessible: 3, overlap: 1 });
  assert.equal(String(scenario), 'D-R5A3O1');
  assert.equal(String(new packcell.Scenario({ recognized: 4, accessible: 2 })), 'S-R4A2');
});

test('a queue knows what is in reach', () => {
  const queue = queueOf('D-R5A3O1', Array(8).fill([1, 1]));
  queue.putInBuffer({ id: 20, w: 2, h: 2 }, 1);
  assert.deepEqual([queue.info().belt, queue.info().buffered], [8, 1]);
  assert.equal(queue.belt().filter((q) => q.recognized).length, 5);
  assert.equal(queue.buffer()[0].item.id, 20);
  queue.remove(0);
  queue.removeItems([1, 2]);
  queue.removeItems([]);
  queue.setAlphaLeft(0);
  assert.equal(queue.clone().info().belt, 5);
  assert.equal(String(queue.scenario()), 'D-R5A3O1');
});

test('a snapshot gives the same again', () => {
  const bin = new packcell.Bin(10, 10);
  bin.pack({ id: 7, w: 2, h: 3 }, 0, 0);
  const queue = queueOf('S-R3A2', [[1, 2], [2, 2]]);
  const again = packcell.loadSnapshot(packcell.saveSnapshot(bin, queue));
  assert.deepEqual(again.bin.info(), bin.info());
  assert.deepEqual(again.queue.belt(), queue.belt());
});

test('policies choose, and the learned ones evaluate', () => {
  assert.ok(packcell.Policy.builtins().includes('contact'));
  const contact = new packcell.Policy('contact');
  assert.equal(contact.name, 'contact');
  assert.equal(contact.info().learner, '');
  const [one, two] = [new packcell.Bin(10, 10), new packcell.Bin(10, 10)];
  const chosen = contact.select(one, 2, 3);
  assert.deepEqual([...contact.selectBatch([[one, 2, 3], [two, 2, 3]])], [chosen, chosen]);

  const learned = new packcell.Policy();
  const again = packcell.Policy.load(learned.save());
  assert.deepEqual(again.info(), { ...learned.info() });
  let said;
  try {
    said = learned.evaluate(one, 2, 3);
  } catch (e) {
    assert.equal(e.code, 'PKC_E_UNSUPPORTED');
    return;
  }
  assert.deepEqual([said.logits.length, said.probabilities.length], [101, 101]);
  const batch = learned.evaluateBatch([[one, 2, 3]]);
  assert.equal(batch.probabilities.length, 101);
  assert.equal(batch.positions[0], learned.select(one, 2, 3));
});

const kSizes = [[2, 1], [4, 3], [2, 2], [4, 4], [2, 4]];

test('slices and another thread give the plan that one call gives', async () => {
  const planner = new packcell.Planner(
    { repack: packcell.PKC_REPACK_FULL }, new packcell.Policy('contact'));
  const [bin, queue] = [new packcell.Bin(10, 10), queueOf('D-R5A3O1', kSizes)];
  const budget = { nodes: 5000n };
  const whole = planner.plan(bin, queue, budget);
  planner.begin(bin, queue, budget);
  while (!planner.step(100));
  assert.deepEqual(planner.result().actions, whole.actions);
  const promise = planner.planAsync(bin, queue, budget);
  bin.clear();
  queue.close();
  assert.deepEqual((await promise).actions, whole.actions);
  assert.equal(packcell.planHash(whole.actions), whole.info.hash);
  planner.close();
});

test('a plan on another thread keeps the planner, and can be cancelled', async () => {
  const planner = new packcell.Planner();
  const sizes = Array(7).fill([[7, 5], [3, 9], [8, 2], [5, 4], [6, 6], [2, 11]]).flat();
  const [bin, queue] = [new packcell.Bin(60, 60), queueOf('D-R40A10O2', sizes)];
  const promise = planner.planAsync(bin, queue, { nodes: 0, milliseconds: 20000 });
  const busy = { code: 'PKC_E_BUSY', message: 'planner is in use by another thread' };
  assert.throws(() => planner.step(1), busy);
  assert.throws(() => planner.plan(bin, queue), busy);
  assert.throws(() => planner.close(), busy);
  let waits = true;
  const cancel = () => {
    if (!waits) return;
    planner.cancel();
    setTimeout(cancel, 1);
  };
  cancel();
  const plan = await promise;
  waits = false;
  assert.equal(plan.info.cancelled, 1);
  assert.ok(plan.actions.length > 0);
  planner.close();
  assert.ok(planner.closed);
});

test('a plan on another thread can be cancelled before it has begun there', async () => {
  const planner = new packcell.Planner();
  const queue = queueOf('D-R40A10O2', Array(40).fill([7, 5]));
  const promise = planner.planAsync(new packcell.Bin(60, 60), queue, { nodes: 0 });
  planner.cancel();
  const plan = await promise;
  assert.equal(plan.info.cancelled, 1);
  assert.ok(plan.actions.length > 0);
});

test('the exact packer decides', () => {
  const bin = new packcell.Bin(4, 4);
  const items = [{ id: 0, w: 2, h: 4 }, { id: 1, w: 4, h: 2 }];
  const found = packcell.exactPack(bin, items);
  assert.deepEqual([found.answer, found.placements.length], ['found', 2]);
  const none = packcell.exactPack(bin, items, { rotation: false });
  assert.deepEqual([none.answer, none.placements], ['impossible', null]);
  assert.deepEqual(packcell.boundInOrder(bin, items, { rotation: false }),
    { count: 1, exact: true });
});

test('generators give equal items for equal options', () => {
  const options = { seed: 5n };
  const items = new packcell.Generator(options).next(20);
  assert.equal(items.length, 20);
  assert.deepEqual(new packcell.Generator(options).next(20), items);
  const sets = new packcell.Generator({ preset: 'text', kind: packcell.PKC_GENERATE_FULL });
  assert.equal(sets.next(100).reduce((sum, { w, h }) => sum + w * h, 0), 100);
});

test('a grid goes from millimetres to cells and back', () => {
  const grid = new packcell.Grid(); // the paper's: 320 x 260, margin 10, cell 30, clearance 0
  assert.deepEqual(grid.bin(), { w: 10, h: 8 });
  assert.deepEqual(grid.item(31, 90), { w: 2, h: 3 });
  assert.deepEqual(grid.centre(0, 0, 1, 1), { x: 25, y: 25 });
  assert.deepEqual(new packcell.Grid({ cell: 10, clearance: 5 }).item(30, 25), { w: 4, h: 3 });
  assert.throws(() => new packcell.Grid({ cell: 0 }), { code: 'PKC_E_ARGUMENT', message: /cell/ });
  assert.throws(() => new packcell.Grid({ cel: 1 }), { name: 'TypeError', message: /grid\.cel/ });
  assert.throws(() => grid.item(NaN, 1), { code: 'PKC_E_ARGUMENT' });
  assert.throws(() => grid.item('1', 1), TypeError);
});

test('a policy is measured on a held-out stream', () => {
  const policy = new packcell.Policy('contact');
  const options = { rotation: packcell.PKC_ROTATION_ON };
  const first = policy.measure(options, { seed: 3n, bins: 200 });
  assert.ok(first.mean > 0.8 && first.mean < 0.95 && first.half_width < 0.05, String(first.mean));
  assert.deepEqual(policy.measure(options, { seed: 3n, bins: 200 }), first);
  assert.throws(() => policy.measure({}, { bins: 0 }), { code: 'PKC_E_ARGUMENT', message: /bins/ });
  assert.throws(() => policy.measure({ seeds: 1 }), TypeError);
});
