#!/usr/bin/env bash
# Cell descriptions: they come back as they went, and wrong ones end in one line that names field
# and value; nothing reaches the simulation unchecked.
here=$(dirname "$0")
# shellcheck source=tests/programs/common.sh
source "$here/common.sh" "$@"

sim=$(find_program packcell-sim)
if [ -z "$sim" ]; then
    echo "packcell-sim is not under $build"
    exit 1
fi

"$sim" --print-cell >"$work/cell.json" 2>"$work/stderr" || true
if grep -q 'PACKCELL_CELL=OFF' "$work/stderr"; then
    echo "the library is built without the cell"
    exit 77
fi

# rejects PATTERN OPTION...: fails.
rejects() {
    local pattern=$1
    shift
    expect_error 1 "^packcell-sim: $pattern" "$*" "$sim" "$@"
}

# hashes OPTION...: of schedule and simulation, a line a bin.
hashes() {
    "$sim" --json "$@" | grep -oE '"(schedule_)?hash":"[0-9a-f]{16}"'
}

# ---- There and back ------------------------------------------------------------------------------
for cell in ur5e paper piper scara; do
    "$sim" --cell $cell --print-cell >"$work/cell.json" || fail "$cell: --print-cell"
    hashes --cell $cell >"$work/a"
    hashes --cell "$work/cell.json" >"$work/b"
    cmp -s "$work/a" "$work/b" || fail "$cell: its description gives other hashes"
    "$sim" --cell "$work/cell.json" --print-cell | cmp -s - "$work/cell.json" ||
        fail "$cell: its description changes"
done
"$sim" --print-cell >"$work/cell.json"
(cd "$work" && "$sim" --cell cell.json --quiet) || fail 'a description in the folder at hand'
"$sim" --layout "$work/better.json" >"$work/text" || fail '--layout'
grep -qE '^mean transfer [0-9.]+ s before, [0-9.]+ s after [0-9]+ evaluations; cell in ' \
    "$work/text" || fail "--layout says $(head -1 "$work/text")"
hashes --layout "$work/other.json" >"$work/a"
hashes --cell "$work/better.json" >"$work/b"
cmp -s "$work/a" "$work/b" || fail '--layout: the cell written is not the one used'

# ---- One mistake each ----------------------------------------------------------------------------
# changed SCRIPT PATTERN: the description that the sed script makes is rejected.
changed() {
    sed -E "$1" "$work/cell.json" >"$work/bad.json"
    ! cmp -s "$work/cell.json" "$work/bad.json" || fail "'$1' changes nothing"
    rejects "$work/bad.json: $2" --cell "$work/bad.json"
}
changed 's/("speed": )[^,]*/\10/' 'belt\.speed 0: must be'
changed 's/("speed": )[^,]*/\1-0.5/' 'belt\.speed -0\.5: must be'
changed 's/("speed": )[^,]*/\1NaN/' 'line [0-9]+, column [0-9]+: is not JSON'
changed 's/("speed": )[^,]*/\11e999/' 'a number is too large'
changed 's/("speed": )[^,]*/\1"fast"/' 'belt\.speed "fast": must be a number'
changed '/"speed": /d' 'belt\.speed: missing'
changed 's/("speed": )[^,]*/\11, "colour": 2/' 'belt: unknown field "colour"'
changed 's/("speed": )[^,]*/\11, "speed": 2/' 'field "speed": given twice'
changed 's/("x": )[^,]*/\1-0.52/; s/("y": )[^,]*/\10.09/' \
    'arms\[1\]\.base: 0\.000 m from arms\[0\]\.base: must be at least'
changed '/"bin"/,/w_mm/s/("centre": )[^]]*/\1[0.0, -3.0/' 'arms\[0\]: does not reach bin cell'
changed 's/("version": )1/\12/' 'version 2: must be 1'
changed 's/("model": )"ur5e"/\1"kuka"/' \
    'arms\[0\]\.model "kuka": must be ur5e, piper, scara, or an object'
head -c 700 "$work/cell.json" >"$work/bad.json"
rejects "$work/bad.json: line [0-9]+, column [0-9]+: is not JSON" --cell "$work/bad.json"
: >"$work/bad.json"
rejects "$work/bad.json: line 1, column 1: is not JSON" --cell "$work/bad.json"
head -c 2000000 /dev/zero >"$work/bad.json"
rejects '.*bad.json' --cell "$work/bad.json"
rejects '.*nowhere/c.json.*: No such file' --cell "$work/nowhere/c.json"
rejects '.*: Is a directory' --cell "$work/"
rejects 'scenario D-R9A5O1: arms\[0\]: does not reach belt zone' --scenario D-R9A5O1

# ---- Many mistakes -------------------------------------------------------------------------------
# Every number of a description replaced by what is wrong or extreme. Whatever is accepted is
# packed and simulated; nothing is killed by a signal, nothing hangs.
python3 - "$sim" "$work" <<'PYTHON' || fail 'changed cell descriptions'
import json, re, subprocess, sys

sim, work = sys.argv[1:]
values = ["0", "-1", "1e308", "1e-308", '"x"', "null", "NaN"]
degrees = lambda least, most, velocity, acceleration: {
    "least_deg": least, "most_deg": most, "velocity_deg": velocity,
    "acceleration_deg": acceleration, "sign": 1, "zero_deg": 0}
model = {"name": "own", "kind": "scara", "joints": [
    degrees(-150, 150, 229, 687), degrees(-148, 148, 343, 1145),
    {"least": -0.32, "most": 0, "velocity": 1, "acceleration": 8, "sign": 1, "zero": -0.3},
    degrees(-360, 360, 687, 3437)],
    "shoulder": 0.4, "upper": 0.45, "fore": 0.35, "wrist": 0, "lateral": 0, "drop": 0, "tool": 0.1,
    "least_reach": 0.25, "most_reach": 0.8, "body_radius": 0.075, "tool_radius": 0.05}
number = re.compile(r"(?<![\w\"])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w\"])")

def run(text, what):
    with open(work + "/mutant.json", "w") as file:
        file.write(text)
    try:
        done = subprocess.run([sim, "--cell", work + "/mutant.json", "--json"], timeout=120,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    except subprocess.TimeoutExpired:
        sys.exit(what + ": hangs")
    if done.returncode not in (0, 1):
        sys.exit("%s: exit code %d: %s" % (what, done.returncode, done.stderr[:300]))
    if done.returncode == 1:
        lines = done.stderr.splitlines()
        if len(lines) != 1 or not lines[0].startswith("packcell-sim: ") or len(lines[0]) > 600:
            sys.exit("%s: stderr: %s" % (what, done.stderr[:300]))
    else:
        row = json.loads(done.stdout)
        if not 0 < row["makespan"] < 1e6 or done.stderr:
            sys.exit("%s: makespan %s" % (what, row["makespan"]))
    return done.returncode

counts = [0, 0]
for cell in ("ur5e", "scara"):
    text = subprocess.run([sim, "--cell", cell, "--print-cell"], check=True,
                          stdout=subprocess.PIPE, text=True).stdout
    start = 0
    if cell == "scara":
        text = text.replace('"model": "scara"', '"model": ' + json.dumps(model), 1)
        if run(text, "own SCARA") != 0:
            sys.exit("an arm's own figures are not accepted")
        # The rest of this one was changed with the other arms.
        start = text.index('"own"')
        spots = [m for m in number.finditer(text) if start < m.start() < text.index('"base"')]
    else:
        spots = list(number.finditer(text))
    for spot in spots:
        for value in values:
            what = "%s: %s -> %s" % (cell, text[max(0, spot.start() - 30):spot.end()], value)
            counts[run(text[:spot.start()] + value + text[spot.end():], what)] += 1
print("%d changed descriptions: %d accepted, %d rejected" % (sum(counts), *counts))
sys.exit(sum(counts) < 200)
PYTHON
finish
