#!/usr/bin/env bash
# The Java classes over JNA: the example plans the golden scenario, and bad input is an exception.
# usage: test_java.sh BUILD_DIR SOURCE_DIR
set -euo pipefail
build=$(realpath "$1")
source=$(realpath "$2")
jna=${PACKCELL_JNA:-/usr/share/java/jna.jar}

missing() {
    echo "$1 is not here"
    [ "${PACKCELL_REQUIRE_CLIENTS:-}" = 1 ] && exit 1
    exit 77
}
command -v javac >/dev/null || missing javac
command -v java >/dev/null || missing java
[ -f "$jna" ] || missing "JNA ($jna)"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PACKCELL_LIBRARY=$build/lib/libpackcell.so.0
expected=$(grep -v '^#' "$source/tests/golden/binding-plan.txt")

# The README's ten lines are compiled and run as well: they print what it says.
readme=$source/bindings/java/README.md
awk '/^```java$/ { on = 1; next } /^```$/ { on = 0 } on' "$readme" >"$work/First.java"
awk '/^    / && after { print substr($0, 5) } /^```$/ { after = 1 } /^\[/ { after = 0 }' \
    "$readme" >"$work/says"

javac -encoding UTF-8 --release 17 -Xlint:all -Werror -cp "$jna" -d "$work/classes" \
    "$source"/bindings/java/src/io/packcell/*.java \
    "$source/bindings/java/examples/PlanGolden.java" "$source"/tests/bindings/java/*.java \
    "$work/First.java"

# Short runs: starting fast is worth more than running fast.
run() { java -XX:TieredStopAtLevel=1 -Xshare:auto -cp "$jna:$work/classes" "$@"; }
got=$(run PlanGolden | tail -1)
if [ "$got" != "$expected" ]; then
    echo "the golden plan in Java is $got, must be $expected"
    exit 1
fi
run First | diff "$work/says" -

# In a locale of ASCII alone, as containers often have: paths are UTF-8 all the same.
LC_ALL=C run Test "$expected" "$work"
[ -s "$work/größe-日本-𝄞" ] || { echo "a path beyond ASCII has become another one"; exit 1; }
