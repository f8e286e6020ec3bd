// packcell for Node.js: plans a robotic bin-packing cell. What things are called and mean is in
// packcell.h; the fields of records are those of the header.
'use strict';

const raw = require('./raw.js');
const { PackcellError } = require('./lib/check.js');

const constants = Object.fromEntries(
  Object.entries(raw).filter(([name]) => name.startsWith('PKC_')));

// Version of the linked library.
function version() {
  const v = raw.pkc_version();
  return `${Math.floor(v / 10000)}.${Math.floor(v / 100) % 100}.${v % 100}`;
}

module.exports = {
  ...constants,
  ...require('./lib/bin.js'),
  ...require('./lib/queue.js'),
  ...require('./lib/policy.js'),
  ...require('./lib/planner.js'),
  ...require('./lib/cell.js'),
  ...require('./lib/schedule.js'),
  ...require('./lib/generator.js'),
  PackcellError,
  version,
};
