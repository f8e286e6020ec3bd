#!/usr/bin/env bash
# The Rust crates build without the network and without a warning, pass their tests, and plan the
# golden scenario as every other language does.
# usage: test_rust.sh BUILD_DIR SOURCE_DIR
set -euo pipefail
build=$(realpath "$1")
source=$(realpath "$2")

if ! command -v rustc >/dev/null || ! command -v cargo >/dev/null; then
    echo "rustc or cargo is not here"
    [ "${PACKCELL_REQUIRE_CLIENTS:-}" = 1 ] && exit 1
    exit 77
fi

export PACKCELL_LIB_DIR=$build/lib
export LD_LIBRARY_PATH=$build/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
export CARGO_TARGET_DIR=$build/rust
export RUSTFLAGS="-D warnings"
export RUSTDOCFLAGS="-D warnings"

cd "$source/bindings/rust"
cargo build --offline --locked --quiet --workspace --examples
cargo test --offline --locked --quiet -p packcell

expected=$(grep -v "^#" "$source/tests/golden/binding-plan.txt")
hash=$(cargo run --offline --locked --quiet -p packcell --example plan_golden)
if [ "$hash" != "$expected" ]; then
    echo "the golden plan has hash $hash: must be $expected"
    exit 1
fi
echo "Rust: $hash"
