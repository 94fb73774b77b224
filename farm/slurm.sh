#!/usr/bin/env bash
#
# A render on a Slurm cluster: an array of parts, requeued where a node is lost, and a merge when all have ended.
#
#   slurm.sh FOLDER PARTS PASSES OUTPUT SCENE [FLAGS of nephroid render]
#
# FOLDER must be seen by all nodes. SBATCH_FLAGS go to both jobs, as in SBATCH_FLAGS='--partition=long --time=4:00:00'.
# SBATCH names the command to submit with.

set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
if (($# < 5)); then
    sed -n '3,9s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
    exit 2
fi
folder=$1 parts=$2 passes=$3 output=$4
shift 4
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
read -ra more <<<"${SBATCH_FLAGS:-}"
nephroid=${NEPHROID:-nephroid}

quoted() {
    printf '%q ' "$@"
}

# The number of the part is known to Slurm only: it is put where the command is run.
part="$(quoted env "NEPHROID=$nephroid" "$here/part.sh" "$folder")\$SLURM_ARRAY_TASK_ID $(quoted "$parts" "$passes" "$@")"
job=$("${SBATCH:-sbatch}" --parsable --requeue --array="0-$((parts - 1))" --cpus-per-task="${CPUS:-4}" \
    --job-name=nephroid --output="$folder/%a.log" "${more[@]}" --wrap="$part")
# Where a part was lost for good, it fails, and names what is missing in its log.
merge=$(quoted env "NEPHROID=$nephroid" "$here/merge.sh" "$folder" "$parts" "$output")
"${SBATCH:-sbatch}" --parsable --dependency="afterany:${job%%;*}" --job-name=nephroid-merge \
    --output="$folder/merge.log" "${more[@]}" --wrap="$merge"
printf 'parts: job %s; they arrive as %s/*.film\n' "${job%%;*}" "$folder" >&2
