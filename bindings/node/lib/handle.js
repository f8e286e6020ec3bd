// What all handles share: who owns them, and the check that one is what a call asks for. A raw
// handle is a mere number that koffi would hand to any function.
'use strict';

const raw = require('../raw.js');
const { PackcellError, ok, wrong } = require('./check.js');

// Frees the handles of objects that nobody closed.
const forgotten = new FinalizationRegistry(({ free, pointer }) => free(pointer));

class Handle {
  #type;
  #pointer;
  #free;
  #pins = 0;

  // Takes the handle of this class that `create(out)` stores in out[0], if it succeeds.
  constructor(type, free, create) {
    const out = [null];
    ok(create(out));
    this.#type = type;
    this.#pointer = out[0];
    this.#free = free;
    forgotten.register(this, { free, pointer: this.#pointer }, this);
  }

  // Frees the handle now; a closed one can be closed again. PKC_E_BUSY while a call on another
  // thread uses it.
  close() {
    if (this.#pointer === null) return;
    if (this.#pins > 0) throw busy(this.constructor.name.toLowerCase());
    forgotten.unregister(this);
    const pointer = this.#pointer;
    this.#pointer = null;
    this.#free(pointer);
  }

  get closed() {
    return this.#pointer === null;
  }

  // The raw handle of `value`, which must be an open one of this class; null stays null, of which
  // the library says what it thinks. A caller asks for it last: what reads the other arguments may
  // run code of the user's, a getter or an iterator, and that may close the handle.
  static pointer(value, name) {
    if (value === null || value === undefined) return null;
    // Not by the prototype, which anybody can change.
    const own = typeof value === 'object' && #type in value && value.#type === this;
    if (!own) throw wrong(name, `a ${this.name}`);
    if (value.#pointer === null) {
      const what = `${name} is closed: must be an open ${this.name}`;
      throw new PackcellError(raw.PKC_E_ARGUMENT, what);
    }
    return value.#pointer;
  }

  // While another thread uses it, a handle must not be freed.
  static pin(handle) {
    handle.#pins += 1;
  }

  static unpin(handle) {
    handle.#pins -= 1;
  }

  static pinned(handle) {
    return handle.#pins > 0;
  }
}

if (Symbol.dispose) Handle.prototype[Symbol.dispose] = Handle.prototype.close;

function busy(name) {
  return new PackcellError(raw.PKC_E_BUSY, `${name} is in use by another thread`);
}

// An object of a class around a handle that another call makes: its own constructor is not run.
function adopt(type, free, create) {
  return Reflect.construct(Handle, [type, free, create], type);
}

module.exports = { Handle, adopt, busy };
