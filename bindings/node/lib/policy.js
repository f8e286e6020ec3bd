// The low level: where an item goes.
'use strict';

const raw = require('../raw.js');
const check = require('./check.js');
const { Handle, adopt } = require('./handle.js');
const { Bin } = require('./bin.js');

const { ok, integer } = check;

class Policy extends Handle {
  constructor(name = 'default') {
    const text = check.string(name, 'name');
    super(Policy, raw.pkc_policy_free, (out) => raw.pkc_policy_create(text, out));
  }

  static builtins() {
    return check.names(raw.pkc_policy_builtin);
  }

  static load(blob) {
    const all = check.bytes(blob, 'blob');
    return adopt(Policy, raw.pkc_policy_free, (out) => raw.pkc_policy_load(...all, out));
  }

  static loadFile(path) {
    const text = check.string(path, 'path');
    return adopt(Policy, raw.pkc_policy_free, (out) => raw.pkc_policy_load_file(text, out));
  }

  save() {
    const policy = Policy.pointer(this, 'policy');
    return check.fill((n) => Buffer.alloc(n), (...to) => raw.pkc_policy_save(policy, ...to));
  }

  saveFile(path) {
    ok(raw.pkc_policy_save_file(Policy.pointer(this, 'policy'), check.string(path, 'path')));
  }

  get name() {
    return raw.pkc_policy_name(Policy.pointer(this, 'policy'));
  }

  info() {
    const policy = Policy.pointer(this, 'policy');
    return check.info('pkc_policy_info', (info) => raw.pkc_policy_get_info(policy, info));
  }

  select(bin, w, h) {
    const position = [0];
    const policy = Policy.pointer(this, 'policy');
    ok(raw.pkc_policy_select(policy, Bin.pointer(bin, 'bin'), integer(w, 'w'), integer(h, 'h'),
      position));
    return position[0];
  }

  evaluate(bin, w, h) {
    const sides = [integer(w, 'w'), integer(h, 'h')];
    const policy = Policy.pointer(this, 'policy');
    const handle = Bin.pointer(bin, 'bin');
    const positions = positionsOf(handle);
    const logits = new Float32Array(positions);
    const probabilities = new Float32Array(positions);
    const value = [0];
    ok(raw.pkc_policy_evaluate(policy, handle, ...sides, logits, probabilities, positions, [0],
      value));
    return { logits, probabilities, value: value[0] };
  }

  // For pairs [bin, w, h].
  selectBatch(pairs) {
    const { bins, sizes } = unzip(pairs);
    const positions = new Int32Array(bins.length);
    const policy = Policy.pointer(this, 'policy');
    ok(raw.pkc_policy_evaluate_batch(policy, bins, sizes, bins.length, positions, null, null));
    return positions;
  }

  evaluateBatch(pairs) {
    const { bins, sizes } = unzip(pairs);
    const each = bins.length > 0 ? positionsOf(bins[0]) : 0;
    const positions = new Int32Array(bins.length);
    const probabilities = new Float32Array(bins.length * each);
    const values = new Float32Array(bins.length);
    const policy = Policy.pointer(this, 'policy');
    ok(raw.pkc_policy_evaluate_batch(policy, bins, sizes, bins.length, positions,
      probabilities, values));
    return { positions, probabilities, values };
  }

  // Packs so many bins of a held-out stream. Bins, items and rotation are those of the options, the
  // fields of pkc_trainer_options.
  measure(options, { seed = 1, bins = 1000 } = {}) {
    const args = [check.options('pkc_trainer_options', options, 'options'),
      integer(seed, 'seed', 'UInt64'), integer(bins, 'bins', 'UInt64')];
    const [mean, halfWidth] = [[0], [0]];
    ok(raw.pkc_policy_measure(Policy.pointer(this, 'policy'), ...args, mean, halfWidth));
    return { mean: mean[0], half_width: halfWidth[0] };
  }
}

// W*H + 1 of a raw handle, 1 of none. The library does not check the size of a batch's arrays: it
// must not come from anything that others can change, such as bin.info().
function positionsOf(bin) {
  if (bin === null) return 1;
  const { w, h } = check.info('pkc_bin_info', (info) => raw.pkc_bin_get_info(bin, info));
  return w * h + 1;
}

function unzip(pairs) {
  const all = check.list(pairs, 'pairs').map((pair, i) => {
    if (!Array.isArray(pair) || pair.length !== 3) {
      throw check.wrong(`pairs[${i}]`, '[bin, w, h]');
    }
    const [bin, w, h] = pair;
    return { bin, w: integer(w, `pairs[${i}][1]`), h: integer(h, `pairs[${i}][2]`) };
  });
  // Never empty, as koffi makes NULL of an empty array.
  const sizes = new Int32Array(2 * all.length + 1);
  all.forEach(({ w, h }, i) => {
    sizes[2 * i] = w;
    sizes[2 * i + 1] = h;
  });
  return { bins: all.map(({ bin }, i) => Bin.pointer(bin, `pairs[${i}][0]`)), sizes };
}

module.exports = { Policy };
