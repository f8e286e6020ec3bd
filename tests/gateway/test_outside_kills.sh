#!/usr/bin/env bash
# Nothing that was acknowledged is lost, and nothing is done twice: repeated, torn and wrong numbers,
# the wrap through 65535, and kill -9 under load.
here=$(dirname "$0")
# shellcheck source=tests/gateway/outside/common.sh
source "$here/outside/common.sh" "$@"
exec "$python" "$here/outside/kills_check.py" "$gateway"
