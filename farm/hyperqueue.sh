#!/usr/bin/env bash
#
# A render on a HyperQueue cluster, https://it4innovations.github.io/hyperqueue: an array of parts, tried again where one
# is lost, and merged when all are there.
#
#   hyperqueue.sh FOLDER PARTS PASSES OUTPUT SCENE [FLAGS of nephroid render]
#   hyperqueue.sh parts 16 64 out.exr scene.xml --spp 4096
#
# HQ_SERVER_DIR names the folder of a running server; without it, a server and WORKERS (2) workers are started here.
# NEPHROID names the command. Python's package `hyperqueue` is used from VENV, which is made if need be.

set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
if (($# < 5)); then
    sed -n '3,11s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
    exit 2
fi
venv=${VENV:-${XDG_CACHE_HOME:-$HOME/.cache}/nephroid/hyperqueue}
if [[ ! -x $venv/bin/python ]]; then
    python3 -m venv "$venv"
fi
if ! "$venv/bin/python" -c 'import hyperqueue' 2>/dev/null; then
    "$venv/bin/pip" install --quiet hyperqueue==0.27.0
fi
exec "$venv/bin/python" "$here/submit.py" "$@"
