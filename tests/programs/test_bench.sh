#!/usr/bin/env bash
# Every bench runs on few bins, as text and as JSON; what the JSON says agrees with itself and with
# the paper; mistakes on the command line end in one line; an interrupt prints what is done.
here=$(dirname "$0")
# shellcheck source=tests/programs/common.sh
source "$here/common.sh" "$@"
set -m # a job of its own gets the signals that a shell's background job would ignore

bench=$(find_program packcell-bench)
if [ -z "$bench" ]; then
    echo "packcell-bench is not under $build"
    exit 1
fi
small=(--budget-nodes 2000 --seed 7)

# shows WHAT COLUMNS OPTION...: text no wider than that, without anything on stderr.
shows() {
    local what=$1 columns=$2 status=0
    shift 2
    COLUMNS=$columns LC_ALL=C "$bench" "$@" "${small[@]}" >"$work/text" 2>"$work/stderr" ||
        status=$?
    [ "$status" = 0 ] || fail "$what: exit code $status: $(head -1 "$work/stderr")"
    [ ! -s "$work/stderr" ] || fail "$what: stderr: $(head -1 "$work/stderr")"
    local widest
    widest=$(wc -L <"$work/text")
    [ "$widest" -le "$columns" ] || fail "$what: a line of $widest columns, not $columns"
    if grep -qE '\b(nan|inf)\b' "$work/text"; then fail "$what: shows nan or inf"; fi
}

# gives WHAT CONDITION OPTION...: JSON of which the Python expression over `b`, the object, and
# `rows`, all its rows, is true.
gives() {
    local what=$1 condition=$2 status=0
    shift 2
    "$bench" "$@" "${small[@]}" --json >"$work/json" 2>"$work/stderr" || status=$?
    [ "$status" = 0 ] || fail "$what: exit code $status: $(head -1 "$work/stderr")"
    holds "$what" "$condition" || true
}

# holds WHAT CONDITION: of the JSON written last.
holds() {
    python3 - "$work/json" "$1" "$2" <<'EOF' || fail "$1"
import json, sys

def refuse(text):
    raise ValueError("%s is no JSON" % text)

with open(sys.argv[1]) as file:
    lines = file.read().splitlines()
if len(lines) != 1:
    sys.exit("%s: %d lines" % (sys.argv[2], len(lines)))
b = json.loads(lines[0], parse_constant=refuse)
rows = [row for section in b["sections"] for row in section["rows"]]
if not eval("(" + sys.argv[3] + ")"):
    sys.exit("%s: not so: %s" % (sys.argv[2], sys.argv[3]))
EOF
}

# ---- Names and help ------------------------------------------------------------------------------
names=$("$bench" list | cut -d' ' -f1 | tr '\n' ' ')
[ "$names" = "random full repack-time selection bound offline large compare inference makespan jam fleet gateway " ] ||
    fail "list: $names"
for name in ${names/compare/}; do # test_compare.sh judges that one
    "$bench" "$name" --help >"$work/text" || fail "$name --help"
    planning=--budget-nodes
    [ "$name" != inference ] || planning=--seconds
    [ "$name" != gateway ] || planning=--plans
    for option in --seed --json "$planning" --threads 'Exit codes'; do
        grep -q -e "$option" "$work/text" || fail "$name --help: nothing about $option"
    done
    [ "$name" = gateway ] || grep -q -e --policy "$work/text" || fail "$name --help: no --policy"
    [ "$(wc -L <"$work/text")" -le 100 ] || fail "$name --help: a line of more than 100 columns"
done
"$bench" --help | grep -q 'selection' || fail '--help names no benches'
"$bench" --version | grep -qE '^packcell-bench [0-9.]+$' || fail '--version'

# ---- Text ----------------------------------------------------------------------------------------
shows random 100 random --bins 4 --baseline-bins 2
grep -qE '^S-R1A1 +off .* 78\.88 .* 8715 ' "$work/text" || fail 'random: no figures of the paper'
shows 'random, narrow' 60 random --bins 2 --scenario S-R1A1 --baseline-bins 2
shows full 100 full --sets 3
grep -qE '^D-R2A2O2 +on .* 1\.90 ' "$work/text" || fail "full: the paper's repacked items"
shows repack-time 100 repack-time --bins 2 --budgets 2 --buffers 1,unlimited
shows selection 100 selection --sets 3
shows bound 100 bound --bins 3 --bound-nodes 20000 --held-nodes 2000
shows offline 100 offline --sets 2
shows large 100 large --sets 1

# ---- JSON ----------------------------------------------------------------------------------------
gives 'random: all cells and policies' \
    'b["bench"] == "random" and b["complete"] and b["configuration"]["seed"] == 7
     and len(b["sections"][0]["rows"]) == 12 and len(b["sections"][1]["rows"]) == 12
     and b["bins"] == b["wanted_bins"] == 12 * 3 + 6 * 12 * 2
     and all(set(row) >= {"contact", "skyline", "maxrects-bssf"} for row in rows[12:])
     and all(0 < row["utilization_percent"]["mean"] <= 100 for row in rows[:12])' \
    random --bins 3 --baseline-bins 2
gives 'random: differences to the paper' \
    'all(abs(row["utilization_percent"]["mean"] - row["utilization_percent"]["paper"]
             - row["utilization_percent"]["difference"]) < 1e-9 for row in rows)
     and [row["packing_steps"]["paper"] for row in rows] == [5438, 5787]' \
    random --bins 3 --scenario D-R2A2O2,D-R5A3O1 --rotation off --baselines off
gives 'random: one robot packs one item a step' \
    'rows[0]["packed_items"]["ours"] == rows[0]["packing_steps"]["ours"]
     and rows[0]["plan_ms"]["p50"] <= rows[0]["plan_ms"]["p99"] <= rows[0]["plan_ms"]["max"]' \
    random --bins 5 --scenario S-R5A3 --rotation on --baselines off --method paper
gives 'random: a scenario and a policy that the paper has not' \
    'rows[0]["utilization_percent"]["paper"] is None' \
    random --bins 2 --scenario D-R3A2O1 --baselines off --policy skyline
weights=$source/src/policy/weights/a3c.pkw
gives 'random: a policy by its file, for several threads' \
    'b["complete"] and b["configuration"]["policy"].endswith("/a3c.pkw")
     and [row["bins"] for row in rows] == [3, 3]
     and all(0 < row["utilization_percent"]["mean"] <= 100 for row in rows)' \
    random --bins 3 --scenario S-R1A1 --baselines off --policy "$weights" --threads 2
shows 'random: the name of a policy from a file' 100 \
    random --bins 2 --scenario S-R1A1 --baselines off --policy "$weights"
grep -q 'policy a3c,' "$work/text" || fail "random: no name of the file's policy"
gives 'full: sets are full with repacking' \
    'len(rows) == 24 and all(row["full_bins"]["ours"] == 3 for row in rows if row["repack"])
     and all(row["repacked_items"]["ours"] == 0 for row in rows if not row["repack"])
     and rows[1]["repack_ms"]["paper"] == 2550 and rows[0]["full_bins"]["paper"] == 0.684' \
    full --sets 3
gives 'repack-time: buffers hold no more than they may' \
    'len(rows) == 8 and all(row["largest_buffer"] <= int(row["buffer"]) for row in rows)
     and all(0 <= row["proved_percent"] <= 100 for row in rows)
     and rows[0]["utilization_percent"]["paper"] == 98.01' \
    repack-time --bins 3 --budgets 20 --buffers 0,1
gives 'selection: a row for each, and method exact last' \
    '[row["select"] for row in rows] == ["1", "2", "all", "all"]
     and rows[-1]["method"] == "exact" and rows[-1]["full_bins"] == {"count": 3, "of": 3}
     and all(row["repack_successes"]["count"] <= row["repack_successes"]["of"] for row in rows)' \
    selection --sets 3 --select 1,2,all
gives 'bound: nothing passes it' \
    'len(rows) == 16 and all(row["below_bound"] > -1e-9 for row in rows)
     and rows[0]["undecided"] == 0
     and all(row["buffer"] == (1 if i % 8 > 4 else 0) for i, row in enumerate(rows))
     and all(row["planner"] == "bound" for row in rows[0::8] + rows[5::8])
     and rows[5]["utilization_percent"]["mean"] > rows[0]["utilization_percent"]["mean"]' \
    bound --bins 4 --held-nodes 20000
gives 'offline: R and A are all items' \
    'len(rows) == 4 and rows[0]["scenario"][:3] == "S-R" and rows[2]["scenario"][:3] == "D-R"
     and all(row["full_bins"]["of"] == 2 for row in rows)' \
    offline --sets 2 --preset table
gives 'large: sizes and shares' \
    'len(rows) == 2 and all(row["bin"] == "15x15" for row in rows)
     and all(row["full_bins"]["of"] == 2 for row in rows)' \
    large --sets 2 --bin 15x15 --scenario D-R5A3O1 --budget-ms 100

# Equal options give equal figures, whatever the threads.
without_ms='{k: v for row in rows for k, v in row.items() if k not in ("plan_ms", "repack_ms")}'
for threads in 1 3; do
    "$bench" full --sets 4 --preset text "${small[@]}" --threads $threads --json |
        python3 -c "import json, sys
rows = json.load(sys.stdin)['sections'][0]['rows']
print([$without_ms for rows in [[row] for row in rows]])" >"$work/figures.$threads"
done
cmp -s "$work/figures.1" "$work/figures.3" || fail 'figures depend on --threads'

# ---- Mistakes ------------------------------------------------------------------------------------
refuses() {
    local pattern=$1
    shift
    expect_error 2 "^packcell-bench: $pattern" "$*" "$bench" "$@"
}
refuses 'the name of a bench is missing'
refuses "bench 'randon': must be one of list, random" randon
refuses "bench '\\\\x1b\[2J': must be" $'\e[2J'
refuses '.*--bogus' random --bogus
refuses '.*--bogus' --bogus
refuses '.*extra' list extra
refuses "--bins '0': must be a whole number, 1\.\." random --bins 0
refuses "--bins '1e9': must be" random --bins 1e9
refuses "--sets '-3': must be" full --sets=-3
refuses "--scenario: .*S-R9" random --scenario S-R1A1,S-R9
refuses "--scenario: " random --scenario ''
refuses "--rotation 'maybe': must be one of on, off, both" random --rotation maybe
refuses "--method 'best': must be one of" random --method best
refuses "--policy 'best': must be one of default, contact" full --policy best
echo 'no blob' >"$work/bad.pkw"
for name in random full repack-time selection bound offline large; do
    expect_error 1 '^packcell-bench: .*/bad\.pkw' "$name: a file without a policy" \
        "$bench" "$name" --policy "$work/bad.pkw"
done
expect_error 1 '^packcell-bench: .*/none\.pkw' 'no such file' \
    "$bench" random --policy "$work/none.pkw"
refuses "--preset 'tables': must be one of" full --preset tables
refuses "--budget-ms 'nan': must be" large --budget-ms nan
refuses "--budget-nodes '-1': must be" random --budget-nodes=-1
refuses "--budgets '0': must be" repack-time --budgets 1,0
refuses "--budgets 'inf': must be" repack-time --budgets inf
refuses "--buffers '4097': must be unlimited or" repack-time --buffers 1,4097
refuses "--select '129': must be all or" selection --select 129
refuses "--bin '10x10': must be one of" large --bin 10x10
refuses "--seed 'x': must be" bound --seed x
refuses "--threads '0': must be" offline --threads 0
to_full_disk() {
    "$bench" list >/dev/full
}
expect_error 1 '^packcell-bench: standard output: ' 'a full disk' to_full_disk

# ---- Interrupts ----------------------------------------------------------------------------------
# interrupted SIGNAL CODE OPTION...: begins much, hears the signal, prints what is done.
interrupted() {
    local signal=$1 code=$2 status=0
    shift 2
    "$bench" random --bins 100000 --scenario S-R5A1 --rotation on --baselines off "$@" \
        >"$work/json" 2>"$work/stderr" &
    local job=$!
    sleep 1.5
    kill "-$signal" $job
    wait $job || status=$?
    [ "$status" = "$code" ] || fail "SIG$signal: exit code $status, expected $code"
    [ ! -s "$work/stderr" ] || fail "SIG$signal: $(head -1 "$work/stderr")"
}
interrupted TERM 143 --json
holds 'SIGTERM leaves what is done' \
    'not b["complete"] and 0 < b["bins"] == rows[0]["bins"] < b["wanted_bins"] == 100000
     and not rows[0]["complete"] and rows[0]["utilization_percent"]["mean"] > 80'
interrupted INT 130
grep -qE 'Interrupted: this is not all' "$work/json" || fail 'an interrupted table does not say so'
finish
