#!/usr/bin/env bash
# The Python package: its tests with NumPy and without, the golden plan, its types, its benchmark,
# and an installation without the network. Arguments: BUILD SOURCE.
set -euo pipefail
build=$(realpath "$1")
source=$(realpath "$2")
package=$source/bindings/python
python=/usr/bin/python3
[ -x "$python" ] || python=$(command -v python3)

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PACKCELL_LIBRARY=$build/lib/libpackcell.so.0
export PYTHONDONTWRITEBYTECODE=1
export MPLCONFIGDIR=$work/matplotlib
export PYTHONPATH=$package

# A tool that is not here is a fault only where all of them must be.
missing() {
    echo "$1 is not here"
    [ "${PACKCELL_REQUIRE_CLIENTS:-}" != 1 ]
}

if "$python" -c "import numpy, matplotlib" 2>/dev/null; then
    tests=$source/tests/bindings/python
    "$python" -W error::ResourceWarning -m unittest discover -q -s "$tests"
    # The environments once more as Gymnasium's: its own classes where it is, else what stands in.
    PYTHONPATH=$package$("$python" -c "import gymnasium" 2>/dev/null || echo ":$tests/standin") \
        "$python" -m unittest discover -q -s "$tests" -p test_env.py
    "$python" "$package/benchmark_env.py" --seconds 0.5 --at-least 100000
else
    missing "NumPy with matplotlib"
fi
PACKCELL_TEST_NO_NUMPY=1 "$python" -m unittest discover -q -s "$source/tests/bindings/python"

golden() {
    local hash
    hash=$("$python" "$package/examples/plan_golden.py")
    if [ "$hash" != 6cf41b3d36c96b2f ]; then
        echo "plan_golden.py printed $hash, not 6cf41b3d36c96b2f"
        exit 1
    fi
}
golden

# The README's program prints what the README says.
awk '/^```python/ { on = 1; next } /^```/ { on = 0 } on' "$package/README.md" >"$work/readme.py"
awk '/^```text/ { on = 1; next } /^```/ { on = 0 } on' "$package/README.md" >"$work/expected"
"$python" "$work/readme.py" >"$work/printed"
diff "$work/expected" "$work/printed"

cp -r "$package" "$work/source"
PYTHONPYCACHEPREFIX=$work/compiled "$python" -m compileall -q "$work/source"
if command -v mypy >/dev/null; then
    cp "$source/tests/bindings/python/typed_use.py" "$work/source"
    (cd "$work/source" && mypy --cache-dir "$build/python/mypy" packcell typed_use.py)
else
    missing mypy
fi

if "$python" -c "import setuptools, wheel, pip" 2>/dev/null; then
    "$python" -m pip install --quiet --no-index --no-build-isolation --no-deps --no-compile \
        --disable-pip-version-check --root-user-action ignore --no-cache-dir \
        --target "$work/installed" "$work/source"
    [ -f "$work/installed/packcell/py.typed" ]
    PYTHONPATH=$work/installed golden
else
    missing "pip with setuptools and wheel"
fi
