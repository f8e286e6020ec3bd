#!/usr/bin/env bash
# The Rust crates build without the network and without a warning, pass their tests, find the library
# or say what is missing, do what README promises, and plan the golden scenario as every other
# language does.
# usage: test_rust.sh BUILD_DIR SOURCE_DIR
set -euo pipefail
build=$(realpath "$1")
source=$(realpath "$2")

if ! command -v rustc >/dev/null || ! command -v cargo >/dev/null; then
    echo "rustc or cargo is not here"
    [ "${PACKCELL_REQUIRE_CLIENTS:-}" = 1 ] && exit 1
    exit 77
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PACKCELL_LIB_DIR=$build/lib
export LD_LIBRARY_PATH=$build/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
export CARGO_TARGET_DIR=$build/rust
export RUSTFLAGS="-D warnings"
export RUSTDOCFLAGS="-D warnings"

cd "$source/bindings/rust"
cargo build --offline --locked --quiet --workspace --examples
cargo test --offline --locked --quiet -p packcell
cargo doc --offline --locked --quiet --no-deps -p packcell
if cargo clippy --version >/dev/null 2>&1; then
    cargo clippy --offline --locked --quiet --workspace --all-targets
fi

# The build script alone, in folders of its own.
sys() { cargo "$@" --offline --locked -p packcell-sys --target-dir "$work/target" 2>&1; }
fail() {
    echo "$*"
    exit 1
}

for wrong in /no/such/folder "$work" lib; do
    said=$(PACKCELL_LIB_DIR=$wrong sys check) && fail "PACKCELL_LIB_DIR=$wrong is taken"
    grep -q "PACKCELL_LIB_DIR \"$wrong\": must be the absolute path" <<<"$said" || fail "$said"
done

said=$(env -u PACKCELL_LIB_DIR PKG_CONFIG=false cargo doc --offline --locked --no-deps \
    -p packcell-sys --target-dir "$work/target" 2>&1) || fail "no documentation without the library: $said"
grep -q "install libpackcell-dev, or name .* PACKCELL_LIB_DIR" <<<"$said" || fail "$said"

if command -v pkg-config >/dev/null; then
    printf 'Name: packcell\nDescription: packcell\nVersion: 0\nLibs: -L%s -lpackcell\n' \
        "$build/lib" >"$work/packcell.pc"
    said=$(env -u PACKCELL_LIB_DIR PKG_CONFIG_PATH="$work" cargo test --offline --locked \
        -p packcell-sys --target-dir "$work/target" 2>&1) || fail "pkg-config: $said"
fi

# README's ten lines print what it says: the first indented block after each of these lines.
block() {
    awk -v after="$1" 'on && /^    / { print substr($0, 5); seen = 1; next }
        on && seen && NF { exit }
        on && seen
        $0 == after { on = 1 }' README.md
}
mkdir -p "$work/first/src"
block "## Ten lines" >"$work/first/src/main.rs"
printf '[package]\nname = "first"\nversion = "0.1.0"\nedition = "2021"\n[dependencies]\npackcell = { path = "%s/packcell" }\n' \
    "$PWD" >"$work/first/Cargo.toml"
said=$(cargo run --offline --quiet --manifest-path "$work/first/Cargo.toml")
[ "$said" = "$(block "It prints")" ] || fail "README's ten lines print $said"

expected=$(grep -v "^#" "$source/tests/golden/binding-plan.txt")
hash=$(cargo run --offline --locked --quiet -p packcell --example plan_golden)
if [ "$hash" != "$expected" ]; then
    echo "the golden plan has hash $hash: must be $expected"
    exit 1
fi
echo "Rust: $hash"
