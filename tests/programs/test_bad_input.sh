#!/usr/bin/env bash
# Bad input and bad options end in one line that names file, line, field, value and what is
# allowed; bins packed before the fault are kept.
here=$(dirname "$0")
# shellcheck source=tests/programs/common.sh
source "$here/common.sh" "$@"

in=$work/in
long=$(printf 'x%.0s' $(seq 300))

# rejects PATTERN TEXT [OPTION...]: packcell-pack fails on a file of this text.
rejects() {
    local pattern=$1 text=$2
    shift 2
    printf '%b' "$text" >"$in"
    expect_error 1 "^packcell-pack: $in:$pattern" "$(cut -c1-100 <<<"$text")" \
        "$pack" --in "$in" --out "$work/out" "$@"
}

# accepts TEXT [OPTION...]
accepts() {
    local text=$1 status=0
    shift
    printf '%b' "$text" >"$in"
    "$pack" --in "$in" --out "$work/out" --quiet "$@" 2>"$work/stderr" || status=$?
    [ "$status" = 0 ] || fail "'$text' $*: exit code $status: $(head -1 "$work/stderr")"
}

# refuses PATTERN PROGRAM OPTION...: bad usage.
refuses() {
    local pattern=$1 program=$2
    shift 2
    expect_error 2 "^$(basename "$program"): $pattern" "$*" "$program" "$@"
}

set_with() {
    printf '{"id":"a","bin":[10,10],"items":%s}' "$1"
}

# ---- Structure -----------------------------------------------------------------------------------
rejects '1: no instance' ''
rejects '2: no instance' '\n  \n'
rejects "1: 'hello'" 'hello'
rejects '1: .*null' 'null'
rejects "1: field 'items\[1\]': column 39: .*unexpected end of input" \
    '{"id":"a","bin":[10,10],"items":[[1,2]'
rejects "2: column 15: .*missing closing quote" '{"id":"a","bin":[5,5],"items":[[1,2]]}\n{"id":"b","bin'
rejects "1: column [0-9]+: .*expected end of input" "$(set_with '[[1,2]]') x"
rejects "1: .*ill-formed UTF-8" '{"id":"a\xff","bin":[5,5],"items":[]}'
rejects '1: NUL byte at column 41' "$(set_with '[[1,2]]')\\0"
rejects "1: field 'id': .*control characters" '{"id":"a\\u001b[2J","bin":[5,5],"items":[]}'
rejects "1: field 'id': .*control characters" '{"id":"","bin":[5,5],"items":[]}'
rejects "1: field 'id': .*1..200 bytes" "{\"id\":\"$long\",\"bin\":[5,5],\"items\":[]}"
rejects "1: field 'items\[0\]': an array: must be a number" \
    "$(set_with "$(printf '[%.0s' $(seq 3000))")"

# ---- Fields --------------------------------------------------------------------------------------
rejects "1: field 'id': missing" '{"bin":[5,5],"items":[]}'
rejects "1: field 'bin': missing" '{"id":"a","items":[]}'
rejects "1: field 'items': missing: .*'stream'" '{"id":"a","bin":[5,5]}'
rejects "1: field 'items': beside 'stream'" '{"id":"a","bin":[5,5],"items":[],"stream":[]}'
rejects "1: field 'bins': missing" '{"id":"a","bin":[5,5],"stream":[]}'
rejects "1: field 'bins': beside 'items'" '{"id":"a","bin":[5,5],"items":[],"bins":2}'
rejects "1: field 'colour': unknown: must be one of id, bin" '{"id":"a","colour":1}'
rejects "1: field 'bin': given twice" '{"id":"a","bin":[5,5],"bin":[6,6],"items":[]}'
rejects "2: field 'id': \"a\": given to an earlier" "$(set_with '[]')\\n$(set_with '[]')"
rejects "1: field 'id': 7: must be a string" '{"id":7,"bin":[5,5],"items":[]}'
rejects "1: field 'id': an array: must be a string" '{"id":["a"],"bin":[5,5],"items":[]}'
rejects "1: field 'bin': \"5x5\": must be \[W,H\]" '{"id":"a","bin":"5x5","items":[]}'
rejects "1: field 'bin': 1 numbers: must be \[W,H\]" '{"id":"a","bin":[5],"items":[]}'
rejects "1: field 'bin': null: must be" '{"id":"a","bin":[5,null],"items":[]}'
rejects "1: field 'items': an object: must be" "$(set_with '{"w":1}')"
rejects "1: field 'items\[0\]': 1: must be \[w,h\]" "$(set_with '[1,2]')"
rejects "1: field 'items\[1\]': 3 numbers: must be \[w,h\]" "$(set_with '[[1,2],[1,2,3]]')"
rejects "1: field 'items\[0\]': \"2\": must be a number" "$(set_with '[[1,"2"]]')"
rejects "1: field 'items\[0\]': true: must be a number" "$(set_with '[[true,1]]')"
rejects "1: field 'bins': 0: must be a whole number, 1\.\." '{"id":"a","bin":[5,5],"bins":0,"stream":[]}'
rejects "1: field 'bins': 1.5: must be" '{"id":"a","bin":[5,5],"bins":1.5,"stream":[]}'
rejects "1: field 'bins': 99999999999: must be" '{"id":"a","bin":[5,5],"bins":99999999999,"stream":[]}'

# ---- Sizes ---------------------------------------------------------------------------------------
rejects "1: field 'items\[0\]': width 0: must be a whole number, 1\.\.128" "$(set_with '[[0,1]]')"
rejects "1: field 'items\[0\]': height -3: must be" "$(set_with '[[1,-3]]')"
rejects "1: field 'items\[0\]': height 2.5: must be" "$(set_with '[[1,2.5]]')"
rejects "1: field 'items\[0\]': 1e400: too large" "$(set_with '[[1,1e400]]')"
rejects "1: field 'items\[0\]': width 1000000000000000000000000000000: must be" \
    "$(set_with '[[1000000000000000000000000000000,1]]')"
rejects "1: field 'items\[0\]': width 18446744073709551617: must be" \
    "$(set_with '[[18446744073709551617,1]]')"
rejects "1: field 'bin': width 0: must be" '{"id":"a","bin":[0,5],"items":[]}'
rejects "1: field 'bin': height 129: must be" '{"id":"a","bin":[5,129],"items":[]}'
rejects "1: field 'items\[0\]': item 11 x 2: must fit the bin of 10 x 10" "$(set_with '[[11,2]]')"
turned='{"id":"a","bin":[10,5],"items":[[1,1],[2,8]]'
accepts "$turned}"
rejects "1: field 'items\[1\]': item 2 x 8: must fit .*without being turned" "$turned}" --rotation off
rejects "1: field 'items\[1\]': item 2 x 8: must fit .*without being turned" "$turned,\"no_rotate\":[1]}"

# ---- Fixed cells and flags -----------------------------------------------------------------------
rejects "1: field 'fixed\[0\]': 2 x 2 at \(9, 0\): must lie inside the bin of 10 x 10" \
    '{"id":"a","bin":[10,10],"items":[],"fixed":[[9,0,2,2]]}'
rejects "1: field 'fixed\[1\]': overlaps fixed\[0\]" \
    '{"id":"a","bin":[10,10],"items":[],"fixed":[[0,0,2,2],[1,1,3,3]]}'
rejects "1: field 'fixed\[0\]': x -1: must be" '{"id":"a","bin":[10,10],"items":[],"fixed":[[-1,0,2,2]]}'
rejects "1: field 'fixed\[0\]': width 0: must be" '{"id":"a","bin":[10,10],"items":[],"fixed":[[1,0,0,2]]}'
rejects "1: field 'fixed\[0\]': 2 numbers: must be \[x,y,w,h\]" \
    '{"id":"a","bin":[10,10],"items":[],"fixed":[[1,0]]}'
rejects "1: field 'stream\[1\]': item 4 x 4: must have a position beside the fixed" \
    '{"id":"a","bin":[6,6],"bins":2,"stream":[[2,2],[4,4]],"fixed":[[3,3,1,1]]}'
rejects "1: field 'no_rotate\[1\]': item 2: must be 0\.\.1" \
    '{"id":"a","bin":[10,10],"items":[[1,1],[2,2]],"no_rotate":[0,2]}'
rejects "1: field 'pinned\[0\]': item -1: must be" \
    '{"id":"a","bin":[10,10],"items":[[1,1]],"pinned":[-1]}'
rejects "1: field 'pinned\[0\]': item 0: must be absent" '{"id":"a","bin":[5,5],"items":[],"pinned":[0]}'
rejects "1: field 'pinned\[0\]': \"0\": must be" '{"id":"a","bin":[5,5],"items":[[1,1]],"pinned":["0"]}'

# ---- Other formats -------------------------------------------------------------------------------
rejects "3: field 'height': x: must be a whole number" '3 4\n\n1 x\n' --bin 10x10
rejects "2: field 'width': 0: must be" '3 4\n0 1\n' --bin 10x10
rejects "2: '1 2 3': must be 'w h'" '3 4\n1 2 3\n' --bin 10x10
rejects "2: field 'items\[1\]': item 11 x 2: must fit" '3 4\n11 2\n1 1\n' --bin 10x10
rejects "2: field 'height': 1e400: must be" '3 4\n1 1e400\n' --bin 10x10
rejects "2: field 'items\[0\]': width -1: must be" '[[1,1]]\n[[-1,1]]\n' --bin 10x10
rejects "1: field 'WIDTH': missing column" 'ID,HEIGHT\n0,1\n' --bin 10x10 --format csv
rejects "1: field 'HEIGHT': missing column" 'ID,WIDTH\n0,1\n' --bin 10x10
rejects "1: field 'DEPTH': unknown column" 'ID,WIDTH,HEIGHT,DEPTH\n0,1,1,1\n' --bin 10x10
rejects "1: field 'WIDTH': given twice" 'WIDTH,HEIGHT,width\n1,1,1\n' --bin 10x10
rejects "2: 2 columns: must be 3" 'ID,WIDTH,HEIGHT\n0,1\n' --bin 10x10
rejects "3: field 'COPIES': -1: must be" 'WIDTH,HEIGHT,COPIES\n1,1,1\n1,1,-1\n' --bin 10x10
rejects "2: field 'COPIES': 99999999999: must be" 'WIDTH,HEIGHT,COPIES\n1,1,99999999999\n' --bin 10x10
rejects "4: the file ends here: must go on with piece 2 of 2" '1\n2\n10 10\n3 4 2 12\n'
rejects "4: 3 numbers: must be length, width" '1\n1\n10 10\n3 4 2\n'
rejects "3: field 'stock width': 300: must be" '1\n1\n10 300\n3 4 2 12\n'
rejects "5: more lines than problems" '1\n1\n10 10\n3 4 2 12\n7\n'
printf 'WIDTH,HEIGHT\n10,10\n20,20\n' >"$work/two-bins.csv"
printf '1 1\n' >"$in"
expect_error 1 "two-bins.csv:3: a second kind of bin" 'two kinds of bin' \
    "$pack" --in "$in" --bins-file "$work/two-bins.csv"
printf '' >"$work/no-bins.csv"
expect_error 1 "no-bins.csv:1: no bin" 'no bin' "$pack" --in "$in" --bins-file "$work/no-bins.csv"

# ---- Millimetres ---------------------------------------------------------------------------------
accepts '{"id":"a","bin":[320.5,260],"items":[[59.9,90],[30,30.1]]}' --cell 30 --margin 10
rejects "1: field 'items\[0\]': item 400 x 90 mm, 14 x 3 cells: must fit the bin of 10 x 8" \
    '{"id":"a","bin":[320,260],"items":[[400,90]]}' --cell 30 --margin 10
rejects "1: field 'items\[0\]': width 0: must be a number of millimetres" \
    '{"id":"a","bin":[320,260],"items":[[0,90]]}' --cell 30
rejects "1: field 'bin': " '{"id":"a","bin":[3,260],"items":[[2,90]]}' --cell 30
rejects "1: field 'bin': " '{"id":"a","bin":[300000,260],"items":[[2,90]]}' --cell 30

# ---- Long lines ----------------------------------------------------------------------------------
# Ten megabytes are read; what is longer than a line may be is not, and not held in memory either.
{
    printf '{"id":"long","bin":[10,10],"bins":1,"stream":[[5,5]'
    printf ',[5,5]%.0s' $(seq 1000) >"$work/piece"
    for _ in $(seq 1700); do cat "$work/piece"; done
    printf ']}\n'
} >"$work/long.jsonl"
"$pack" --in "$work/long.jsonl" --out "$work/out" --quiet || fail 'a line of ten megabytes'
head -c 70000000 /dev/zero | tr '\0' ' ' >"$work/too-long.jsonl"
expect_error 1 'too-long.jsonl:1: line too long: must be at most 67108864 bytes' 'a line of 70 MB' \
    "$pack" --in "$work/too-long.jsonl"
rm "$work/too-long.jsonl" "$work/long.jsonl"

# ---- A fault loses nothing before it --------------------------------------------------------------
"$gen" --kind full --count 6 --seed 5 --out "$work/good.jsonl"
"$pack" --in "$work/good.jsonl" --out "$work/good.out" --quiet
{
    cat "$work/good.jsonl"
    echo '{"id":"bad","bin":[10,10],"items":[[1,0]]}'
    head -1 "$work/good.jsonl" | sed 's/"s1"/"after"/'
} >"$work/bad.jsonl"
for threads in 1 4; do
    expect_error 1 "bad.jsonl:7: field 'items\[0\]': height 0" "a fault in line 7, $threads threads" \
        "$pack" --in "$work/bad.jsonl" --out "$work/bad.out" --threads $threads
    same_episodes "before a fault, $threads threads" "$work/good.out" "$work/bad.out"
done

# ---- Files ---------------------------------------------------------------------------------------
expect_error 1 'nowhere: No such file' 'no input file' "$pack" --in "$work/nowhere"
expect_error 1 'Is a directory' 'a folder as input' "$pack" --in "$work"
expect_error 1 'nowhere/x: No such file' 'no output folder' \
    "$pack" --in "$work/good.jsonl" --out "$work/nowhere/x"
expect_error 1 'nowhere/x: No such file' 'no output folder' "$gen" --out "$work/nowhere/x"
expect_error 1 'good.out: Not a directory' 'a file as folder' \
    "$pack" --in "$work/good.jsonl" --out "$work/out" --svg "$work/good.out"
refuses "--out '.*': must be another file than --in" "$pack" --in "$in" --out "$in"
[ -s "$in" ] || fail '--out that is --in emptied it'

# ---- Weight blobs --------------------------------------------------------------------------------
# Of a network for bins of 4x3; and one cut short, no blob at all, one of no policy.
golden=$source/tests/golden
printf '{"id":"a","bin":[4,3],"items":[[2,1],[1,2]]}' >"$in"
"$pack" --in "$in" --out "$work/out" --quiet --policy "$golden/actor-critic.pkw" ||
    fail 'packing with a weight blob'
grep -q "\"policy\":\"$golden/actor-critic.pkw\"" "$work/out" || fail 'the episode names no file'
(cd "$golden" && "$pack" --in "$in" --out "$work/out" --quiet --policy actor-critic.pkw) ||
    fail 'a weight blob in the folder at hand'
set_with '[[2,1]]' >"$work/ten"
expect_error 1 "^packcell-pack: $work/ten:1: instance 'a': bin 10x10: .* trained for 4x3 bins" \
    'a blob for other bins' "$pack" --in "$work/ten" --policy "$golden/actor-critic.pkw"
expect_error 1 '^packcell-pack: .*nowhere/a.pkw.*: No such file' 'no blob' \
    "$pack" --in "$in" --policy "$work/nowhere/a.pkw"
expect_error 1 '^packcell-pack: none.pkw.*: No such file' 'no blob here' \
    "$pack" --in "$in" --policy none.pkw
expect_error 1 "^packcell-pack: $work: cannot be read" 'a folder as blob' \
    "$pack" --in "$in" --policy "$work"
head -c 1000 "$golden/actor-critic.pkw" >"$work/short.pkw"
expect_error 1 "^packcell-pack: $work/short.pkw: byte [0-9]+: " 'a blob cut short' \
    "$pack" --in "$in" --policy "$work/short.pkw"
: >"$work/empty.pkw"
expect_error 1 "^packcell-pack: $work/empty.pkw: byte 0: " 'an empty blob' \
    "$pack" --in "$in" --policy "$work/empty.pkw"
expect_error 1 "^packcell-pack: $work/good.jsonl: byte 0: " 'another kind of file' \
    "$pack" --in "$in" --policy "$work/good.jsonl"
expect_error 1 "^packcell-pack: $golden/weights.pkw: " 'a blob of no policy' \
    "$pack" --in "$in" --policy "$golden/weights.pkw"

# ---- Options -------------------------------------------------------------------------------------
refuses '.*--bogus' "$pack" --in "$in" --bogus
refuses '.*junk' "$pack" --in "$in" junk
refuses '--threads: 1 required' "$pack" --in "$in" --threads
for value in 0 -1 257 2.5 x nan inf 1e3 '' 99999999999999999999; do
    refuses "--threads '$value': must be a whole number, 1\.\.256" "$pack" --in "$in" --threads "$value"
done
for value in -1 nan inf 1e400 x 5x; do
    refuses "--budget-ms '$value': must be a number of milliseconds" \
        "$pack" --in "$in" --budget-ms "$value"
    refuses "--cell '$value': must be a number of millimetres" "$pack" --in "$in" --cell "$value"
done
for value in -1 1.5 x; do
    refuses "--budget-nodes '$value': must be" "$pack" --in "$in" --budget-nodes "$value"
    refuses "--seed '$value': must be" "$pack" --in "$in" --seed "$value"
    refuses "--buffer '$value': must be unlimited or" "$pack" --in "$in" --buffer "$value"
    refuses "--select '$value': must be auto, all or" "$pack" --in "$in" --select "$value"
done
for value in S-R0A1 D-R5A3 x '' S-R99A1 D-R5A3O4 S-R1A1x; do
    refuses '--scenario: ' "$pack" --in "$in" --scenario "$value"
done
refuses "--policy 'x': must be one of default, contact, .*, or a file" "$pack" --in "$in" --policy x
refuses "--policy 'default.pkt': must be one of" "$pack" --in "$in" --policy default.pkt
refuses "--method 'x': must be one of paper, exact" "$pack" --in "$in" --method x
refuses "--repack 'x': must be one of off, anytime, full" "$pack" --in "$in" --repack x
refuses "--rotation 'yes': must be on or off" "$pack" --in "$in" --rotation yes
refuses "--format 'x': must be one of auto, jsonl" "$pack" --in "$in" --format x
refuses '--clearance and --margin: .*--cell' "$pack" --in "$in" --clearance 2
printf '1 1\n' >"$in"
refuses '--bin: missing: .*plain' "$pack" --in "$in"
refuses '--bins-file: beside --bin' "$pack" --in "$in" --bin 5x5 --bins-file "$in"
for value in 10 10x 10x10x10 x axb 1e400x1; do
    refuses "--bin '$value': must be WxH" "$pack" --in "$in" --bin "$value"
done
refuses '--bin: side 200: must be a whole number, 1\.\.128' "$pack" --in "$in" --bin 200x10
refuses '--bin: .*jsonl, which carries' "$pack" --in "$work/good.jsonl" --bin 5x5
for value in 0x5 129x5 2.5x5 -1x5 5 x; do
    refuses "--bin '$value': must be WxH, two whole numbers, 1\.\.128" "$gen" --bin "$value"
done
for value in 0 -1 x 1.5 10000000000; do
    refuses "--count '$value': must be" "$gen" --count "$value"
done
for value in 0 -1 1.5 nan inf x; do
    refuses "--mean '$value': must be a number above 0, at most 1" "$gen" --kind full --mean "$value"
done
for value in 0 -1 129 nan x; do
    refuses "--sigma '$value': must be" "$gen" --kind full --sigma "$value"
done
refuses "--kind 'x': must be one of random, full" "$gen" --kind x
refuses "--preset 'x': must be one of table, text" "$gen" --kind full --preset x
refuses '--mean: must go with --kind full' "$gen" --mean 0.5
refuses "--count '900000000': must be at most" "$gen" --count 900000000

# ---- Help ----------------------------------------------------------------------------------------
for program in "$gen" "$pack"; do
    "$program" --help >"$work/help" || fail "$program --help"
    grep -q 'Exit codes: 0 done, 1 failed, 2 bad usage' "$work/help" || fail "$program --help: exit codes"
    "$program" --version | grep -qE "^$(basename "$program") [0-9]+\.[0-9]+\.[0-9]+$" ||
        fail "$program --version"
done
finish
