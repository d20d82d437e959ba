#!/usr/bin/env bash
# Says how far a submitted map is: shards done, begun and not begun, and what the queue holds.
#
#   contrib/slurm/watch.sh OUT [SECONDS]     once, or every so many seconds until it is merged
set -euo pipefail
out=${1:?OUT as given to submit.sh}
out=${out%.exr}
while :; do
  done=$(find "$out.shards" -name '*.tiles' | wc -l)
  begun=$(find "$out.shards" -name '*.tiles.part' | wc -l)
  queue=$(squeue -h -o '%T' -j "$(cat "$out.shards/array.id"),$(cat "$out.shards/merge.id")" 2>/dev/null |
    sort | uniq -c | tr -s ' \n' ' ' || true)
  echo "$(date +%T) shards done $done, begun $begun; queue:${queue:- empty}"
  if [[ -e $out.json || -z ${2:-} ]]; then break; fi
  sleep "$2"
done
if [[ -e $out.json ]]; then echo "merged: $out.exr"; fi
