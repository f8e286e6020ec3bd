// Errors, and the checks that a value is what the header says before it goes to the library: koffi
// would cut a number to its type and read past the end of a short array.
'use strict';

const { isUint8Array } = require('node:util/types');
const koffi = require('koffi');
const raw = require('../raw.js');

// A call that the library refused. `status` is PKC_E_*, `name` of it in `code`.
class PackcellError extends Error {
  constructor(status, message) {
    super(message);
    this.name = 'PackcellError';
    this.status = status;
    this.code = raw.pkc_status_name(status);
  }
}

// Throws what the library says about the call that gave this status, the thread's last.
function ok(status) {
  if (status !== raw.PKC_OK) throw new PackcellError(status, raw.pkc_last_error());
}

function wrong(name, what) {
  return new TypeError(`${name}: must be ${what}`);
}

function show(value) {
  return typeof value === 'string' ? JSON.stringify(value) : String(value);
}

const kIntegers = {
  Int32: [-(2n ** 31n), 2n ** 31n - 1n],
  UInt32: [0n, 2n ** 32n - 1n],
  Int64: [-(2n ** 63n), 2n ** 63n - 1n],
  UInt64: [0n, 2n ** 64n - 1n],
};

// A number or BigInt that this C type holds.
function integer(value, name, type = 'Int32') {
  const [least, most] = kIntegers[type];
  if (typeof value !== 'bigint' && !Number.isInteger(value)) {
    if (typeof value !== 'number') throw wrong(name, 'a whole number');
    throw new RangeError(`${name} ${show(value)}: must be a whole number`);
  }
  if (value < least || value > most) {
    throw new RangeError(`${name} ${show(value)}: must be ${least}..${most}`);
  }
  if (typeof value === 'number' && !Number.isSafeInteger(value)) {
    throw new RangeError(`${name} ${show(value)}: must be a BigInt, to be exact`);
  }
  return type.endsWith('64') ? BigInt(value) : Number(value);
}

function number(value, name) {
  if (typeof value !== 'number') throw wrong(name, 'a number');
  return value;
}

// Text without a zero, which would end it in C.
function string(value, name) {
  if (typeof value !== 'string') throw wrong(name, 'a string');
  if (value.includes('\0')) throw new RangeError(`${name}: must have no zero character`);
  return value;
}

// A copy of its own and its size. It has one byte more, as koffi makes NULL of an empty array.
function bytes(value, name) {
  if (!isUint8Array(value)) throw wrong(name, 'a Buffer or Uint8Array');
  const copy = Buffer.alloc(value.length + 1);
  copy.set(value);
  return [copy, copy.length - 1];
}

function flag(value, name) {
  if (typeof value !== 'boolean') throw wrong(name, 'true or false');
  return value ? 1 : 0;
}

function isList(value) {
  return Array.isArray(value) || (ArrayBuffer.isView(value) && !(value instanceof DataView));
}

// More than any call of the library takes; a copy of much more would end the process.
const kMostElements = 2 ** 24;

function list(value, name) {
  if (!isList(value)) throw wrong(name, 'an array');
  if (value.length > kMostElements) {
    throw new RangeError(`${name} has ${value.length} elements: must have 0..${kMostElements}`);
  }
  return Array.from(value);
}

function integers(value, name) {
  return Int32Array.from(list(value, name).map((v, i) => integer(v, `${name}[${i}]`)));
}

function numbers(value, name, length) {
  const values = list(value, name);
  if (values.length !== length) {
    throw new RangeError(`${name} has ${values.length} elements: must have ${length}`);
  }
  return Float64Array.from(values.map((v, i) => number(v, `${name}[${i}]`)));
}

// A field of a struct, by koffi's description of its type.
function field(type, value, name) {
  if (type.primitive in kIntegers) return integer(value, name, type.primitive);
  if (type.primitive === 'Float64') return number(value, name);
  if (type.hint === 'String') {
    const text = string(value, name);
    if (Buffer.byteLength(text) >= type.length) {
      throw new RangeError(`${name} ${show(text)}: must have less than ${type.length} bytes`);
    }
    return text;
  }
  throw new TypeError(`${name}: cannot be set`);
}

// A plain record of the header; what `defaults` does not name must be there.
function record(struct, value, name, defaults) {
  if (value === null || typeof value !== 'object') throw wrong(name, 'an object');
  const out = {};
  for (const { name: key, type } of Object.values(raw.structs[struct].members)) {
    const given = value[key] === undefined ? defaults[key] : value[key];
    out[key] = field(type, given, `${name}.${key}`);
  }
  return out;
}

const kItemDefaults = { flags: 0 };
const kActionDefaults = { item: 0, x: 0, y: 0, rot: 0, arm: 0 };

const item = (value, name = 'item') => record('pkc_item', value, name, kItemDefaults);
const items = (value) => list(value, 'items').map((v, i) => item(v, `items[${i}]`));
const actions = (value) =>
  list(value, 'actions').map((v, i) => record('pkc_action', v, `actions[${i}]`, kActionDefaults));

// A struct with the library's defaults and, over them, what is given.
function options(struct, given, name) {
  const out = {};
  ok(raw[`${struct}_init`](out, koffi.sizeof(raw.structs[struct])));
  if (given === undefined || given === null) return out;
  if (typeof given !== 'object') throw wrong(name, 'an object');
  const { members } = raw.structs[struct];
  for (const key of Object.keys(given)) {
    if (given[key] === undefined) continue;
    if (!Object.hasOwn(members, key) || key === 'struct_size' || key === 'reserved') {
      throw new TypeError(`${name}.${key}: there is no such field`);
    }
    out[key] = field(members[key].type, given[key], `${name}.${key}`);
  }
  return out;
}

// Hashes and seeds do not fit a number: they are BigInts always; counts are numbers always.
function tidy(value) {
  const { struct_size: _size, reserved: _reserved, ...out } = value;
  for (const [key, v] of Object.entries(out)) {
    if (key === 'hash' || key === 'seed') out[key] = BigInt(v);
    else if (typeof v === 'bigint') out[key] = Number(v);
  }
  return out;
}

// What `get` stores in a struct of this type.
function info(struct, get) {
  const out = options(struct);
  ok(get(out));
  return tidy(out);
}

// What `call(array, capacity, count)` gives: first it is asked for the number of elements, then
// for them. `make(n)` gives the array.
function fill(make, call) {
  const count = [0];
  const status = call(null, 0, count);
  if (status !== raw.PKC_OK && status !== raw.PKC_E_CAPACITY) ok(status);
  const out = make(Number(count[0]));
  if (out.length > 0) ok(call(out, out.length, count));
  return out;
}

const objects = (n) => Array.from({ length: n }, () => ({}));

// Names by index, until there is none.
function names(at) {
  const out = [];
  for (let name = at(0); name !== null; name = at(out.length)) out.push(name);
  return out;
}

module.exports = {
  PackcellError, ok, wrong, integer, number, string, bytes, flag, list, integers, numbers, item,
  items, actions, options, info, tidy, fill, objects, names,
};
