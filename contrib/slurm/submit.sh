#!/usr/bin/env bash
# Submits a map as an array job of even shards, and a job that merges them when all are done.
#
#   contrib/slurm/submit.sh N OUT SCENE [options of `stratcli map`]
#
# N shards go to OUT.shards/, the map to OUT.exr. Runs again as it is: what is done is not done
# again. STRATCLI names the binary; SBATCH_* variables and the two below choose resources.
#   STRAT_TASK_OPTIONS   options of sbatch for each shard, such as "--cpus-per-task=16 --time=2:00:00"
#   STRAT_MERGE_OPTIONS  the same for the merge
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
if (($# < 3)); then
  sed -n '2,10s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
  exit 2
fi
n=$1 out=${2%.exr} scene=$3
shift 3
shards=$out.shards
mkdir -p "$shards"
export STRATCLI=${STRATCLI:-stratcli} STRAT_SHARDS=$n STRAT_FOLDER=$shards

read -ra task_options <<<"${STRAT_TASK_OPTIONS:-}"
read -ra merge_options <<<"${STRAT_MERGE_OPTIONS:-}"
array=$(sbatch --parsable --job-name="map-$(basename "$out")" --array="1-$n" --requeue --open-mode=append \
  --output="$shards/%a.log" "${task_options[@]}" "$here/shard.sh" "$scene" "$@")
merge=$(sbatch --parsable --job-name="merge-$(basename "$out")" --dependency="afterok:$array" \
  --output="$shards/merge.log" "${merge_options[@]}" "$here/merge.sh" "$out.exr")
echo "$array" >"$shards/array.id"
echo "$merge" >"$shards/merge.id"
echo "array $array, merge $merge; watch them with $here/watch.sh $out"
