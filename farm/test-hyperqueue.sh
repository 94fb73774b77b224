#!/usr/bin/env bash
#
# A render on a HyperQueue server with two workers on this machine, of which one task is killed in mid-render, with all
# its processes; then everything is, server and workers, and started anew. The merged picture must be that of a single
# run, to the bit.
#
#   test-hyperqueue.sh [NEPHROID]
#
# It is left out where Python's package cannot be had, and says so.

set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
nephroid=$(realpath "${1:-$here/../target/release/nephroid}")
scratch=$(mktemp -d)
farm=

# Processes below one, itself first: any of its threads may have started them.
family() {
    printf '%s\n' "$1"
    local child
    for child in $(cat /proc/"$1"/task/*/children 2>/dev/null); do
        family "$child"
    done
}

clear_away() {
    if [[ -n $farm ]]; then
        # shellcheck disable=SC2046
        kill -9 $(family "$farm") 2>/dev/null || true
    fi
    rm -rf "$scratch"
}
trap clear_away EXIT
cd "$scratch"

export VENV=$scratch/venv NEPHROID=$nephroid WORKERS=2 PIDS=$scratch/pids
mkdir "$PIDS"
if ! { python3 -m venv "$VENV" && timeout 120 "$VENV/bin/pip" install --quiet --retries 0 --timeout 10 hyperqueue==0.27.0; } >pip.log 2>&1; then
    tail -n 3 pip.log
    printf '!!! LEFT OUT: HyperQueue cannot be installed here, so nothing was tested\n'
    exit 0
fi

parts=4 passes=8
flags=(cornell --spp 256 --resolution 120x90 --photons 20000 --seed 4 --threads 1 --checkpoint-every 0.05)
"$nephroid" render "${flags[@]:0:9}" --passes $passes -o whole.exr --quiet

start() {
    # A session of its own, so that it can be killed with all that it started.
    setsid "$here/hyperqueue.sh" parts $parts $passes merged.exr "${flags[@]}" >>farm.log 2>&1 &
    farm=$!
}

# victim: waits until some part keeps a checkpoint, and prints the process of its task.
victim() {
    local i n
    for ((i = 0; i < 1200; i++)); do
        for ((n = 0; n < parts; n++)); do
            if [[ -e parts/unfinished/$n.checkpoint.film && -e $PIDS/$n.pid ]]; then
                cat "$PIDS/$n.pid"
                return
            fi
        done
        sleep 0.05
    done
    printf 'no part keeps a checkpoint\n' >&2
    cat farm.log parts/*.log >&2
    return 1
}

start
task=$(victim)
# shellcheck disable=SC2046
kill -9 $(family "$task")
printf 'killed a task in mid-render\n'
sleep 0.3
# shellcheck disable=SC2046
kill -9 $(family "$farm")
wait "$farm" 2>/dev/null || true
printf 'killed server, workers and tasks, with %s of %s parts there\n' "$(find parts -maxdepth 1 -name '*.film' | wc -l)" $parts
start
if ! wait "$farm"; then
    cat farm.log parts/*.log
    exit 1
fi
farm=
tail -n 3 farm.log
cmp whole.exr merged.exr
printf 'the merged picture is that of a single run, to the bit\n'

# The folder is of one render only.
code=0
"$here/part.sh" parts 0 $parts $passes "${flags[@]}" --seed 5 2>refused.log || code=$?
if ((code != 2)); then
    cat refused.log
    exit 1
fi
printf 'another render is refused\n'
