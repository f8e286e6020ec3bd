// Plans 14 items into a bin of 10 x 10 cells and prints the hash of the plan, which is the same in
// every language and on every machine.
'use strict';

const packcell = require('..');

const sizes = [
  [2, 1], [4, 3], [2, 2], [4, 4], [2, 4], [3, 4], [3, 2],
  [3, 1], [3, 5], [2, 2], [2, 2], [2, 3], [5, 5], [2, 4],
];

const bin = new packcell.Bin(10, 10);
const queue = new packcell.Queue('D-R5A3O1');
sizes.forEach(([w, h], id) => queue.push({ id, w, h }));

const planner = new packcell.Planner(
  { repack: packcell.PKC_REPACK_FULL }, new packcell.Policy('contact'));

const actions = [];
let step;
do {
  step = planner.plan(bin, queue, { nodes: 20000 });
  packcell.apply(bin, queue, step.actions);
  actions.push(...step.actions);
} while (!step.info.terminate);
console.log(packcell.planHash(actions).toString(16).padStart(16, '0'));
