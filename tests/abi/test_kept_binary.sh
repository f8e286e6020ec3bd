#!/usr/bin/env bash
# What was built against the first release's header runs against today's library, and the numbers
# that were compiled into it still mean the same.
set -euo pipefail
build=$1
source=$2
here=$source/tests/abi
first=$here/packcell-0.1.0.h

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Where the library is instrumented the program is too.
flags=()
if grep -q '^PACKCELL_SANITIZE:STRING=address' "$build/CMakeCache.txt"; then
    flags=("-fsanitize=address,undefined")
elif grep -q '^PACKCELL_SANITIZE:STRING=thread' "$build/CMakeCache.txt"; then
    flags=(-fsanitize=thread)
fi
cc -std=c99 -pedantic -Wall -Wextra -Werror "${flags[@]}" "$here/kept.c" -o "$work/kept" \
    -L"$build/lib" -lpackcell -Wl,-rpath,"$(realpath "$build/lib")"
"$work/kept" "$(grep -v '^#' "$source/tests/golden/binding-plan.txt")"

# Names and values, which libabigail does not see; the version is meant to change.
values() {
    sed -nE 's/^#define (PKC_[A-Z0-9_]+) +([^ ].*)$/\1 \2/p' "$1" | sed -E 's| */\*.*||' \
        | grep -vE '^PKC_(VERSION_|API )' | sort
}
values "$first" >"$work/first"
values "$source/include/packcell.h" >"$work/today"
if [ "$(wc -l <"$work/first")" -lt 50 ]; then
    echo "the first release's constants were not read"
    exit 1
fi
if [ -n "$(comm -23 "$work/first" "$work/today")" ]; then
    echo "constants of the first release that are gone or mean something else:"
    comm -23 "$work/first" "$work/today"
    exit 1
fi

# And functions.
functions() { grep -oE '\bpkc_[a-z0-9_]+\(' "$1" | tr -d '(' | sort -u; }
if [ -n "$(comm -23 <(functions "$first") <(functions "$source/include/packcell.h"))" ]; then
    echo "functions of the first release that are gone:"
    comm -23 <(functions "$first") <(functions "$source/include/packcell.h")
    exit 1
fi
