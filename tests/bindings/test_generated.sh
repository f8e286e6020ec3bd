#!/usr/bin/env bash
# What is checked in under bindings/ is what the header gives, and every language lays out the
# structs as the C compiler does.
set -euo pipefail
build=$(realpath "$1")
source=$(realpath "$2")
layout=$source/tests/bindings/layout

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PACKCELL_LIBRARY=$build/lib/libpackcell.so.0
export LD_LIBRARY_PATH=$build/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
export PYTHONDONTWRITEBYTECODE=1

failures=0
fail() {
    echo "$*"
    failures=$((failures + 1))
}

# A tool that is not here is a fault only where all of them must be.
missing() {
    echo "$1 is not here"
    if [ "${PACKCELL_REQUIRE_CLIENTS:-}" = 1 ]; then failures=$((failures + 1)); fi
}

generate() { python3 "$source/bindings/generate.py" "$@"; }

if ! command -v clang >/dev/null; then
    missing clang
    [ "$failures" = 0 ] && exit 77
    exit 1
fi

generate --check || fail "the checked-in files are stale"

# A header with a function more makes every file stale.
mkdir "$work/tree"
cp -r "$source/include" "$work/tree/"
(cd "$source" && cp --parents bindings/generate.py bindings/generate/*.py bindings/api.json \
    bindings/*/packcell/_raw.py bindings/rust/packcell-sys/src/lib.rs bindings/csharp/Packcell/Raw.cs \
    bindings/java/src/io/packcell/Raw.java bindings/node/raw.js "$work/tree")
sed -i 's/^PKC_API void pkc_bin_free.*/&\nPKC_API pkc_status pkc_bin_turn(pkc_bin *bin);/' \
    "$work/tree/include/packcell.h"
stale=$(python3 "$work/tree/bindings/generate.py" --check | grep -c ' is not what ' || true)
if [ "$stale" != 6 ]; then fail "a function more makes $stale of 6 files stale"; fi

# An instrumented library cannot be loaded by what is not.
if grep -qE '^PACKCELL_SANITIZE:STRING=.+' "$build/CMakeCache.txt"; then
    echo "the languages' layouts are compared in the plain build"
    [ "$failures" = 0 ]
    exit
fi

generate --layout >"$work/expected"
if [ "$(wc -l <"$work/expected")" -lt 100 ]; then
    fail "only $(wc -l <"$work/expected") lines of layout: the header was not read"
fi

# judge LANGUAGE COMMAND...: the command prints a language's layout
judge() {
    local language=$1
    shift
    if ! "$@" >"$work/lines" 2>"$work/errors"; then
        fail "$language: the layout cannot be printed: $(tail -3 "$work/errors")"
    elif ! generate --layout-check <"$work/lines"; then
        fail "$language lays out the structs in another way than the C compiler"
    else
        echo "$language: $(wc -l <"$work/lines") sizes and offsets agree"
    fi
}

# The check itself must see a moved field and a missing one.
sed 's/^pkc_plan_info\.score .*/pkc_plan_info.score 48/' "$work/expected" >"$work/moved"
if generate --layout-check <"$work/moved" >/dev/null; then fail "a moved field goes unseen"; fi
grep -v '^pkc_budget\.nodes ' "$work/expected" >"$work/fewer"
if generate --layout-check <"$work/fewer" >/dev/null; then fail "a missing field goes unseen"; fi

PYTHONPATH=$source/bindings/python judge Python python3 "$layout/layout.py"

if command -v rustc >/dev/null; then
    bash "$layout/rust.sh" "$source/bindings/rust/packcell-sys/src/lib.rs" \
        <"$work/expected" >"$work/layout.rs"
    rust() {
        rustc --edition 2021 -L "$build/lib" -o "$work/rust" "$work/layout.rs" && "$work/rust"
    }
    judge Rust rust
else
    missing rustc
fi

if command -v mcs >/dev/null && command -v mono >/dev/null; then
    csharp() {
        mcs -warnaserror+ -out:"$work/layout.exe" "$layout/Layout.cs" \
            "$source/bindings/csharp/Packcell/Raw.cs" && mono "$work/layout.exe"
    }
    judge C# csharp
else
    missing Mono
fi

jna=${PACKCELL_JNA:-/usr/share/java/jna.jar}
if command -v javac >/dev/null && [ -f "$jna" ]; then
    java_layout() {
        javac -Xlint:all -Werror -cp "$jna" -d "$work/java" \
            "$source/bindings/java/src/io/packcell/Raw.java" "$layout/Layout.java" \
            && java -cp "$jna:$work/java" Layout
    }
    judge Java java_layout
else
    missing "javac with JNA"
fi

if modules=$("$BASH" "$source/tests/bindings/koffi.sh" "$build" "$source"); then
    NODE_PATH=$modules judge Node.js node "$layout/layout.js" "$source/bindings/node/raw.js"
else
    missing koffi
fi

[ "$failures" = 0 ]
