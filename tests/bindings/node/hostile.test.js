// Code of the caller's that runs in the midst of a call, and values that are not what they seem:
// an error, never a crash.
'use strict';

const test = require('node:test');
const assert = require('node:assert/strict');
const { spawnSync } = require('node:child_process');
const vm = require('node:vm');
const packcell = require(process.env.PACKCELL_NODE);

const closed = { code: 'PKC_E_ARGUMENT', message: /is closed/ };
const kItem = { id: 1, w: 1, h: 1 };

// An object that closes a handle when its field is read.
const closing = (handle, value, field) =>
  Object.defineProperty({ ...value }, field, {
    enumerable: true,
    get() {
      handle.close();
      return value[field];
    },
  });

test('a handle that is closed while the arguments are read', () => {
  const using = (handle, call) => {
    assert.throws(() => call(handle), closed);
    assert.ok(handle.closed);
  };
  const bin = () => new packcell.Bin(5, 5);
  const queue = () => new packcell.Queue('S-R1A1');
  using(bin(), (b) => b.pack(closing(b, kItem, 'id'), 0, 0));
  using(queue(), (q) => q.push(closing(q, kItem, 'id')));
  using(queue(), (q) => q.putInBuffer(closing(q, kItem, 'h'), 0));
  for (const call of [packcell.exactPack, packcell.boundInOrder]) {
    using(bin(), (b) => call(b, [closing(b, kItem, 'w')]));
    using(bin(), (b) => call(b, [kItem], { budget: closing(b, { nodes: 5 }, 'nodes') }));
  }
  const action = { op: packcell.PKC_OP_SKIP, item: 1 };
  using(bin(), (b) => packcell.apply(b, queue(), [closing(b, action, 'op')]));
  const planner = new packcell.Planner();
  using(bin(), (b) => planner.plan(b, queue(), closing(b, { nodes: 5 }, 'nodes')));
  using(bin(), (b) => planner.begin(b, queue(), closing(b, { nodes: 5 }, 'nodes')));
  using(new packcell.Policy(), (p) => new packcell.Planner(closing(p, { repack: 0 }, 'repack'), p));

  const policy = new packcell.Policy('contact');
  const pair = (first) => ({
    * [Symbol.iterator]() {
      first.close();
      yield* [bin(), 1, 1];
    },
  });
  using(bin(), (b) => policy.selectBatch([[b, 1, 1], Object.assign([0, 0, 0], pair(b))]));
});

test('a cell that is closed while the arguments are read', () => {
  const cell = () => new packcell.Cell('ur5e');
  try {
    cell();
  } catch (e) {
    assert.equal(e.code, 'PKC_E_UNSUPPORTED');
    return;
  }
  const closer = (handle, length) => Object.assign(Array(length).fill(0), {
    * [Symbol.iterator]() {
      handle.close();
      yield* Array(length).fill(0);
    },
  });
  const fields = { robots: 1, recognized: 1, accessible: 1, overlap: 0 };
  const scenarioOf = (handle) => {
    const scenario = new packcell.Scenario(fields);
    return Object.defineProperty(scenario, 'robots', {
      enumerable: true,
      get() {
        handle.close();
        return 1;
      },
    });
  };
  for (const call of [
    (c) => c.inverse(0, closer(c, 4)),
    (c) => c.forward(0, closer(c, 6)),
    (c) => c.check(scenarioOf(c)),
    (c) => c.optimizeLayout(scenarioOf(c)),
    (c) => new packcell.Schedule(c, scenarioOf(c)),
  ]) {
    const handle = cell();
    assert.throws(() => call(handle), closed, String(call));
  }
  const schedule = new packcell.Schedule(cell(), 'S-R1A1');
  assert.throws(() => schedule.simulate(closing(schedule, { hertz: 100 }, 'hertz')), closed);
});

test('a handle with the prototype of another class', () => {
  const queue = Object.setPrototypeOf(new packcell.Queue('S-R1A1'), packcell.Bin.prototype);
  const wrong = { name: 'TypeError', message: 'bin: must be a Bin' };
  assert.throws(() => queue.info(), wrong);
  const built = Reflect.construct(packcell.Queue, ['S-R1A1'], packcell.Bin);
  assert.throws(() => built.items(), wrong);
  class Crate extends packcell.Bin {}
  assert.equal(new Crate(2, 2).info().w, 2);
});

test('a bin that tells other sides than its own', () => {
  const policy = new packcell.Policy();
  const bin = new packcell.Bin(10, 10);
  bin.info = () => ({ w: 1, h: 1 });
  assert.equal(policy.evaluateBatch(Array(50).fill([bin, 2, 2])).probabilities.length, 50 * 101);
  assert.equal(policy.evaluate(bin, 2, 2).logits.length, 101);
  const pairs = [[bin, 2, 2]];
  pairs[Symbol.iterator] = function* two() {
    yield* [[new packcell.Bin(10, 10), 2, 2]];
  };
  pairs[0] = [new packcell.Bin(1, 1), 1, 1];
  assert.equal(policy.evaluateBatch(pairs).probabilities.length, 101);
});

test('bytes and arrays of another kind', () => {
  const bin = new packcell.Bin(4, 4);
  const queue = new packcell.Queue('S-R1A1');
  const bytes = packcell.saveSnapshot(bin, queue);
  assert.equal(packcell.loadSnapshot(new Uint8Array(bytes)).bin.info().w, 4);
  const shared = new Uint8Array(new SharedArrayBuffer(bytes.length));
  shared.set(bytes);
  assert.equal(packcell.loadSnapshot(shared).bin.info().w, 4);
  // Of another realm, as in test frameworks.
  const foreign = vm.runInNewContext('new Uint8Array(list)', { list: [...bytes] });
  assert.equal(packcell.loadSnapshot(foreign).bin.info().w, 4);
  for (const value of [
    new Uint16Array(bytes), new DataView(bytes.buffer), bytes.buffer, [...bytes],
  ]) {
    assert.throws(() => packcell.loadSnapshot(value), TypeError);
  }
  const gone = new Uint8Array(8);
  structuredClone(gone, { transfer: [gone.buffer] });
  assert.throws(() => packcell.loadSnapshot(gone), TypeError);
  assert.throws(() => queue.removeItems(gone), TypeError);
  class Longer extends Uint8Array {
    asked = 0;

    get length() {
      this.asked += 1;
      return this.asked > 1 ? 2 ** 40 : 8;
    }
  }
  assert.throws(() => packcell.loadSnapshot(new Longer(8)), { code: 'PKC_E_FORMAT' });
  assert.throws(() => packcell.Policy.load(new Longer(8)), { code: 'PKC_E_FORMAT' });
  queue.push({ id: 1, w: 1, h: 1 });
  queue.removeItems(new Float64Array([1]));
  queue.removeItems(new BigInt64Array());
  assert.throws(() => queue.removeItems(new Float64Array([NaN])), RangeError);
  assert.throws(() => queue.removeItems(new Array(2 ** 32 - 1)),
    { message: 'ids has 4294967295 elements: must have 0..16777216' });
});

test('errors of the caller\'s own code pass through', () => {
  const own = new Error('mine');
  const item = { get id() { throw own; } };
  const bin = new packcell.Bin(4, 4);
  assert.throws(() => bin.pack(item, 0, 0), (e) => e === own);
  assert.throws(() => packcell.exactPack(bin, [item]), (e) => e === own);
  bin.pack(kItem, 0, 0); // nobody has it any more
});

// Numbers in 0..n-1, the same in every run.
function draw(seed) {
  let state = seed;
  return (n) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * n);
  };
}

test('any value anywhere', () => {
  const seed = 1;
  const next = draw(seed);
  const gone = new Int32Array(4);
  structuredClone(gone, { transfer: [gone.buffer] });
  const make = {
    Bin: () => new packcell.Bin(4, 4),
    Queue: () => new packcell.Queue('D-R5A3O1'),
    Policy: () => new packcell.Policy('contact'),
    Planner: () => new packcell.Planner({ memory: 65536, max_side: 8 }),
    Generator: () => new packcell.Generator(),
    Grid: () => new packcell.Grid(),
    Scenario: () => new packcell.Scenario(),
  };
  try {
    new packcell.Cell('ur5e').close();
    make.Cell = () => new packcell.Cell('ur5e');
    make.Schedule = () => new packcell.Schedule(new packcell.Cell('ur5e'), 'S-R1A1');
    make.Simulation = () => make.Schedule().simulate();
  } catch (e) {
    assert.equal(e.code, 'PKC_E_UNSUPPORTED');
  }
  const values = [
    undefined, null, true, '', '4', 'S-R1A1', 'contact', 'ur5e', 'a\0b', '\ud800', NaN, Infinity,
    -Infinity, -0, 0, 1, 2, 3, 4, 128, 129, -1, 0.5, 1e300, 2 ** 31 - 1, 2 ** 31, -(2 ** 31), 0n,
    1n, 2n ** 64n, Symbol('s'), () => 1, {}, [], [1], [null], [[]], { nodes: 1 }, kItem,
    { ...kItem, w: -1 }, [kItem], [{ op: 2, item: 1 }], [{ op: 99 }], new Int32Array(4), gone,
    new Float64Array([NaN, 1, 2, 3]), Buffer.alloc(3), new SharedArrayBuffer(8), new Date(),
    new Proxy({}, {}), Object.create(null), [0, 0, 0.5, 0], Array(6).fill(1e300), /x/,
  ];
  // These write files, or may take long because they are asked to.
  const left = new Set(['constructor', 'saveFile', 'writeTrace', 'measure', 'optimizeLayout',
    'planAsync']);
  const args = (handles) => Array.from({ length: next(6) }, () =>
    (next(4) === 0 ? handles[next(handles.length)] : values[next(values.length)]));
  let calls = 0;
  let refusals = 0;
  const attack = (call, what) => {
    calls += 1;
    try {
      call();
    } catch (e) {
      refusals += 1;
      const known = e instanceof packcell.PackcellError || e instanceof TypeError
        || e instanceof RangeError;
      assert.ok(known && e.message !== '', `seed ${seed}, ${what}: ${e.stack}`);
    }
  };
  for (let round = 0; round < 40; ++round) {
    const handles = Object.values(make).map((f) => f());
    for (const handle of handles) {
      const type = handle.constructor;
      const names = Object.getOwnPropertyNames(type.prototype).filter((name) => !left.has(name));
      for (let i = 0; i < 20; ++i) {
        const name = names[next(names.length)];
        attack(() => (typeof handle[name] === 'function' ? handle[name](...args(handles)) : 0),
          `${type.name}.${name}`);
      }
      attack(() => new type(...args(handles)), type.name);
    }
    for (const name of ['apply', 'planHash', 'saveSnapshot', 'loadSnapshot', 'exactPack',
      'boundInOrder']) {
      attack(() => packcell[name](...args(handles)), name);
    }
  }
  assert.ok(calls > 5000 && refusals > calls / 4, `${calls} calls, ${refusals} refused`);
});

// A process of its own that runs this code.
const run = (code, env = {}) =>
  spawnSync(process.execPath, ['-e', `
    const packcell = require(process.env.PACKCELL_NODE);
    ${code}`], { encoding: 'utf8', timeout: 60000, env: { ...process.env, ...env } });

test('a process ends the plans on its other threads with itself', () => {
  const code = (end) => `
    const queue = new packcell.Queue('D-R40A10O2');
    for (let id = 0; id < 42; ++id) queue.push({ id, w: 3 + id % 7, h: 2 + id % 5 });
    const budget = { nodes: 0, milliseconds: 40000 };
    new packcell.Planner().planAsync(new packcell.Bin(60, 60), queue, budget);
    setTimeout(() => { ${end} }, 50);`;
  const begun = Date.now();
  assert.equal(run(code('process.exit(3)')).status, 3);
  const thrown = run(code('throw new Error("mine")'));
  assert.equal(thrown.status, 1);
  assert.match(thrown.stderr, /Error: mine/);
  assert.ok(Date.now() - begun < 30000);
});

test('a library that is not there is named', () => {
  const failed = run('', { PACKCELL_LIBRARY: '/no/such/library.so' });
  assert.equal(failed.status, 1);
  assert.match(failed.stderr, /Error: \/no\/such\/library\.so: .*PACKCELL_LIBRARY/);
});
