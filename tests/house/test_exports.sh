#!/usr/bin/env bash
# The shared library exports exactly the functions that packcell.h declares with PKC_API.
set -euo pipefail
build=$1
source=$2

declared=$(sed '/^ *#/d' "$source/include/packcell.h" | tr '\n' ' ' \
    | grep -oE '\bPKC_API [^;(]*\(' | grep -oE '\bpkc_[a-z0-9_]+\($' | tr -d '(' | sort)
# Type A is the version node itself.
exported=$(nm -D --defined-only "$build/lib/libpackcell.so" \
    | awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' | sort)

if [ -z "$declared" ]; then
    echo "no declaration found in include/packcell.h"
    exit 1
fi
if ! diff <(echo "$declared") <(echo "$exported"); then
    echo "'<' is declared in packcell.h but not exported, '>' is exported but not declared there"
    exit 1
fi
