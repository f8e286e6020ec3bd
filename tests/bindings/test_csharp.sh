#!/usr/bin/env bash
# The C# classes on Mono: the example plans the golden scenario, and bad input is an exception.
# usage: test_csharp.sh BUILD_DIR SOURCE_DIR
set -euo pipefail
build=$(realpath "$1")
source=$(realpath "$2")

for tool in mcs mono; do
    if ! command -v "$tool" >/dev/null; then
        echo "$tool is not here"
        [ "${PACKCELL_REQUIRE_CLIENTS:-}" = 1 ] && exit 1
        exit 77
    fi
done

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export LD_LIBRARY_PATH=$build/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
expected=$(grep -v '^#' "$source/tests/golden/binding-plan.txt")

compile() { mcs -langversion:7.2 -warn:4 -warnaserror+ "$@"; }
# Not every member needs a comment (1591), but what there is must be XML.
compile -nowarn:1591 -doc:"$work/Packcell.xml" -target:library -out:"$work/Packcell.dll" \
    "$source"/bindings/csharp/Packcell/*.cs
compile -r:"$work/Packcell.dll" -out:"$work/golden.exe" \
    "$source/bindings/csharp/examples/PlanGolden.cs"
compile -r:"$work/Packcell.dll" -out:"$work/test.exe" "$source"/tests/bindings/csharp/*.cs

got=$(mono "$work/golden.exe" | tail -1)
if [ "$got" != "$expected" ]; then
    echo "the golden plan in C# is $got, must be $expected"
    exit 1
fi

# The README's ten lines print what it says.
readme=$source/bindings/csharp/README.md
awk '/^```csharp$/ { on = 1; next } /^```$/ { on = 0 } on' "$readme" >"$work/First.cs"
awk '/^    / && after { print substr($0, 5) } /^```$/ { after = 1 } /^\[/ { after = 0 }' \
    "$readme" >"$work/says"
compile -r:"$work/Packcell.dll" -out:"$work/first.exe" "$work/First.cs"
mono "$work/first.exe" | diff "$work/says" -

mono "$work/test.exe" "$expected" "$work"
