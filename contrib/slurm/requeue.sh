#!/usr/bin/env bash
# Sends in again the shards of a submitted map that have ended without their file, and a merge
# that waits for them.
#
#   contrib/slurm/requeue.sh N OUT SCENE [options of `stratcli map`]      as given to submit.sh
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
n=${1:?N} out=${2:?OUT} scene=${3:?SCENE}
out=${out%.exr}
shift 3
shards=$out.shards
export STRATCLI=${STRATCLI:-stratcli} STRAT_SHARDS=$n STRAT_FOLDER=$shards

array=$(cat "$shards/array.id")
# Tasks that wait or run are left alone.
active=$(squeue -h -r -o %K -j "$array" 2>/dev/null || true)
lost=()
for i in $(seq "$n"); do
  if [[ ! -e $shards/$i.tiles ]] && ! grep -qx "$i" <<<"$active"; then lost+=("$i"); fi
done
if ((${#lost[@]} == 0)); then
  echo "no shard has failed"
  exit
fi
list=$(IFS=,; echo "${lost[*]}")
read -ra task_options <<<"${STRAT_TASK_OPTIONS:-}"
read -ra merge_options <<<"${STRAT_MERGE_OPTIONS:-}"
again=$(sbatch --parsable --job-name="map-$(basename "$out")" --array="$list" --requeue --open-mode=append \
  --output="$shards/%a.log" "${task_options[@]}" "$here/shard.sh" "$scene" "$@")
# The first merge can never run any more: one of the tasks it waits for has failed.
scancel "$(cat "$shards/merge.id")" 2>/dev/null || true
wait_for=afterok:$again
if [[ -n $active ]]; then wait_for+=,afterany:$array; fi
merge=$(sbatch --parsable --job-name="merge-$(basename "$out")" --dependency="$wait_for" \
  --output="$shards/merge.log" "${merge_options[@]}" "$here/merge.sh" "$out.exr")
echo "$again" >"$shards/array.id"
echo "$merge" >"$shards/merge.id"
echo "shards $list again as array $again, merge $merge"
