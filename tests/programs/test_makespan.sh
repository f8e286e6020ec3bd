#!/usr/bin/env bash
# The benches of the cell on few sets: modes in their order, savings beside the paper's, nothing that
# jams without noise, the same figures again; mistakes end in one line.
here=$(dirname "$0")
# shellcheck source=tests/programs/common.sh
source "$here/common.sh" "$@"

bench=$(find_program packcell-bench)
if [ -z "$bench" ]; then
    echo "packcell-bench is not under $build"
    exit 1
fi
small=(--budget-nodes 2000 --seed 7)

# A build without the cell says so.
if ! "$bench" makespan --sets 1 "${small[@]}" --json >"$work/json" 2>"$work/stderr"; then
    if grep -q 'PACKCELL_CELL' "$work/stderr"; then exit 77; fi
    fail "makespan: $(head -1 "$work/stderr")"
    finish
fi

# gives WHAT CONDITION BENCH OPTION...: JSON of which the Python expression over `b`, the object, its
# sections and `find` is true.
gives() {
    local what=$1 condition=$2 status=0
    shift 2
    "$bench" "$@" "${small[@]}" --json >"$work/json" 2>"$work/stderr" || status=$?
    [ "$status" = 0 ] || fail "$what: exit code $status: $(head -1 "$work/stderr")"
    python3 - "$work/json" "$what" "$condition" <<'EOF' || fail "$what"
import json, sys

with open(sys.argv[1]) as file:
    b = json.load(file)
sections = [section["rows"] for section in b["sections"]]

def find(section, **keys):
    rows = [r for r in sections[section] if all(r[k] == v for k, v in keys.items())]
    assert len(rows) == 1, (section, keys, len(rows))
    return rows[0]

if not eval("(" + sys.argv[3] + ")"):
    sys.exit("%s: not so: %s" % (sys.argv[2], sys.argv[3]))
EOF
}

gives 'the modes are in order, in the mean and in every set' \
    'b["bench"] == "makespan" and b["complete"] and b["sets"] == 8
     and [(r["scenario"], r["repack"]) for r in sections[0]]
         == [("S-R5A3", False), ("S-R5A3", True), ("D-R5A3O1", False), ("D-R5A3O1", True)]
     and all(r["lower_bound_s"] <= r["coordinated_s"]["mean"] + 1e-6 for r in sections[0])
     and all(r["coordinated_s"]["mean"] <= r["zone_mutex_s"]["mean"] + 1e-6
             and r["zone_mutex_s"]["mean"] <= r["sync_paper_s"]["mean"] + 1e-6
             for r in sections[0])
     and all(r["ordered"] == {"count": 2, "of": 2} for r in sections[3])' \
    makespan --sets 2
gives "the paper's figures stand beside ours" \
    'find(0, scenario="S-R5A3", repack=False)["sync_paper_s"]["paper"] == 124.48
     and find(0, scenario="D-R5A3O1", repack=True)["sync_paper_s"]["paper"] == 100.12
     and find(1, scenario="D-R5A3O1", repack=False)["execution_s"]["paper"] == 21.22
     and find(1, scenario="S-R5A3", repack=True)["motion_ms"]["paper"] == 770
     and all(r["motion_ms"]["mean"] <= 500 for r in sections[1])' \
    makespan --sets 1
gives 'savings are those of the makespans' \
    'len(sections[2]) == 8
     and abs(find(2, two_arms="SYNC_PAPER", one_arm="SYNC_PAPER", repack=False)
             ["saving_percent"]["paper"] - 24.25) < 0.01
     and abs(find(2, two_arms="SYNC_PAPER", one_arm="SYNC_PAPER", repack=True)
             ["saving_percent"]["paper"] - 23.56) < 0.01
     and all(abs(find(2, two_arms=two, one_arm=one, repack=repack)["saving_percent"]["mean"] - 100
                 * (1 - find(0, scenario="D-R5A3O1", repack=repack)[two.lower() + "_s"]["mean"]
                    / find(0, scenario="S-R5A3", repack=repack)[one.lower() + "_s"]["mean"])) < 1e-6
             for repack in (False, True)
             for two, one in (("SYNC_PAPER", "SYNC_PAPER"), ("COORDINATED", "SYNC_PAPER"),
                              ("COORDINATED", "COORDINATED")))
     and find(2, two_arms="COORDINATED", one_arm="SYNC_PAPER", repack=False)
         ["saving_percent"]["mean"] > 10' \
    makespan --sets 2
gives 'without noise nothing jams, and the arms keep apart' \
    'all(r["jams"] == r["misplaced"] == 0 and r["worst_error_mm"] <= 0.1
         and r["times_real_time"] >= 10 for r in sections[3])
     and all((r["least_clearance_mm"] is None) == r["scenario"].startswith("S")
             for r in sections[3])
     and all(r["least_clearance_mm"] is None or r["least_clearance_mm"] >= 50
             for r in sections[3])' \
    makespan --sets 2 --cell ur5e
gives "the paper's figures are of its cell alone" \
    'all(r["sync_paper_s"]["paper"] is None for r in sections[0])
     and b["configuration"]["cell"] == "piper"' \
    makespan --sets 1 --cell piper --preset text
gives 'with much noise something jams' 'sum(r["jams"] for r in sections[3]) > 0' \
    makespan --sets 1 --noise 3

# Equal options give equal figures, whatever the threads.
for threads in 1 3; do
    "$bench" makespan --sets 1 "${small[@]}" --threads $threads --json | python3 -c "
import json, sys
print([{k: v for k, v in row.items() if not k.endswith('_ms') and k != 'times_real_time'}
       for section in json.load(sys.stdin)['sections'] for row in section['rows']])
" >"$work/figures.$threads"
done
cmp -s "$work/figures.1" "$work/figures.3" || fail 'figures depend on --threads'

COLUMNS=100 LC_ALL=C "$bench" makespan --sets 1 "${small[@]}" >"$work/text"
grep -qE '^SYNC_PAPER +SYNC_PAPER +off .* 24\.25' "$work/text" || fail "no saving of the paper's"
grep -qE '124\.48' "$work/text" || fail "no makespan of the paper's"
[ "$(wc -L <"$work/text")" -le 100 ] || fail "a line of $(wc -L <"$work/text") columns"
if grep -qE '\b(nan|inf)\b' "$work/text"; then fail 'shows nan or inf'; fi

gives 'jam: less with more room and with less noise' \
    'b["bench"] == "jam" and len(sections[0]) == 12
     and find(0, gap_mm=0, sigma_mm=0.5)["jams"]["count"]
         > find(0, gap_mm=2, sigma_mm=0.5)["jams"]["count"]
     and abs(find(0, gap_mm=0, sigma_mm=0.5)["expected_percent"] - 28.9) < 0.1
     and all(r["jams"]["of"] > 0 for r in sections[0])
     and sections[1][0]["bins"] == 2 and sections[1][0]["bins_with_jam"]["of"] == 2' \
    jam --boards 1 --bins 2 --cell piper

refuses() {
    local pattern=$1
    shift
    expect_error 2 "^packcell-bench: $pattern" "$*" "$bench" "$@"
}
refuses "--noise '51': must be" makespan --noise 51
refuses "--noise 'nan': must be" makespan --noise nan
refuses "--sets '0': must be" makespan --sets 0
refuses "--preset 'both': must be one of" makespan --preset both
refuses "--boards '0': must be" jam --boards 0
refuses "--cell 'none': must be one of" makespan --cell none
expect_error 1 '^packcell-bench: .*none\.json' 'no such file' \
    "$bench" makespan --cell "$work/none.json"
echo '{"version": 1}' >"$work/bad.json"
expect_error 1 '^packcell-bench: .*name: missing' 'no cell' "$bench" makespan --cell "$work/bad.json"
finish
