#!/usr/bin/env bash
# What arm64_report prints on this machine beside what it prints under qemu.
# usage: check.sh BUILD BUILD_FOR_ARM64
set -euo pipefail
here=$(dirname "$0")
weights=$here/../../src/policy/weights

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$1/tests/arm64_report" "$weights" >"$work/here"
for run in there again; do
    qemu-aarch64 "$2/tests/arm64_report" "$weights" >"$work/$run"
done
"$here/compare.py" "$work/here" "$work/there" "$work/again"
