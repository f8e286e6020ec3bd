// Items to plan with.
'use strict';

const raw = require('../raw.js');
const check = require('./check.js');
const { Handle } = require('./handle.js');

// Items of one call; as many objects are made before the library can refuse.
const kMost = 2 ** 20;

class Generator extends Handle {
  // The options are the header's fields, and `preset`: "text" or "table".
  constructor({ preset, ...options } = {}) {
    const all = check.options('pkc_generator_options');
    if (preset !== undefined) {
      check.ok(raw.pkc_generator_preset(all, check.string(preset, 'preset')));
    }
    Object.assign(all, given(options));
    super(Generator, raw.pkc_generator_free, (out) => raw.pkc_generator_create(all, out));
  }

  // PKC_GENERATE_RANDOM: so many items. PKC_GENERATE_FULL: the next set, of at most so many.
  next(most) {
    const capacity = check.integer(most, 'most');
    if (capacity < 0 || capacity > kMost) {
      throw new RangeError(`most ${capacity}: must be 0..${kMost}`);
    }
    const items = check.objects(capacity);
    const count = [0];
    check.ok(raw.pkc_generator_next(Generator.pointer(this, 'generator'), items, capacity, count));
    return items.slice(0, Number(count[0]));
  }
}

// What is given, checked, without the defaults.
function given(options) {
  const all = check.options('pkc_generator_options', options, 'options');
  const names = Object.keys(options).filter((name) => options[name] !== undefined);
  return Object.fromEntries(names.map((name) => [name, all[name]]));
}

module.exports = { Generator };
