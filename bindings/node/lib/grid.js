// From the millimetres of a real bin to cells and back.
'use strict';

const raw = require('../raw.js');
const check = require('./check.js');

const { ok, integer, number } = check;

class Grid {
  #struct;

  // The fields are the header's; what is not given is the paper's.
  constructor(fields) {
    this.#struct = check.options('pkc_grid', fields, 'grid');
    this.bin();
  }

  // Cells of the bin's sides.
  bin() {
    const [w, h] = [[0], [0]];
    ok(raw.pkc_grid_bin(this.#struct, w, h));
    return { w: w[0], h: h[0] };
  }

  // Cells that an item of w x h millimetres takes.
  item(w, h) {
    const [across, down] = [[0], [0]];
    ok(raw.pkc_grid_item(this.#struct, number(w, 'w'), number(h, 'h'), across, down));
    return { w: across[0], h: down[0] };
  }

  // Centre of a w x h rectangle of cells at cell (x, y), in millimetres from the inside top-left
  // corner of the bin: where an item is put down with its own centre.
  centre(x, y, w, h) {
    const area = [integer(x, 'x'), integer(y, 'y'), integer(w, 'w'), integer(h, 'h')];
    const [toRight, down] = [[0], [0]];
    ok(raw.pkc_grid_centre(this.#struct, ...area, toRight, down));
    return { x: toRight[0], y: down[0] };
  }
}

module.exports = { Grid };
