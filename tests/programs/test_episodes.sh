#!/usr/bin/env bash
# Whatever packcell-pack writes, the independent checker accepts: every scenario, with and without
# rotation, every kind of repacking, both methods, and instances with fixed cells and item flags.
here=$(dirname "$0")
# shellcheck source=tests/programs/common.sh
source "$here/common.sh" "$@"

have_checker || exit 77

if [ "${PACKCELL_CHECK_ALL:-}" = 1 ]; then
    stream_bins=40 sets=40 paper_nodes=200000
else
    stream_bins=2 sets=3 paper_nodes=20000
fi

# pack_and_judge NAME INSTANCES BINS SCENARIO ROTATION REPACK [PACK OPTION...]
# demands so many bins, unless that is "any".
pack_and_judge() {
    local what=$1 instances=$2 bins=$3 scenario=$4 rotation=$5 repack=$6 status=0
    local demand=(--scenario "$scenario" --rotation "$rotation" --repack "$repack")
    shift 6
    what="$what $scenario rotation $rotation repack $repack $*"
    "$pack" --in "$instances" --out "$work/episodes.jsonl" --quiet --scenario "$scenario" \
        --rotation "$rotation" --repack "$repack" "$@" 2>"$work/stderr" || status=$?
    if [ "$status" != 0 ]; then
        fail "$what: exit code $status: $(head -1 "$work/stderr")"
        return
    fi
    [ "$bins" = any ] || demand+=(--bins "$bins")
    judge "$instances" "$work/episodes.jsonl" "${demand[@]}" >"$work/verdict" 2>&1 ||
        fail "$what: $(head -1 "$work/verdict")"
}

scenarios="S-R1A1 S-R5A1 S-R5A3 D-R2A2O2 D-R5A2O2 D-R5A3O1"

"$gen" --kind random --bin 10x10 --count "$stream_bins" --seed 11 --out "$work/stream.jsonl"
"$gen" --kind full --preset table --count "$sets" --seed 12 --out "$work/sets.jsonl"
cat "$work/stream.jsonl" "$work/sets.jsonl" >"$work/mixed.jsonl"
for scenario in $scenarios; do
    for rotation in on off; do
        for repack in off anytime full; do
            pack_and_judge mixed "$work/mixed.jsonl" $((stream_bins + sets)) \
                "$scenario" $rotation $repack --method exact
            pack_and_judge mixed "$work/mixed.jsonl" $((stream_bins + sets)) \
                "$scenario" $rotation $repack --method paper --budget-nodes "$paper_nodes"
        done
    done
done

# Other policies, few candidates, small buffers, a budget in time, many small budgets.
for policy in bottom-left skyline shelf-next-fit maxrects-cp maxrects-bssf; do
    pack_and_judge policies "$work/mixed.jsonl" $((stream_bins + sets)) \
        D-R5A3O1 on anytime --policy $policy --budget-nodes 5000
done
for buffer in 0 1 2 unlimited; do
    for scenario in S-R1A1 D-R5A2O2; do
        for repack in anytime full; do
            pack_and_judge buffers "$work/mixed.jsonl" $((stream_bins + sets)) \
                $scenario on $repack --buffer $buffer --budget-nodes 5000
        done
    done
done
for nodes in 1 2 10 100; do
    pack_and_judge budgets "$work/mixed.jsonl" $((stream_bins + sets)) \
        D-R5A3O1 on anytime --budget-nodes $nodes
    pack_and_judge budgets "$work/mixed.jsonl" $((stream_bins + sets)) \
        S-R5A3 off full --budget-nodes $nodes --method paper
done
pack_and_judge select "$work/mixed.jsonl" $((stream_bins + sets)) S-R5A3 on anytime \
    --select 1 --budget-nodes 5000
pack_and_judge time "$work/mixed.jsonl" $((stream_bins + sets)) S-R5A3 on anytime --budget-ms 2

# Fixed cells, items that may not be turned, pinned items; narrow bins, sets and streams that are
# shorter than what the arms reach, a set without items, a bin that is full from the start.
cat >"$work/special.jsonl" <<'JSON'
{"id":"fixed","bin":[10,10],"fixed":[[0,0,2,2],[9,9,1,1],[4,4,1,3]],"items":[[3,4],[2,5],[5,2],[4,4],[1,6],[2,2],[3,3],[6,1]]}
{"id":"flags","bin":[10,10],"no_rotate":[0,2,4],"pinned":[1,3],"items":[[3,7],[4,5],[7,3],[3,6],[2,8],[5,4],[2,2],[1,9]]}
{"id":"all pinned","bin":[8,6],"pinned":[0,1,2,3,4,5],"items":[[3,3],[4,2],[2,5],[5,2],[3,4],[2,2]]}
{"id":"all","bin":[9,7],"fixed":[[3,3,2,1]],"no_rotate":[1,3],"pinned":[0],"items":[[4,3],[3,4],[2,6],[5,2],[2,2],[1,5],[3,1]]}
{"id":"row","bin":[16,1],"items":[[5,1],[4,1],[8,1],[3,1],[4,1]]}
{"id":"cell","bin":[1,1],"items":[[1,1],[1,1]]}
{"id":"one","bin":[5,5],"items":[[2,3]]}
{"id":"two","bin":[5,5],"items":[[2,3],[5,2]]}
{"id":"three","bin":[5,5],"items":[[3,3],[3,3],[2,5]]}
{"id":"none","bin":[5,5],"items":[]}
{"id":"blocked","bin":[3,2],"fixed":[[0,0,3,2]],"items":[[1,1],[2,1]]}
{"id":"short stream","bin":[6,6],"bins":9,"stream":[[3,3],[4,2],[5,5],[2,6],[1,1],[3,6],[2,2]],"pinned":[1],"no_rotate":[3]}
{"id":"one item","bin":[6,6],"bins":2,"stream":[[3,3]]}
{"id":"fixed stream","bin":[8,8],"bins":3,"fixed":[[0,0,3,1],[7,7,1,1]],"stream":[[3,3],[4,2],[5,5],[2,6],[1,1],[3,6],[2,2],[4,4],[3,2],[5,1],[2,2],[6,3],[1,4],[4,3],[2,5],[3,3],[4,1],[2,3],[3,5],[1,2]]}
{"id":"large","bin":[40,30],"items":[[13,9],[20,8],[7,22],[15,15],[12,6],[9,9],[18,4],[5,17],[11,11],[6,3]]}
JSON
grep '"items"' "$work/special.jsonl" | cut -d'"' -f4 >"$work/set_ids"
for scenario in $scenarios; do
    for repack in off anytime full; do
        for rotation in on off; do
            pack_and_judge special "$work/special.jsonl" any "$scenario" $rotation $repack \
                --method paper --budget-nodes 5000
            pack_and_judge special "$work/special.jsonl" any "$scenario" $rotation $repack \
                --method exact --budget-nodes 5000
            short=$(grep -c '"id":"short stream"' "$work/episodes.jsonl" || true)
            if [ "$short" -lt 2 ] || [ "$short" -ge 9 ]; then
                fail "special $scenario $rotation $repack: a stream that runs out gave $short bins"
            fi
            while read -r id; do
                grep -q "\"id\":\"$id\"" "$work/episodes.jsonl" ||
                    fail "special $scenario $rotation $repack: no bin for '$id'"
            done <"$work/set_ids"
        done
    done
done

# The checker does check: an item moved out of its place is found out.
"$pack" --in "$work/sets.jsonl" --quiet >"$work/good.jsonl"
sed -E '1s/\["pack",0,([0-9]+),/["pack",0,1\1,/' "$work/good.jsonl" >"$work/moved.jsonl"
judge "$work/sets.jsonl" "$work/good.jsonl" || fail "good episodes are refused"
if judge "$work/sets.jsonl" "$work/moved.jsonl" >/dev/null 2>&1; then
    fail "a moved item is not found out"
fi
finish
