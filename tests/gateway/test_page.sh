#!/usr/bin/env bash
# The operator page: what its server answers and refuses, and the page itself in a browser. Skipped
# without Chromium, when the server's part holds.
set -euo pipefail
build=$1
source=$2

server=$(find "$build" -name gateway_page_server -type f -perm -u+x | head -1)
if [ -z "$server" ]; then
    echo "gateway_page_server is not under $build"
    exit 1
fi
TZ=UTC python3 -B "$source/tests/gateway/page_check.py" "$server"
