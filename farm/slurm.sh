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
# A merge of what is there: a part that was lost for good is a warning in its log, and a gap in the picture's samples.
merge="$(quoted "$nephroid" merge)$(quoted "$folder")/*.film $(quoted -o "$output")"
merge=${merge/" /*.film"/"/*.film"}
"${SBATCH:-sbatch}" --parsable --dependency="afterany:${job%%;*}" --job-name=nephroid-merge \
    --output="$folder/merge.log" "${more[@]}" --wrap="$merge"
printf 'parts: job %s; they arrive as %s/*.film\n' "${job%%;*}" "$folder" >&2
