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

test('import gives the same names, and the same things, as require', async () => {
  const imported = await import(path.join(process.env.PACKCELL_NODE, 'index.mjs'));
  assert.equal(imported.default, packcell);
  const { default: _, ...named } = imported;
  assert.deepEqual({ ...named }, { ...packcell });
});

test('it may be loaded twice in a process, as test runners do', () => {
  const here = fs.realpathSync(process.env.PACKCELL_NODE) + path.sep;
  for (const file of Object.keys(require.cache)) {
    if (file.startsWith(here) && !file.includes('node_modules')) delete require.cache[file];
  }
  const again = require(process.env.PACKCELL_NODE);
  assert.notEqual(again.Bin, packcell.Bin);
  assert.equal(new again.Bin(3, 4).info().w, 3);
});
