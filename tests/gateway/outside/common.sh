# shellcheck shell=bash
# Shared by the scripts test_outside*.sh and test_journal_files.sh; sourced with the build and the
# source folder as arguments. Sets build, source, gateway, python.
set -euo pipefail
build=$1
# shellcheck disable=SC2034 # for those that source this
source=$2
PATH=$PATH:/usr/sbin

gateway=$(find "$build" -name packcell-gateway -type f -perm -u+x | head -1)
if [ -z "$gateway" ]; then
    echo "packcell-gateway is not under $build"
    exit 1
fi

# missing WHAT: the test is skipped, or fails where everything has to be there.
missing() {
    echo "$1 is not installed"
    [ "${PACKCELL_REQUIRE_CLIENTS:-}" != 1 ] || exit 1
    exit 77
}

# need TOOL...
need() {
    local tool
    for tool in "$@"; do
        command -v "$tool" >/dev/null || missing "$tool"
    done
}

# Debian's, for which Debian's pymodbus is; other builds of Python may come first in the path.
python=/usr/bin/python3
need "$python"
"$python" -c 'import pymodbus' 2>/dev/null || missing pymodbus
