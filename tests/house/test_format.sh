#!/usr/bin/env bash
# Every source is laid out as .clang-format says.
# usage: test_format.sh BUILD_DIR SOURCE_DIR    judge
#        test_format.sh --fix SOURCE_DIR        lay out anew
set -euo pipefail
cd "$2"

# Other versions of clang-format lay out some lines differently.
if ! clang-format --version 2>/dev/null | grep -q 'version 14\.'; then
    echo "clang-format 14 is not here"
    exit 77
fi

mapfile -d '' sources < <(find . \( -path ./.git -o -path ./build -o -path ./out \) -prune \
    -o -regex '.*\.\(c\|cpp\|h\|hpp\)' -print0)
if [ "$1" = --fix ]; then
    clang-format -i "${sources[@]}"
    exit
fi

status=0
for source in "${sources[@]}"; do
    if ! clang-format "$source" | cmp -s - "$source"; then
        echo "$source: 'make format' would change it"
        status=1
    fi
done
exit $status
