#!/usr/bin/env bash
#
# One part of a render, for any scheduler: renders its passes into FOLDER/NUMBER.film, and goes on where an earlier
# attempt was interrupted.
#
#   part.sh FOLDER NUMBER PARTS PASSES SCENE [FLAGS of nephroid render]
#
# The parts are numbered from 0. NEPHROID names the command, ATTEMPTS how often to try (3).

set -euo pipefail
folder=$1 number=$2 parts=$3 passes=$4
shift 4
nephroid=${NEPHROID:-nephroid}
begin=$((number * passes / parts)) end=$(((number + 1) * passes / parts))
film=$folder/$number.film checkpoint=$folder/$number.checkpoint
mkdir -p "$folder"
echo $$ >"$folder/$number.pid"

attempt() {
    if [[ -e $film ]]; then
        return 0
    elif [[ -e $checkpoint ]]; then
        "$nephroid" resume "$checkpoint" -o "$film" --quiet
    else
        "$nephroid" render "$@" --passes "$passes" --pass-range "$begin..$end" \
            --checkpoint "$checkpoint" -o "$film" --quiet
    fi
}

if ((begin == end)); then
    exit 0 # there are more parts than passes
fi
for ((i = 1; ; i++)); do
    code=0
    attempt "$@" || code=$?
    # A wrong command line or scene, or a file that cannot be used, will not be better next time.
    if ((code == 0 || code == 2 || code == 3 || code == 4 || i >= ${ATTEMPTS:-3})); then
        break
    fi
    printf 'part %s: attempt %s ended with %s\n' "$number" "$i" "$code" >&2
done
if ((code == 0)); then
    rm -f "$checkpoint" "$folder/$number.pid"
fi
exit "$code"
