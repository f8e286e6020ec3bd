#!/usr/bin/env bash
# The header's binary interface is the stored one, and a change of it would not go unseen. What is
# compared is a library of empty functions; `make checkabi` compares the real one.
set -euo pipefail
source=$(realpath "$2")
here=$source/tests/abi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for tool in abidw abidiff; do
    if ! command -v $tool >/dev/null; then
        echo "$tool is not here (Debian: abigail-tools)"
        [ "${PACKCELL_REQUIRE_CLIENTS:-}" = 1 ] && exit 1
        exit 77
    fi
done

# judge FOLDER: a library with the interface of FOLDER/packcell.h beside the stored one
judge() {
    python3 "$here/stub.py" "$1/packcell.h" >"$1/stub.c"
    cc -std=c99 -g -shared -fPIC "$1/stub.c" -o "$1/libpackcell.so.0" -Wl,-soname,libpackcell.so.0 \
        -Wl,--version-script="$source/src/capi/packcell.map"
    "$here/check.sh" "$1/libpackcell.so.0" "$source" "$1"
}

mkdir "$work/today"
cp "$source/include/packcell.h" "$work/today/"
if ! judge "$work/today"; then
    echo "include/packcell.h is not what tests/abi/packcell.abi holds"
    exit 1
fi

failures=0
# mutate WHAT VERDICT SED_SCRIPT: the header, changed so, must be refused with that verdict
mutate() {
    local folder=$work/mutant
    rm -rf "$folder"
    mkdir "$folder"
    sed -E "$3" "$source/include/packcell.h" >"$folder/packcell.h"
    if cmp -s "$source/include/packcell.h" "$folder/packcell.h"; then
        echo "$1: the header has no such line any more, so nothing was changed"
        failures=$((failures + 1))
    elif judge "$folder" >"$folder/said"; then
        echo "$1: unseen"
        failures=$((failures + 1))
    elif ! grep -q "$2" "$folder/said"; then
        echo "$1: refused, but not because it is so: $(tail -1 "$folder/said")"
        failures=$((failures + 1))
    fi
}

gone="is gone"
different="is different"
new="is new"
mutate "a moved field" "$different" \
    '/^typedef struct pkc_placement/,/^}/ { s/ x;/ swapped;/; s/ y;/ x;/; s/ swapped;/ y;/ }'
mutate "a field moved to the end of a versioned struct" "$different" \
    '/^typedef struct pkc_budget/,/^}/ { /uint64_t nodes;/d; s/^(.*double milliseconds;.*)$/\1\n    uint64_t nodes;/ }'
mutate "a frozen record that grows" "$different" \
    '/^typedef struct pkc_item/,/^}/ s/^(.*flags;.*)$/\1\n    int32_t weight;/'
mutate "a field of another type" "$different" \
    '/^typedef struct pkc_plan_info/,/^}/ s/int64_t score;/double score;/'
mutate "an inner array that grows" "$different" 's/^#define PKC_MAX_JOINTS 6/#define PKC_MAX_JOINTS 7/'
mutate "a parameter of another type" "$different" \
    's/pkc_bin_create\(int32_t w, int32_t h/pkc_bin_create(int64_t w, int32_t h/'
mutate "a parameter more" "$different" 's/pkc_bin_clear\(pkc_bin \*bin\)/pkc_bin_clear(pkc_bin *bin, int32_t how)/'
mutate "a function that is gone" "$gone" '/^PKC_API pkc_status pkc_bin_clear/d'
mutate "a function more" "$new" \
    's/^(PKC_API void pkc_bin_free.*)$/\1\nPKC_API pkc_status pkc_bin_shrink(pkc_bin *bin);/'
[ "$failures" = 0 ]
