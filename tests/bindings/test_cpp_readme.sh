#!/usr/bin/env bash
# The README's ten lines of C++ print what it says, compiled by C++17 and by C++20.
set -euo pipefail
build=$(realpath "$1")
readme=$(realpath "$2")/bindings/README.md

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
awk '/^```cpp/ { on = 1; next } /^```/ { on = 0 } on' "$readme" >"$work/first.cpp"
expected=$(grep -oP '^prints `\K[^`]+' "$readme" | head -1)
for standard in c++17 c++20; do
    ${CXX:-c++} -std=$standard -Wall -Wextra -Wpedantic -Werror -I"$(dirname "$readme")/../include" \
        "$work/first.cpp" -o "$work/first" -L"$build/lib" -lpackcell -Wl,-rpath,"$build/lib"
    said=$("$work/first")
    if [ "$said" != "$expected" ]; then
        echo "$standard: the README's program prints '$said', not '$expected'"
        exit 1
    fi
done
