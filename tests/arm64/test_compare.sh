#!/usr/bin/env bash
# What `make check-arm64` compares, tried on this machine alone: two runs are equal, the golden hash is
# the one of the other languages, and a report that differs is refused.
set -euo pipefail
build=$(realpath "$1")
source=$(realpath "$2")
compare=$source/tests/arm64/compare.py

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
fail() {
    echo "$*"
    failures=$((failures + 1))
}

for run in here there; do
    "$build/tests/arm64_report" "$source/src/policy/weights" >"$work/$run"
done
"$compare" "$work/here" "$work/there" "$work/there" || fail "two runs on one machine differ"
golden=$(grep -v '^#' "$source/tests/golden/binding-plan.txt")
grep -qx "golden $golden" "$work/here" || fail "$(head -1 "$work/here"): expected golden $golden"

# refused WHAT SED_SCRIPT [SED_SCRIPT_AGAIN]: a report changed so, by one machine or in its second run
refused() {
    sed -E "$2" "$work/here" >"$work/there"
    sed -E "${3-$2}" "$work/here" >"$work/again"
    if cmp -s "$work/here" "$work/there" && cmp -s "$work/here" "$work/again"; then
        fail "$1: nothing was changed"
    elif "$compare" "$work/here" "$work/there" "$work/again" >"$work/said"; then
        fail "$1: taken for the same"
    fi
}
refused "a plan of another hash" '/^plan contact S-R5A3 off/s/ [0-9a-f]{16} / 0123456789abcdef /'
refused "a plan of other nodes" '/^plan skyline D-R5A3O1 full/s/ ([0-9]+) ([0-9]+)$/ \19 \2/'
refused "another golden hash" 's/^golden ./golden g/'
refused "a network that is off by 0.01" '/^net a3c 0 3x3/s/ ([0-9]+) -?[0-9.]+ / \1 7.77 /'
refused "a network that says nan" '/^net fcn 5 1x1/s/ ([0-9]+) -?[0-9.]+ / \1 nan /'
refused "another position" '/^net fcn 2 2x5/s/2x5 [0-9]+/2x5 999/'
refused "a fact that is missing" '/^plan default S-R1A1 off/d'
refused "no cells at all" '/^cell/d'
refused "a simulation that does not repeat" '' '/^cell ur5e 1/s/[0-9a-f]{16}$/0123456789abcdef/'
[ "$failures" = 0 ]
