// Bad input is an error, with the library's message where the library judges, never a crash.
'use strict';

const test = require('node:test');
const assert = require('node:assert/strict');
const { Worker } = require('node:worker_threads');
const packcell = require(process.env.PACKCELL_NODE);

const refused = (call, code, words) =>
  assert.throws(call, (e) => {
    assert.ok(e instanceof packcell.PackcellError, String(e));
    assert.equal(e.code, code);
    assert.match(e.message, words);
    return true;
  });

test('values that the library refuses', () => {
  refused(() => new packcell.Bin(0, 10), 'PKC_E_ARGUMENT', /^bin width 0: must be 1\.\.128$/);
  refused(() => new packcell.Scenario('X-R1'), 'PKC_E_ARGUMENT', /X-R1/);
  refused(() => new packcell.Policy('nothing'), 'PKC_E_ARGUMENT', /nothing/);
  refused(() => packcell.Policy.loadFile('/no/such/file'), 'PKC_E_IO', /no\/such\/file/);
  refused(() => new packcell.Planner({ method: 77 }), 'PKC_E_ARGUMENT', /77/);
  refused(() => new packcell.Generator({ preset: 'nothing' }), 'PKC_E_ARGUMENT', /nothing/);
  const bin = new packcell.Bin(4, 4);
  refused(() => bin.pack({ id: -1, w: 1, h: 1 }, 0, 0), 'PKC_E_ARGUMENT', /-1/);
  bin.pack({ id: 1, w: 2, h: 2 }, 0, 0);
  refused(() => bin.pack({ id: 2, w: 2, h: 2 }, 1, 1), 'PKC_E_STATE', /./);
  refused(() => bin.unpack(9), 'PKC_E_STATE', /9/);
  const planner = new packcell.Planner();
  refused(() => planner.result(), 'PKC_E_STATE', /./);
  const queue = new packcell.Queue('S-R1A1');
  refused(() => packcell.apply(bin, queue, [{ op: packcell.PKC_OP_PACK, item: 5 }]),
    'PKC_E_STATE', /0/);
});

test('foreign bytes', () => {
  refused(() => packcell.loadSnapshot(Buffer.from('not a snapshot')), 'PKC_E_FORMAT', /byte 0/);
  refused(() => packcell.loadSnapshot(Buffer.alloc(0)), 'PKC_E_FORMAT', /./);
  refused(() => packcell.Policy.load(new Uint8Array(3)), 'PKC_E_FORMAT', /./);
  assert.throws(() => packcell.Cell.load('{}'), packcell.PackcellError);
  assert.throws(() => packcell.loadSnapshot('text'), TypeError);
});

test('null handles', () => {
  const bin = new packcell.Bin(4, 4);
  const queue = new packcell.Queue('S-R1A1');
  const planner = new packcell.Planner();
  refused(() => packcell.apply(null, queue, []), 'PKC_E_ARGUMENT', /^bin is NULL/);
  refused(() => packcell.apply(bin, undefined, []), 'PKC_E_ARGUMENT', /^queue is NULL/);
  refused(() => planner.plan(null, queue), 'PKC_E_ARGUMENT', /^bin is NULL/);
  refused(() => new packcell.Queue(null), 'PKC_E_ARGUMENT', /NULL/);
  const policy = new packcell.Policy('contact');
  refused(() => policy.select(null, 1, 1), 'PKC_E_ARGUMENT', /NULL/);
  refused(() => policy.selectBatch([[null, 1, 1]]), 'PKC_E_ARGUMENT', /NULL/);
  refused(() => policy.evaluateBatch([[null, 1, 1]]), 'PKC_E_ARGUMENT', /NULL/);
  refused(() => policy.evaluate(null, 1, 1), 'PKC_E_ARGUMENT', /NULL/);
  assert.throws(() => new packcell.Schedule(null, 'S-R1A1'), packcell.PackcellError);
});

test('closed handles', () => {
  const closed = (type, ...args) => {
    const handle = new packcell[type](...args);
    handle.close();
    handle.close();
    assert.ok(handle.closed);
    return handle;
  };
  const bin = closed('Bin', 4, 4);
  refused(() => bin.info(), 'PKC_E_ARGUMENT', /^bin is closed: must be an open Bin$/);
  refused(() => closed('Queue', 'S-R1A1').belt(), 'PKC_E_ARGUMENT', /closed/);
  refused(() => closed('Policy').name, 'PKC_E_ARGUMENT', /closed/);
  refused(() => closed('Planner').cancel(), 'PKC_E_ARGUMENT', /closed/);
  refused(() => closed('Planner').result(), 'PKC_E_ARGUMENT', /closed/);
  refused(() => closed('Generator').next(1), 'PKC_E_ARGUMENT', /closed/);
  refused(() => new packcell.Planner({}, closed('Policy')), 'PKC_E_ARGUMENT', /policy is closed/);
  refused(() => new packcell.Policy('contact').select(bin, 1, 1), 'PKC_E_ARGUMENT', /closed/);
});

test('handles of another class, and things that only look like one', () => {
  const queue = new packcell.Queue('S-R1A1');
  const policy = new packcell.Policy('contact');
  for (const value of [queue, policy, 5, 5n, 'bin', {}, Object.create(packcell.Bin.prototype)]) {
    assert.throws(() => packcell.apply(value, queue, []),
      { name: 'TypeError', message: 'bin: must be a Bin' });
    assert.throws(() => policy.select(value, 1, 1), TypeError);
    assert.throws(() => packcell.Bin.prototype.clear.call(value), TypeError);
  }
  assert.throws(() => new packcell.Planner({}, queue), TypeError);
  assert.throws(() => new packcell.Queue(new packcell.Bin(1, 1)), TypeError);
});

test('values of another type or size', () => {
  const bin = new packcell.Bin(4, 4);
  const queue = new packcell.Queue('S-R1A1');
  for (const value of ['4', null, undefined, {}, [4], true]) {
    assert.throws(() => new packcell.Bin(value, 4), { name: 'TypeError', message: /^w: / });
  }
  for (const value of [1.5, NaN, Infinity, 2 ** 31, -(2 ** 40), 2n ** 31n]) {
    assert.throws(() => new packcell.Bin(value, 4), { name: 'RangeError', message: /^w / });
  }
  assert.throws(() => bin.pack({ id: 1, w: 1 }, 0, 0), { message: /^item\.h: must be/ });
  assert.throws(() => bin.pack(null, 0, 0), TypeError);
  assert.throws(() => queue.push({ id: 1, w: 1, h: 1, flags: -1 }), RangeError);
  assert.throws(() => packcell.apply(bin, queue, { length: 3 }), TypeError);
  assert.throws(() => packcell.apply(bin, queue, [3]), TypeError);
  assert.throws(() => packcell.planHash([{ item: 1 }]), { message: /^actions\[0\]\.op/ });
  assert.throws(() => queue.removeItems(new DataView(new ArrayBuffer(8))), TypeError);
  assert.throws(() => queue.removeItems([0.5]), RangeError);
  assert.throws(() => new packcell.Policy('con\0tact'), RangeError);
  assert.throws(() => new packcell.Policy(7), TypeError);
  assert.throws(() => new packcell.Planner({ repak: 2 }), { message: /repak/ });
  assert.throws(() => new packcell.Planner({ struct_size: 4 }), TypeError);
  assert.throws(() => new packcell.Planner({ memory: -1 }), RangeError);
  const planner = new packcell.Planner();
  assert.throws(() => planner.plan(bin, queue, { nodes: -1 }), RangeError);
  assert.throws(() => planner.plan(bin, queue, 5), TypeError);
  assert.throws(() => new packcell.Generator().next(2 ** 31 - 1), RangeError);
  assert.throws(() => new packcell.Generator().next(-1), RangeError);
  assert.throws(() => planner.step(2n ** 64n), RangeError);
  assert.throws(() => planner.step(2 ** 60),
    { name: 'RangeError', message: 'nodes 1152921504606847000: must be a BigInt, to be exact' });
  for (const value of [5, null, true]) assert.throws(() => new packcell.Scenario(value), TypeError);
  assert.throws(() => new packcell.Policy('contact').selectBatch([[bin, 1]]), TypeError);
  assert.throws(() => packcell.exactPack(bin, [], { rotation: 1 }), TypeError);
  refused(() => new packcell.Policy('contact').selectBatch([]), 'PKC_E_ARGUMENT', /count 0/);
  const other = new packcell.Bin(5, 5);
  refused(() => new packcell.Policy('contact').selectBatch([[bin, 1, 1], [other, 1, 1]]),
    'PKC_E_ARGUMENT', /bin 1/);
});

test('a bad call on another thread fails its promise', async () => {
  const planner = new packcell.Planner();
  await assert.rejects(planner.planAsync(null, new packcell.Queue('S-R1A1')),
    { code: 'PKC_E_ARGUMENT', message: /^bin is NULL/ });
  planner.close();
  await assert.rejects(planner.planAsync(new packcell.Bin(1, 1), new packcell.Queue('S-R1A1')),
    { code: 'PKC_E_ARGUMENT', message: /closed/ });
});

test('a handle that is sent to a worker is no handle there', async () => {
  const code = `
    const { workerData, parentPort } = require('node:worker_threads');
    const packcell = require(process.env.PACKCELL_NODE);
    try {
      packcell.Bin.prototype.clear.call(workerData);
    } catch (e) {
      parentPort.postMessage(e.name + ' ' + e.message);
    }`;
  const worker = new Worker(code, { eval: true, workerData: new packcell.Bin(4, 4) });
  const said = await new Promise((resolve, reject) => {
    worker.once('message', resolve);
    worker.once('error', reject);
  });
  assert.equal(said, 'TypeError bin: must be a Bin');
  await worker.terminate();
});

test('a handle that two threads use is refused by the library', async () => {
  const raw = require(`${process.env.PACKCELL_NODE}/raw.js`);
  const planner = new packcell.Planner();
  const queue = new packcell.Queue('D-R40A10O2');
  for (let id = 0; id < 40; ++id) queue.push({ id, w: 3 + (id % 7), h: 2 + (id % 5) });
  const pointer = packcell.Planner.pointer(planner, 'planner');
  // Either thread may be the one that is refused.
  let other = null;
  const plan = planner.planAsync(new packcell.Bin(60, 60), queue, { nodes: 0, milliseconds: 20000 })
    .then(() => { other = raw.PKC_OK; }, (e) => { other = e.status; });
  let own = raw.PKC_OK;
  while (own === raw.PKC_OK && other === null) {
    await new Promise((resolve) => { setTimeout(resolve, 1); });
    own = raw.pkc_planner_step(pointer, 1, [0]);
  }
  if (own === raw.PKC_E_BUSY) assert.match(raw.pkc_last_error(), /in use by another thread/);
  else assert.equal(other, raw.PKC_E_BUSY);
  planner.cancel();
  await plan;
});

test('a handle that is disposed of is closed', { skip: !Symbol.dispose }, () => {
  const bin = new packcell.Bin(4, 4);
  bin[Symbol.dispose]();
  assert.ok(bin.closed);
});

test('handles that nobody closes are freed', async () => {
  const before = process.memoryUsage.rss();
  for (let round = 0; round < 20; ++round) {
    for (let i = 0; i < 4; ++i) new packcell.Planner({ memory: 8 << 20 });
    global.gc();
    await new Promise(setImmediate);
  }
  // 80 planners of 8 MiB at least.
  assert.ok(process.memoryUsage.rss() - before < 320 << 20);
});
