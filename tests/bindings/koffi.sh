#!/usr/bin/env bash
# Prints the folder of Node.js modules that has koffi, as bindings/node/package-lock.json names it;
# installs it there when it is not. Status 77 when it cannot be had.
# usage: koffi.sh BUILD_DIR SOURCE_DIR
set -euo pipefail
target=$1/node
lock=$2/bindings/node/package-lock.json
command -v node npm >/dev/null && [ -f "$lock" ] || exit 77

# Several tests may ask at once.
mkdir -p "$target"
exec 9>"$target/lock"
flock 9
if ! cmp -s "$lock" "$target/installed.json"; then
    cp "$lock" "${lock/-lock/}" "$target/"
    if ! (cd "$target" && npm ci --ignore-scripts --no-audit --no-fund) >"$target/log" 2>&1 </dev/null; then
        tail -3 "$target/log" >&2
        exit 77
    fi
    cp "$lock" "$target/installed.json"
fi
echo "$target/node_modules"
