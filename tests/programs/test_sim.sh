#!/usr/bin/env bash
# packcell-sim: every preset and mode packs; what it writes is well-formed and says the same in each
# place; mistakes, interrupts and closed pipes end as in the other programs.
# shellcheck disable=SC2016 # inner shells expand their own arguments
here=$(dirname "$0")
# shellcheck source=tests/programs/common.sh
source "$here/common.sh" "$@"
set -m # a job of its own gets the signals that a shell's background job would ignore

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

# gives WHAT CONDITION OPTION...: JSON lines of which the Python expression over `rows` is true.
gives() {
    local what=$1 condition=$2 status=0
    shift 2
    "$sim" "$@" --json >"$work/json" 2>"$work/stderr" || status=$?
    [ "$status" = 0 ] || fail "$what: exit code $status: $(head -1 "$work/stderr")"
    [ ! -s "$work/stderr" ] || fail "$what: stderr: $(head -1 "$work/stderr")"
    holds "$what" "$condition"
}

# holds WHAT CONDITION: of the JSON written last.
holds() {
    python3 - "$work/json" "$1" "$2" <<'PYTHON' || fail "$1"
import json, sys

def refuse(text):
    raise ValueError("%s is no JSON" % text)

with open(sys.argv[1]) as file:
    rows = [json.loads(line, parse_constant=refuse) for line in file]
for row in rows:
    for arm in row["arms"]:
        times = [arm["travel"], arm["strokes"], arm["grips"]] + list(arm["waits"].values())
        assert min(times) >= 0, "a time is negative"
        assert abs(sum(times) - row["makespan"]) < 1e-4, "times do not add up to the makespan"
        busy = 1 - sum(arm["waits"].values()) / row["makespan"]
        assert abs(busy - arm["busy"]) < 1e-5, "busy"
    assert row["lower_bound"] <= row["makespan"] + 1e-6, "below the lower bound"
    assert abs(row["makespan"] / row["lower_bound"] - 1 - row["gap"]) < 1e-5, "gap"
if not eval("(" + sys.argv[3] + ")"):
    sys.exit("%s: not so: %s" % (sys.argv[2], sys.argv[3]))
PYTHON
}

# refuses PATTERN OPTION...: bad usage.
refuses() {
    local pattern=$1
    shift
    expect_error 2 "^packcell-sim: $pattern" "$*" "$sim" "$@"
}

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

# ---- Help ----------------------------------------------------------------------------------------
"$sim" --help >"$work/text" || fail '--help'
for option in --cell --in --kind --preset --count --seed --scenario --rotation --repack --policy \
    --method --budget-ms --budget-nodes --select --buffer --mode --sigma --sigma-yaw --hertz \
    --simulate --feedback --out --period --episodes --layout --print-cell --json --quiet \
    'Exit codes'; do
    grep -q -e "$option" "$work/text" || fail "--help: nothing about $option"
done
[ "$(wc -L <"$work/text")" -le 100 ] || fail '--help: a line of more than 100 columns'
"$sim" --version | grep -qE '^packcell-sim [0-9.]+$' || fail '--version'

# ---- Every preset, every mode --------------------------------------------------------------------
for cell in ur5e paper piper scara; do
    for mode in sync mutex coordinated; do
        gives "$cell, $mode" \
            "len(rows) == 2 and all(row['cell'] == '$cell' and row['packed'] > 0
                 and row['simulation']['jams'] == row['simulation']['misplaced'] == 0
                 and row['simulation']['places'] == row['packed'] + row['unpacked']
                 and row['simulation']['worst_error_mm'] <= 0.1
                 and row['simulation']['missed_arrivals'] == 0
                 and row['min_clearance'] > 0.01 for row in rows)" \
            --cell $cell --mode $mode --count 2 --seed 5
        cp "$work/json" "$work/$mode.json"
    done
    python3 - "$work"/{coordinated,mutex,sync}.json <<'PYTHON' || fail "$cell: a looser mode takes longer"
import json, sys
spans = [[json.loads(line)["makespan"] for line in open(name)] for name in sys.argv[1:]]
sys.exit(not all(a <= b + 1e-6 and b <= c + 1e-6 for a, b, c in zip(*spans)))
PYTHON
done
gives 'one arm' \
    "all(len(row['arms']) == 1 and row['min_clearance'] is None
         and row['arms'][0]['waits']['other_arm'] == 0 for row in rows)" \
    --scenario S-R5A3 --repack full --count 2
gives 'random bins' "len(rows) == 3 and all(row['utilization'] > 0.8 for row in rows)" \
    --kind random --count 3
gives 'no simulation' "rows[0]['simulation'] is None" --simulate off
gives 'coarse steps' "rows[0]['simulation']['worst_error_mm'] <= 0.1" --hertz 60

# ---- Equal work, equal hashes --------------------------------------------------------------------
hashes --count 2 --seed 7 >"$work/a"
hashes --count 2 --seed 7 >"$work/b"
[ "$(wc -l <"$work/a")" = 4 ] || fail 'two bins have four hashes'
cmp -s "$work/a" "$work/b" || fail 'a second run has other hashes'
hashes --count 2 --seed 8 >"$work/b"
! cmp -s "$work/a" "$work/b" || fail 'another seed has the same hashes'
"$gen" --kind full --count 2 --seed 7 --out "$work/sets.jsonl"
hashes --in "$work/sets.jsonl" >"$work/b"
cmp -s "$work/a" "$work/b" || fail "packcell-gen's sets have other hashes than the program's own"
hashes --in - <"$work/sets.jsonl" >"$work/b"
cmp -s "$work/a" "$work/b" || fail 'standard input has other hashes'
hashes --count 1 --sigma .3 --seed 7 >"$work/a"
hashes --count 1 --sigma .3 --seed 7 >"$work/b"
cmp -s "$work/a" "$work/b" || fail 'a second run with noise has other hashes'

# ---- Files ---------------------------------------------------------------------------------------
"$sim" --out "$work/one" --seed 3 --json >"$work/json" || fail '--out'
"$sim" --out "$work/two" --count 2 --seed 3 --sigma .2 --period .05 --quiet || fail '--out, two bins'
"$sim" --out "$work/single" --scenario S-R5A3 --quiet || fail '--out, one arm'
"$sim" --out "$work/from" --in "$work/sets.jsonl" --quiet || fail '--out beside --in'
"$sim" --out "$work/blind" --simulate off --quiet || fail '--out without simulation'
[ ! -e "$work/single/joints-1.csv" ] || fail 'one arm has the joints of two'
touch "$work/single/joints-1.csv"
python3 - "$work/json" "$work"/{one,single,blind,two/bin-0001,two/bin-0002,from/bin-0001,from/bin-0002} \
    <<'PYTHON' || fail 'what --out writes'
import csv, json, math, sys, xml.etree.ElementTree
from html.parser import HTMLParser

row = json.loads(open(sys.argv[1]).readline())
for folder in sys.argv[2:]:
    trace = json.load(open(folder + "/trace.json"))
    events = trace["traceEvents"] if isinstance(trace, dict) else trace
    assert len(events) > 20, folder + ": few events"
    for name in ("gantt.svg", "bin.svg"):
        xml.etree.ElementTree.parse(folder + "/" + name)
    page = open(folder + "/replay.html", encoding="utf-8").read()
    assert page.lower().startswith("<!doctype html>"), folder + ": no page"
    HTMLParser().feed(page)
    for name in ("timeline.csv", "joints-0.csv", "joints-1.csv"):
        with open(folder + "/" + name, newline="") as file:
            rows = list(csv.reader(file))
        if not rows and folder.endswith("single"):
            continue
        assert len(rows) > 100, name + ": few rows"
        assert len({len(r) for r in rows}) == 1, name + ": rows of several lengths"
        times = [float(r[0]) for r in rows[1:]]
        assert times[0] == 0 and all(a < b for a, b in zip(times, times[1:])), name + ": times"
        assert all(math.isfinite(float(v)) for r in rows[1:] for v in r if v and v[0] in "-.0123456789"), name
        if folder.endswith("/one"):
            assert abs(times[-1] - row["makespan"]) <= 0.011, name + ": ends before the makespan"
PYTHON
[ -f "$work/one/joints-1.csv" ] || fail 'the second arm has no joints'
status=0
python3 "$here/replay_check.py" "$work/one/replay.html" "$work/one/timeline.csv" \
    >"$work/verdict" 2>&1 || status=$?
case $status in
    0) ;;
    77) echo "no browser: the replay is not checked" ;;
    *) fail "the replay in a browser: $(head -3 "$work/verdict")" ;;
esac

# ---- Episodes ------------------------------------------------------------------------------------
"$gen" --kind random --count 3 --seed 4 --out "$work/stream.jsonl"
cat "$work/sets.jsonl" "$work/stream.jsonl" >"$work/mixed.jsonl"
"$sim" --in "$work/mixed.jsonl" --episodes "$work/episodes.jsonl" --quiet || fail '--episodes'
[ "$(wc -l <"$work/episodes.jsonl")" = 5 ] || fail 'five bins have five episodes'
"$sim" --in "$work/sets.jsonl" --episodes - --quiet >"$work/one-arm.jsonl" --scenario S-R1A1 \
    --repack full || fail '--episodes -'
if have_checker; then
    judge "$work/mixed.jsonl" "$work/episodes.jsonl" --bins 5 --scenario D-R5A3O1 \
        >"$work/verdict" 2>&1 || fail "episodes: $(head -1 "$work/verdict")"
    judge "$work/sets.jsonl" "$work/one-arm.jsonl" --bins 2 --scenario S-R1A1 --repack full --full \
        >"$work/verdict" 2>&1 || fail "one arm's episodes: $(head -1 "$work/verdict")"
fi
printf '3 4\n5 2\n' >"$work/plain"
gives 'a format without a bin' "rows[0]['packed'] == 2" --in "$work/plain"

# ---- Noise ---------------------------------------------------------------------------------------
gives 'noise of 0.3 mm' \
    "len(rows) == 5 and all(0 < row['simulation']['worst_error_mm'] < 5 for row in rows)" \
    --sigma .3 --sigma-yaw .1 --count 5
gives 'jams are planned again' \
    "len(rows) == 6 and sum(row['simulation']['retries'] for row in rows) > 0
     and all(row['simulation']['worst_overlap_mm'] < 2 for row in rows)" \
    --sigma 1 --scenario S-R5A3 --count 6
gives 'so much noise that the buffer is full' \
    "sum(row['simulation']['set_aside'] for row in rows) > 0" \
    --sigma 3 --scenario S-R5A3 --repack anytime --count 2
"$sim" --in "$work/sets.jsonl" --sigma .8 --scenario S-R5A3 --repack anytime \
    --episodes "$work/jams.jsonl" --quiet || fail 'episodes with jams'
if have_checker; then
    judge "$work/sets.jsonl" "$work/jams.jsonl" --bins 2 --may-close-early >"$work/verdict" 2>&1 ||
        fail "episodes with jams: $(head -1 "$work/verdict")"
fi
gives 'noise without feedback' \
    "all(row['simulation']['retries'] == 0 for row in rows)
     and sum(row['simulation']['jams'] for row in rows) > 0" \
    --sigma 2 --feedback off --count 3

# ---- Text ----------------------------------------------------------------------------------------
for columns in 40 80; do
    COLUMNS=$columns LC_ALL=C "$sim" --count 2 --sigma .1 >"$work/text" 2>"$work/stderr" ||
        fail "$columns columns"
    [ ! -s "$work/stderr" ] || fail "$columns columns: stderr: $(head -1 "$work/stderr")"
    [ "$(wc -L <"$work/text")" -le $columns ] || fail "a line of more than $columns columns"
    for word in makespan travel strokes grips 'wait: ' busy clearance simulation 'schedule hash' \
        'all 2 bins' throughput; do
        grep -q -e "$word" "$work/text" || fail "$columns columns: nothing about '$word'"
    done
    if grep -qE '\b(nan|inf)\b' "$work/text"; then fail 'shows nan or inf'; fi
done
[ -z "$("$sim" --quiet 2>&1)" ] || fail '--quiet prints'

# ---- Mistakes ------------------------------------------------------------------------------------
refuses "--cell 'nope': must be one of ur5e, paper, piper, scara, or a file" --cell nope
refuses "--cell '\\\\x1b\[2J': must be" --cell $'\e[2J'
refuses "--mode 'x': must be one of sync, mutex, coordinated" --mode x
refuses "--kind 'x': must be one of" --kind x
refuses "--scenario: " --scenario S-R9
refuses "--policy 'x': must be one of" --policy x
for value in -1 51 nan inf x 1e400; do
    refuses "--sigma '$value': must be a number of millimetres, 0\.\.50" --sigma "$value"
    refuses "--sigma-yaw '$value': must be" --sigma-yaw "$value"
    refuses "--period '$value': must be" --period "$value"
done
for value in 0 59 1001 x 60.5; do refuses "--hertz '$value': must be" --hertz "$value"; done
for value in 0 -1 1.5 1000001; do refuses "--count '$value': must be" --count "$value"; done
refuses '--count: beside --in' --in "$work/sets.jsonl" --count 2
refuses '--sigma and --sigma-yaw: must go with --simulate on' --sigma 1 --simulate off
refuses "--episodes '.*': must be another file than --in" \
    --in "$work/sets.jsonl" --episodes "$work/sets.jsonl"
refuses "--episodes '-': must go with --quiet" --episodes -
refuses '.*--bogus' --bogus
refuses '.*junk' junk
rejects 'nowhere: No such file' --in nowhere
rejects '.*one/trace.json: Not a directory' --out "$work/one/trace.json"
rejects '.*nowhere/e: No such file' --episodes "$work/nowhere/e"
rejects '/dev/full: No space left' --episodes /dev/full
rejects '.*nowhere/l.json' --layout "$work/nowhere/l.json"
"$gen" --bin 9x9 --kind full --out "$work/nine.jsonl"
rejects "$work/nine.jsonl:1: instance 's1': bin 9x9: must be the cell's, 10x10" --in "$work/nine.jsonl"
# A fault loses nothing before it.
{
    cat "$work/sets.jsonl"
    echo '{"id":"bad","bin":[10,10],"items":[[1,0]]}'
} >"$work/bad.jsonl"
rejects "$work/bad.jsonl:3: field 'items\[0\]': height 0" --in "$work/bad.jsonl" --out "$work/kept" \
    --episodes "$work/kept.jsonl"
[ "$(wc -l <"$work/kept.jsonl")" = 2 ] || fail 'a fault in the third set loses the first ones'
[ -s "$work/kept/bin-0002/replay.html" ] || fail 'a fault in the third set loses a replay'

# ---- Pipes and interrupts ------------------------------------------------------------------------
expect_error 1 'standard output: Broken pipe' 'a pipe closed early' \
    bash -c '"$0" --json --count 1000 | head -1 >/dev/null; exit "${PIPESTATUS[0]}"' "$sim"
expect_error 1 'standard output: No space left' 'a full disk' bash -c '"$0" >/dev/full' "$sim"
for signal in INT TERM; do
    rm -f "$work/part.jsonl" "$work/text"
    "$sim" --count 100000 --episodes "$work/part.jsonl" >"$work/text" 2>"$work/stderr" &
    job=$!
    for _ in $(seq 300); do
        if [ -s "$work/part.jsonl" ]; then break; fi
        sleep 0.1
    done
    kill -$signal $job
    status=0
    wait $job || status=$?
    [ "$status" = "$([ $signal = INT ] && echo 130 || echo 143)" ] ||
        fail "SIG$signal: exit code $status"
    [ ! -s "$work/stderr" ] || fail "SIG$signal: $(head -1 "$work/stderr")"
    [ "$(tail -c 1 "$work/part.jsonl" | od -An -tx1 | tr -d ' ')" = 0a ] ||
        fail "SIG$signal: a torn line"
    [ "$(grep -c '^schedule hash' "$work/text")" = "$(wc -l <"$work/part.jsonl")" ] ||
        fail "SIG$signal: bins and episodes differ"
    tail -1 "$work/text" | grep -qE 'real time' || fail "SIG$signal: no figures over what was done"
done
finish
