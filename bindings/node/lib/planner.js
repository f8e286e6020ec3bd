// Plans steps, and decides exactly whether items fit together.
'use strict';

const { promisify } = require('node:util');
const raw = require('../raw.js');
const check = require('./check.js');
const { Handle, busy } = require('./handle.js');
const { Bin } = require('./bin.js');
const { Queue } = require('./queue.js');
const { Policy } = require('./policy.js');

const { ok, integer } = check;

const stepOnThread = promisify(raw.pkc_planner_step.async);
const kAllNodes = 2n ** 64n - 1n;

// The process cannot end before the plans on other threads do: on its way out it ends them.
const working = new Set();
process.on('exit', () => {
  for (const planner of working) raw.pkc_planner_cancel(Planner.pointer(planner, 'planner'));
});

const budgetOf = (budget) => check.options('pkc_budget', budget, 'budget');

// The raw handle of a planner that is not at work.
function idle(planner) {
  const handle = Planner.pointer(planner, 'planner');
  // Between the end of a plan on another thread and its promise the library would not mind, but
  // the plan would be lost.
  if (handle !== null && Handle.pinned(planner)) throw busy('planner');
  return handle;
}

class Planner extends Handle {
  constructor(options, policy) {
    const all = check.options('pkc_planner_options', options, 'options');
    const handle = Policy.pointer(policy, 'policy');
    super(Planner, raw.pkc_planner_free, (out) => raw.pkc_planner_create(all, handle, out));
  }

  plan(bin, queue, budget) {
    const limits = budgetOf(budget);
    ok(raw.pkc_planner_plan(idle(this), Bin.pointer(bin, 'bin'), Queue.pointer(queue, 'queue'),
      limits, null));
    return this.result();
  }

  // The same on another thread: the state is copied before this returns, so bin and queue are free
  // again; the planner is in use until the promise is settled. cancel() ends it early.
  async planAsync(bin, queue, budget) {
    this.begin(bin, queue, budget);
    const planner = idle(this);
    Handle.pin(this);
    working.add(this);
    let status;
    try {
      status = await stepOnThread(planner, kAllNodes, [0]);
    } finally {
      working.delete(this);
      Handle.unpin(this);
    }
    // What the library said is that other thread's own and cannot be read here.
    if (status !== raw.PKC_OK) {
      throw new check.PackcellError(status, `planning failed: ${raw.pkc_status_name(status)}`);
    }
    return this.result();
  }

  begin(bin, queue, budget) {
    const limits = budgetOf(budget);
    ok(raw.pkc_planner_begin(idle(this), Bin.pointer(bin, 'bin'), Queue.pointer(queue, 'queue'),
      limits));
  }

  // Spends up to so many nodes; true when nothing is left to do.
  step(nodes) {
    const done = [0];
    ok(raw.pkc_planner_step(idle(this), integer(nodes, 'nodes', 'UInt64'), done));
    return done[0] !== 0;
  }

  // The plan, or the best so far.
  result() {
    const info = check.options('pkc_plan_info');
    const actions = check.objects(raw.PKC_MAX_ACTIONS);
    const count = [0];
    ok(raw.pkc_planner_result(idle(this), info, actions, actions.length, count));
    return { info: check.tidy(info), actions: actions.slice(0, Number(count[0])) };
  }

  cancel() {
    ok(raw.pkc_planner_cancel(Planner.pointer(this, 'planner')));
  }
}

const kAnswers = {
  [raw.PKC_PACKING_FOUND]: 'found',
  [raw.PKC_PACKING_IMPOSSIBLE]: 'impossible',
  [raw.PKC_PACKING_BUDGET]: 'budget',
};

// Can all items be placed on the bin's free cells?
function exactPack(bin, items, { rotation = true, budget } = {}) {
  const all = check.items(items);
  const limits = [check.flag(rotation, 'rotation'), budgetOf(budget)];
  const placements = check.objects(all.length);
  const answer = [0];
  const nodes = [0];
  ok(raw.pkc_exact_pack(Bin.pointer(bin, 'bin'), all, all.length, ...limits, placements, answer,
    nodes));
  const found = answer[0] === raw.PKC_PACKING_FOUND;
  return {
    answer: kAnswers[answer[0]],
    placements: found ? placements : null,
    nodes: Number(nodes[0]),
  };
}

// How many of the next items, without one left out, fit together on the bin's free cells.
function boundInOrder(bin, items, { rotation = true, budget } = {}) {
  const all = check.items(items);
  const limits = [check.flag(rotation, 'rotation'), budgetOf(budget)];
  const count = [0];
  const answer = [0];
  ok(raw.pkc_bound_in_order(Bin.pointer(bin, 'bin'), all, all.length, ...limits, count, answer));
  return { count: Number(count[0]), exact: answer[0] !== raw.PKC_PACKING_BUDGET };
}

module.exports = { Planner, exactPack, boundInOrder };
