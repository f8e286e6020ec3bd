#!/usr/bin/env bash
# The library's binary interface is the stored one: what `make checkabi` says.
set -euo pipefail
library=$1/lib/abi/libpackcell.so.0

# Sanitised builds do not have it; a plain build always does.
if [ ! -e "$library" ]; then
    echo "there is no $library"
    exit 77
fi
status=0
"$2/tests/abi/check.sh" "$library" "$2" || status=$?
[ "$status" != 77 ] || [ "${PACKCELL_REQUIRE_CLIENTS:-}" != 1 ] || status=1
exit "$status"
