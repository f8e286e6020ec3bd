// The bin that items are packed into.
'use strict';

const raw = require('../raw.js');
const check = require('./check.js');
const { Handle, adopt } = require('./handle.js');

const { ok, integer, fill } = check;

class Bin extends Handle {
  constructor(w, h) {
    const sides = [integer(w, 'w'), integer(h, 'h')];
    super(Bin, raw.pkc_bin_free, (out) => raw.pkc_bin_create(...sides, out));
  }

  clone() {
    const bin = Bin.pointer(this, 'bin');
    return adopt(Bin, raw.pkc_bin_free, (out) => raw.pkc_bin_clone(bin, out));
  }

  clear() {
    ok(raw.pkc_bin_clear(Bin.pointer(this, 'bin')));
  }

  block(x, y, w, h) {
    const area = [integer(x, 'x'), integer(y, 'y'), integer(w, 'w'), integer(h, 'h')];
    ok(raw.pkc_bin_block(Bin.pointer(this, 'bin'), ...area));
  }

  pack(item, x, y, rot = 0) {
    const args = [check.item(item), integer(x, 'x'), integer(y, 'y'), integer(rot, 'rot')];
    ok(raw.pkc_bin_pack(Bin.pointer(this, 'bin'), ...args));
  }

  unpack(id) {
    const placement = {};
    ok(raw.pkc_bin_unpack(Bin.pointer(this, 'bin'), integer(id, 'id'), placement));
    return placement;
  }

  info() {
    const bin = Bin.pointer(this, 'bin');
    return check.info('pkc_bin_info', (info) => raw.pkc_bin_get_info(bin, info));
  }

  items() {
    const bin = Bin.pointer(this, 'bin');
    return fill(check.objects, (...to) => raw.pkc_bin_items(bin, ...to));
  }

  cells() {
    const bin = Bin.pointer(this, 'bin');
    return fill((n) => new Int32Array(n), (...to) => raw.pkc_bin_cells(bin, ...to));
  }

  feasible(w, h) {
    const args = [Bin.pointer(this, 'bin'), integer(w, 'w'), integer(h, 'h')];
    return fill((n) => new Uint8Array(n), (...to) => raw.pkc_bin_feasible(...args, ...to));
  }

  contact(x, y, w, h) {
    const area = [integer(x, 'x'), integer(y, 'y'), integer(w, 'w'), integer(h, 'h')];
    const reward = [0];
    ok(raw.pkc_bin_contact(Bin.pointer(this, 'bin'), ...area, reward));
    return reward[0];
  }
}

module.exports = { Bin };
