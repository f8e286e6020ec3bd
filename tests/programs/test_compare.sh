#!/usr/bin/env bash
# packcell-bench compare: the optima are those known from elsewhere, no policy exceeds them, played
# bins agree with what is computed without sampling, and mistakes end in one line.
here=$(dirname "$0")
# shellcheck source=tests/programs/common.sh
source "$here/common.sh" "$@"
set -m # a job of its own gets the signals that a shell's background job would ignore

bench=$(find_program packcell-bench)
if [ -z "$bench" ]; then
    echo "packcell-bench is not under $build"
    exit 1
fi
compare=("$bench" compare --weights "$work")
four=(--protocol "P16,P25" --protocol "S4,S4-alone")

# gives WHAT OPTION...: a JSON object in $work/json.
gives() {
    local what=$1 status=0
    shift
    "${compare[@]}" "$@" --json >"$work/json" 2>"$work/stderr" || status=$?
    [ "$status" = 0 ] || fail "$what: exit code $status: $(head -1 "$work/stderr")"
    [ ! -s "$work/stderr" ] || fail "$what: stderr: $(head -1 "$work/stderr")"
}

# holds WHAT CONDITION: of the JSON written last; `b` is the object, `rows` all rows of policies,
# percent(protocol, rotation, policy) a utilisation.
holds() {
    python3 - "$work/json" "$1" "$2" <<'PYTHON' || fail "$1"
import json, sys

def refuse(text):
    raise ValueError("%s is no JSON" % text)

with open(sys.argv[1]) as file:
    lines = file.read().splitlines()
if len(lines) != 1:
    sys.exit("%s: %d lines" % (sys.argv[2], len(lines)))
b = json.loads(lines[0], parse_constant=refuse)
rows = [row for section in b["sections"] for row in section["rows"] if "policy" in row]
figures = {(row["protocol"], row["rotation"], row["policy"]): row for row in rows}

def percent(*key):
    return figures[key]["utilization_percent"]["mean"]

def near(a, b, tolerance=0.01):
    return abs(a - b) <= tolerance

if not eval("(" + sys.argv[3] + ")"):
    sys.exit("%s: not so: %s" % (sys.argv[2], sys.argv[3]))
PYTHON
}

# ---- 4x4 -----------------------------------------------------------------------------------------
gives '4x4' "${four[@]}" --episodes 2000 --seed 7
holds 'rows' \
    'b["bench"] == "compare" and b["complete"] and len(rows) == len(figures)
     and b["rows"] == b["wanted_rows"] == len(rows) == 4 * 2 * 7 + 2 * 2
     and b["configuration"]["protocols"] == ["P16", "P25", "S4", "S4-alone"]'
# Found by a prototype of its own.
holds 'the optima' \
    'near(percent("P16", False, "optimum"), 94.90)
     and near(percent("P16", False, "optimum, may decline"), 95.57)
     and near(percent("P25", False, "optimum"), 97.76)
     and near(percent("P25", False, "optimum, may decline"), 98.21)
     and near(percent("S4-alone", False, "optimum"), 92.08)
     and near(percent("S4-alone", True, "optimum"), 94.56)
     and near(percent("S4", False, "optimum"), 92.072)
     and near(percent("S4", True, "optimum"), 94.614)'
holds 'greedy contact' \
    'near(percent("P16", False, "contact"), 94.78) and near(percent("S4", False, "contact"), 90.30)'
holds 'no policy exceeds the optimum' \
    'all(row["below_optimum"]["mean"] >= 0 for row in rows if row["states"] is not None
         and row["policy"] != "optimum, may decline")
     and all(row["below_optimum"]["mean"] + row["below_optimum"]["half_width_95"] > 0
             for row in rows if row["bins"] == 2000)
     and all(near(row["below_optimum"]["mean"], percent(row["protocol"], row["rotation"], "optimum")
                  - row["utilization_percent"]["mean"], 1e-3) for row in rows)'
holds 'rotation and freedom to decline help' \
    'all(percent(p, True, "optimum") > percent(p, False, "optimum")
         for p in ("P16", "P25", "S4", "S4-alone"))
     and all(percent(p, r, "optimum, may decline") > percent(p, r, "optimum")
             for p in ("P16", "P25") for r in (False, True))'
holds 'only shelf-next-fit is played' \
    'all((row["bins"] == 2000) == (row["policy"] == "shelf-next-fit")
         and (row["bins"] is None) == (row["states"] is not None)
         and (row["utilization_percent"]["half_width_95"] > 0) == (row["bins"] is not None)
         for row in rows)'
holds 'what was published' \
    '[row["utilization_percent"] for row in b["sections"][-1]["rows"]] == [94.87, 97.23, 98.23]'
cp "$work/json" "$work/computed"

# Played bins share nothing with the chains but the planner: each lies in its interval, widened to
# what one in some ten thousand rows would leave.
gives 'by episodes' "${four[@]}" --evaluation episodes --episodes 4000 --seed 3 --builtin off \
    --policy contact --policy maxrects-cp --threads 2
holds 'played bins agree with the chains' \
    'len(rows) == 4 * 2 * 3 + 2 * 2
     and all(near(row["utilization_percent"]["mean"],
                  [known for section in json.load(open(sys.argv[1][:-4] + "computed"))["sections"]
                   for known in section["rows"] if known.get("policy") == row["policy"]
                   and known["rotation"] == row["rotation"]
                   and known["protocol"] == row["protocol"]][0]["utilization_percent"]["mean"],
                  2 * row["utilization_percent"]["half_width_95"])
             for row in rows if row["bins"])'
mv "$work/json" "$work/threads"
gives 'threads change nothing' "${four[@]}" --evaluation episodes --episodes 4000 --seed 3 \
    --builtin off --policy contact --policy maxrects-cp --threads 1
cmp -s <(sed 's/"threads":2/"threads":1/' "$work/threads") "$work/json" ||
    fail 'figures depend on --threads'

# ---- 5x5 -----------------------------------------------------------------------------------------
gives '5x5' --protocol Q25,S5 --builtin off --policy contact --rotation off
holds 'without --exact there is no optimum' \
    'len(rows) == 2 and all(row["below_optimum"] is None for row in rows)
     and near(percent("S5", False, "contact"), 90.78)
     and near(percent("Q25", False, "contact"), 96.12)
     and len(b["sections"][-1]["rows"]) == 5'
gives '5x5 exactly' --protocol S5-alone --exact --builtin off --policy contact --rotation on
holds 'the optimum of S5' \
    'near(percent("S5-alone", True, "optimum"), 95.94)
     and 1 < figures["S5-alone", True, "contact"]["below_optimum"]["mean"] < 2'
# The other optima of 5x5 take some minutes.
if [ "${PACKCELL_CHECK_ALL:-}" = 1 ]; then
    gives '5x5 optima' --protocol Q25,S5-alone --exact --rotation off --builtin off
    holds 'the optima of 5x5' \
        'near(percent("Q25", False, "optimum"), 96.28)
         and near(percent("Q25", False, "optimum, may decline"), 96.98)
         and near(percent("S5-alone", False, "optimum"), 93.77)'
fi

# ---- Text, help, learned policies ----------------------------------------------------------------
for columns in 60 100; do
    COLUMNS=$columns LC_ALL=C "${compare[@]}" --protocol P16 --episodes 100 >"$work/text"
    widest=$(wc -L <"$work/text")
    [ "$widest" -le "$columns" ] || fail "text: a line of $widest columns, not $columns"
    if grep -qE '\b(nan|inf)\b' "$work/text"; then fail 'text: shows nan or inf'; fi
done
grep -qE '^contact +off +94\.780 +0\.119 ' "$work/text" || fail 'text: no row of contact'
grep -q 'P16-norot.pkw' "$work/text" || fail 'text: says nothing about missing weights'
"$bench" compare --help >"$work/text" || fail '--help'
for option in --protocol --rotation --exact --policy --weights --evaluation --episodes --seed \
    --threads --json S4-alone 'Exit codes'; do
    grep -q -e "$option" "$work/text" || fail "--help: nothing about $option"
done
[ "$(wc -L <"$work/text")" -le 100 ] || fail '--help: a line of more than 100 columns'

golden=$source/tests/golden
cp "$golden/fully-convolutional.pkw" "$work/P16-norot.pkw"
gives 'weights' --protocol P16 --builtin off --policy "$golden/fully-convolutional.pkw"
holds 'learned is the blob of its protocol' \
    'percent("P16", False, "learned") == percent("P16", False, "fully-convolutional")
     and len(rows) == 2 * 3 + 1 and rows[2]["below_optimum"]["mean"] > 0'
gives 'weights of another bin' --protocol P16 --builtin off --policy "$golden/actor-critic.pkw"
holds 'it has no row' 'len(rows) == 2 * 2 + 1'

# ---- Mistakes ------------------------------------------------------------------------------------
refuses() {
    local pattern=$1
    shift
    expect_error 2 "^packcell-bench: $pattern" "$*" "$bench" compare "$@"
}
refuses "--protocol 'P17': must be one of P16, P25" --protocol P16,P17
refuses "--protocol '': must be one of" --protocol ''
refuses "--policy 'best': must be one of default, contact, .*, or a file" --policy contact --policy best
refuses "--rotation 'maybe': must be one of on, off, both" --rotation maybe
refuses "--weights '/nowhere': must be a folder" --weights /nowhere
refuses "--evaluation 'guess': must be one of exact, episodes" --evaluation guess
refuses "--episodes '1': must be a whole number, 2\.\." --episodes 1
refuses '.*--budget-nodes' --budget-nodes 5
refuses '.*extra' extra
echo 'no weights' >"$work/P16-norot.pkw"
expect_error 1 '^packcell-bench: ' 'a blob that is none' "${compare[@]}" --protocol P16
rm "$work/P16-norot.pkw"

# ---- Interrupts ----------------------------------------------------------------------------------
status=0
"${compare[@]}" --protocol P16 --rotation off --episodes 1000000 --json >"$work/json" \
    2>"$work/stderr" &
job=$!
sleep 1.5
kill -TERM $job
wait $job || status=$?
[ "$status" = 143 ] || fail "SIGTERM: exit code $status, expected 143"
[ ! -s "$work/stderr" ] || fail "SIGTERM: $(head -1 "$work/stderr")"
holds 'SIGTERM leaves what is done' \
    'not b["complete"] and 2 <= b["rows"] == len(rows) < b["wanted_rows"] == 8
     and near(percent("P16", False, "optimum"), 94.90)'
finish
