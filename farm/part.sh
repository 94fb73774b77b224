#!/usr/bin/env bash
#
# One part of a render, for any scheduler: renders its passes into FOLDER/NUMBER.film, and goes on where an earlier
# attempt was interrupted.
#
#   part.sh FOLDER NUMBER PARTS PASSES SCENE [FLAGS of nephroid render]
#
# The parts are numbered from 0. NEPHROID names the command, ATTEMPTS how often to try (3). FOLDER is for one render
# only: what it is of is in FOLDER/job, and another render is refused. What is not finished is in FOLDER/unfinished.
# PIDS names a folder for the number of this process, for a test that kills it.

set -euo pipefail
if (($# < 5)); then
    sed -n '3,11s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
    exit 2
fi
folder=$1 number=$2 parts=$3 passes=$4
shift 4
nephroid=${NEPHROID:-nephroid}
begin=$((number * passes / parts)) end=$(((number + 1) * passes / parts))
unfinished=$folder/unfinished
film=$folder/$number.film kept=$unfinished/$number.checkpoint.film new=$unfinished/$number.film
mkdir -p "$unfinished"
[[ -z ${PIDS:-} ]] || echo $$ >"$PIDS/$number.pid"

# Films of other flags would be taken for those of these.
job="PARTS $parts PASSES $passes:$(printf ' %q' "$@")"
if [[ ! -e $folder/job ]]; then
    printf '%s\n' "$job" >"$unfinished/job.$number.$$"
    # Another part may be quicker, and its job stays.
    mv -n "$unfinished/job.$number.$$" "$folder/job" || true
    rm -f "$unfinished/job.$number.$$"
fi
if [[ $(<"$folder/job") != "$job" ]]; then
    printf '%s is of another render: take another folder\n  it is of: %s\n  not of:   %s\n' \
        "$folder" "$(<"$folder/job")" "$job" >&2
    exit 2
fi

render() {
    "$nephroid" render "$@" --passes "$passes" --pass-range "$begin..$end" --checkpoint "$kept" -o "$new" --quiet
}

attempt() {
    if [[ ! -e $kept ]]; then
        render "$@"
        return
    fi
    local code=0
    "$nephroid" resume "$kept" -o "$new" --quiet || code=$?
    # What cannot be gone on with is damaged, or of another version or scene.
    if ((code == 4)) && [[ ! -e $kept.refused ]]; then
        mv "$kept" "$kept.refused"
        printf 'part %s: begins anew; what cannot be gone on with is %s\n' "$number" "$kept.refused" >&2
        code=0
        render "$@" || code=$?
    fi
    return "$code"
}

if ((begin == end)) || [[ -e $film ]]; then
    exit 0 # there are more parts than passes, or this one is done
fi
for ((i = 1; ; i++)); do
    code=0
    attempt "$@" || code=$?
    case $code in
    # A wrong command line, scene, file or program will not be better next time, and who stops it means it.
    0 | 2 | 3 | 4 | 70 | 130) break ;;
    esac
    printf 'part %s: attempt %s ended with %s\n' "$number" "$i" "$code" >&2
    if ((i >= ${ATTEMPTS:-3})); then
        break
    fi
done
# A film is put in its place only when it has all passes: one that was stopped has less.
if ((code == 0)); then
    mv "$new" "$film"
    rm -f "$kept" "$kept.refused"
fi
exit "$code"
