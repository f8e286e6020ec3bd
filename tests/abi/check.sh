#!/usr/bin/env bash
# The library's binary interface beside tests/abi/packcell.abi, by libabigail.
# usage: check.sh LIBRARY SOURCE_DIR [INCLUDE_DIR]   compare; status 1 at any difference
#        check.sh --store LIBRARY SOURCE_DIR         store the interface anew
# The library needs debug information. Only what its header shows counts: what is behind a handle is
# not part of the interface.
set -euo pipefail

store=
if [ "${1:-}" = --store ]; then
    store=1
    shift
fi
library=$1
source=$2
include=${3:-$source/include}
stored=$source/tests/abi/packcell.abi

if ! command -v abidw >/dev/null || ! command -v abidiff >/dev/null; then
    echo "abidw and abidiff are not here (Debian: abigail-tools)"
    exit 77
fi
sections=$(readelf -SW "$library")
if ! grep -q '\.debug_info' <<<"$sections"; then
    echo "$library has no debug information: it must be built with -g"
    exit 1
fi

# Nothing of the machine, of the compiler or of the place in the sources. abidiff is given two such
# descriptions and no headers: with locations on one side alone it would take every type of the other
# for a private one, and be content.
describe() {
    abidw --headers-dir "$include" --drop-private-types --exported-interfaces-only \
        --drop-undefined-syms --no-corpus-path --no-comp-dir-path --no-show-locs --no-elf-needed \
        --no-architecture --type-id-style hash "$library" \
        | sed -E "s/ (language|comp-dir-path)='[^']*'//g; s| path='[^']*/src/| path='src/|"
}

if [ -n "$store" ]; then
    describe >"$stored.new"
    mv "$stored.new" "$stored"
    echo "stored the binary interface in tests/abi/packcell.abi"
    exit
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
describe >"$work/found.abi"
# 1 and 2 are abidiff's own troubles.
status=0
abidiff --harmless "$stored" "$work/found.abi" >"$work/report" || status=$?
if ((status & 3)); then
    cat "$work/report"
    echo "abidiff could not compare"
    exit 1
elif ((status == 0)); then
    echo "the binary interface is the stored one"
    exit
fi
cat "$work/report"
if grep -qE 'summary: [1-9][0-9]* Removed|SONAME changed' "$work/report"; then
    echo "something is gone: programs built before would break; see docs/abi.md on a new soname"
elif grep -qE 'summary: 0 Removed, [1-9][0-9]* Changed' "$work/report"; then
    echo "something is different: programs built before would break, unless it is a field at the end"
    echo "of a struct with struct_size (docs/abi.md); if that is meant: make storeabi"
else
    echo "something is new; if that is meant: make storeabi"
fi
exit 1
