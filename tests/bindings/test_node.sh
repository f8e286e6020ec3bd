#!/usr/bin/env bash
# The classes for Node.js do what the header says, refuse bad input, do what README promises, and
# plan the golden scenario as every other language does; every export has a type and every type an
# export.
# usage: test_node.sh BUILD_DIR SOURCE_DIR
set -euo pipefail
build=$(realpath "$1")
source=$(realpath "$2")

missing() {
    echo "$1"
    [ "${PACKCELL_REQUIRE_CLIENTS:-}" = 1 ] && exit 1
    exit 77
}

command -v node >/dev/null || missing "node is not here"
command -v npm >/dev/null || missing "npm is not here"
NODE_PATH=$("$BASH" "$source/tests/bindings/koffi.sh" "$build" "$source") \
    || missing "koffi is not here"
export NODE_PATH
export PACKCELL_LIBRARY=$build/lib/libpackcell.so.0
export PACKCELL_NODE=$source/bindings/node

failures=0
for file in "$source"/tests/bindings/node/*.test.js; do
    if ! node --expose-gc "$file" >"$build/node/test.log" 2>&1; then
        cat "$build/node/test.log"
        failures=$((failures + 1))
    else
        echo "$(basename "$file"): $(grep -E '^. pass|^# pass' "$build/node/test.log")"
    fi
done

# README's ten lines print what it says: the first indented block after each of these lines. They run
# in a folder that has the package as npm installs it.
block() {
    awk -v after="$1" 'on && /^    / { print substr($0, 5); seen = 1; next }
        on && seen && NF { exit }
        on && seen
        $0 == after { on = 1 }' "$PACKCELL_NODE/README.md"
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/node_modules"
ln -s "$PACKCELL_NODE" "$work/node_modules/packcell"
block "## Ten lines" >"$work/first.js"
said=$(node "$work/first.js")
if [ "$said" != "$(block "It prints")" ]; then
    echo "README's ten lines print $said"
    failures=$((failures + 1))
fi
echo "import { Bin, PKC_OK } from 'packcell'; import raw from 'packcell/raw.js';
new Bin(1, PKC_OK + 1).close(); raw.pkc_version();" >"$work/first.mjs"
if ! node "$work/first.mjs"; then
    echo "import does not give what require gives"
    failures=$((failures + 1))
fi

expected=$(grep -v "^#" "$source/tests/golden/binding-plan.txt")
hash=$(node "$PACKCELL_NODE/examples/plan_golden.js")
if [ "$hash" != "$expected" ]; then
    echo "the golden plan has hash $hash: must be $expected"
    failures=$((failures + 1))
else
    echo "Node.js: $hash"
fi
[ "$failures" = 0 ]
