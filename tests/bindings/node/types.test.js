// index.d.ts says what the module exports: no more, no less, methods included.
'use strict';

const test = require('node:test');
const assert = require('node:assert/strict');
const fs = require('node:fs');
const path = require('node:path');
const packcell = require(process.env.PACKCELL_NODE);

const text = fs.readFileSync(path.join(process.env.PACKCELL_NODE, 'index.d.ts'), 'utf8');

test('every export has a type, and every type an export', () => {
  const typed = [...text.matchAll(/^export (?:class|function|const) (\w+)/gm)].map((m) => m[1]);
  assert.deepEqual(typed.sort(), Object.keys(packcell).sort());
});

test('every method has a type, and every type a method', () => {
  const classes = [...text.matchAll(/^export class (\w+) extends Handle \{\n(.*?)^\}/gms)];
  assert.equal(classes.length, 8);
  for (const [, name, body] of classes) {
    const typed = [...body.matchAll(/^ {2}(?:static |readonly )*(\w+)[(:]/gm)].map((m) => m[1]);
    const type = packcell[name];
    const own = Object.getOwnPropertyNames(type.prototype);
    const shared = Object.getOwnPropertyNames(type).filter(
      (key) => !['length', 'name', 'prototype'].includes(key));
    const real = [...own, ...shared].filter((key) => key !== 'constructor');
    const said = typed.filter((key) => !['constructor', 'private'].includes(key));
    assert.deepEqual([...new Set(said)].sort(), [...new Set(real)].sort(), name);
  }
});
