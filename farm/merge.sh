#!/usr/bin/env bash
#
# The picture of all parts of a render; where passes are missing, it names them, and ends with code 4.
#
#   merge.sh FOLDER PARTS OUTPUT
#
# NEPHROID names the command.

set -euo pipefail
if (($# != 3)); then
    sed -n '3,7s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
    exit 2
fi
folder=$1 parts=$2 output=$3
films=()
for ((n = 0; n < parts; n++)); do
    # Where there are more parts than passes, some have none, and no film.
    if [[ -e $folder/$n.film ]]; then
        films+=("$folder/$n.film")
    fi
done
if ((${#films[@]} == 0)); then
    printf '%s has no film\n' "$folder" >&2
    exit 4
fi
exec "${NEPHROID:-nephroid}" merge "${films[@]}" -o "$output" --complete
