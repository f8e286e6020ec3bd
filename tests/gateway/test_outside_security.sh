#!/usr/bin/env bash
# Dripping clients, a ninth connection and hostile bytes disturb nobody; nobody gets in or writes who
# was not let in.
here=$(dirname "$0")
# shellcheck source=tests/gateway/outside/common.sh
source "$here/outside/common.sh" "$@"
exec "$python" "$here/outside/security_check.py" "$gateway"
