// packcell for Node.js: plans a robotic bin-packing cell. What things are called and mean is in
// packcell.h; the fields of records are those of the header.
'use strict';

const raw = load();
const { PackcellError } = require('./lib/check.js');

const constants = Object.fromEntries(
  Object.entries(raw).filter(([name]) => name.startsWith('PKC_')));

// The loader's own message names neither the library nor the way to it.
function load() {
  try {
    return require('./raw.js');
  } catch (e) {
    if (!/shared library/.test(e.message)) throw e;
    const name = process.env.PACKCELL_LIBRARY || 'libpackcell.so.0';
    throw new Error(`${name}: ${e.message}; PACKCELL_LIBRARY names the library, else the loader `
      + 'must find libpackcell.so.0', { cause: e });
  }
}

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
  ...require('./lib/grid.js'),
  PackcellError,
  version,
};
