#!/usr/bin/env bash
# mbpoll, pymodbus, modbus-serial and libmodbus read the same identity, in both word orders, and the
# item that each of them sends is the item in the journal.
here=$(dirname "$0")
# shellcheck source=tests/gateway/outside/common.sh
source "$here/outside/common.sh" "$@"
need mbpoll node npm

client=$(find "$build" -name gateway_libmodbus_client -type f -perm -u+x | head -1)
if [ -z "$client" ]; then
    echo "gateway_libmodbus_client is not under $build"
    exit 1
fi

# modbus-serial as the lock file has it; without what it needs for serial lines.
npm=$build/npm
if ! cmp -s "$here/outside/package-lock.json" "$npm/installed.json"; then
    mkdir -p "$npm"
    cp "$here/outside/package.json" "$here/outside/package-lock.json" "$npm/"
    if ! (cd "$npm" && npm ci --omit=optional --ignore-scripts --no-audit --no-fund) >"$npm/log" 2>&1; then
        tail -3 "$npm/log"
        missing "npm's modbus-serial"
    fi
    cp "$npm/package-lock.json" "$npm/installed.json"
fi
exec "$python" "$here/outside/clients_check.py" "$gateway" "$client" "$npm/node_modules"
