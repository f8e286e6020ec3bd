#!/usr/bin/env bash
# The journal's files cut at any byte, damaged, on a full disk, or opened twice: an unbroken prefix of
# what was acknowledged, or a refusal.
here=$(dirname "$0")
# shellcheck source=tests/gateway/outside/common.sh
source "$here/outside/common.sh" "$@"
exec "$python" "$here/outside/journal_check.py" "$gateway"
