#!/usr/bin/env bash
# What a PLC relies on: Held when its heartbeat stops, the published table of PackML commands, plans by
# their deadlines.
here=$(dirname "$0")
# shellcheck source=tests/gateway/outside/common.sh
source "$here/outside/common.sh" "$@"
exec "$python" "$here/outside/plc_check.py" "$gateway" "$source/docs/gateway.md"
