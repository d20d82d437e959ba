#!/usr/bin/env bash
# Tries the scripts on a Slurm of one node: an array of 8 shards, one of them killed half-way and
# sent in again, merged, and compared byte by byte with a single run. Needs root, slurm-wlm and
# munge; a minute or two.
#
#   STRATCLI=target/release/stratcli contrib/slurm/selftest.sh
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
STRATCLI=$(realpath "${STRATCLI:-target/release/stratcli}")
export STRATCLI
slurm=$(mktemp -d /tmp/slurm.XXXXXX) work=$(mktemp -d /tmp/slurm-map.XXXXXX)
trap '"$here/local-slurm.sh" down "$slurm"; rm -rf "$work"' EXIT
"$here/local-slurm.sh" up "$slurm"
export SLURM_CONF=$slurm/slurm.conf
cd "$work"
options=(--region 0,0,256,192 --counts "1..12^2" --trials "${STRAT_TEST_TRIALS:-200}")

"$here/submit.sh" 8 map classic "${options[@]}"
array=$(cat map.shards/array.id)
# The first task that has stored a tile is killed as hard as can be.
victim=
for _ in $(seq 600); do
  for part in map.shards/*.tiles.part; do
    if [[ -e $part && $(stat -c %s "$part") -gt 20000 ]]; then victim=$(basename "$part" .tiles.part); fi
  done
  if [[ -n $victim ]]; then break; fi
  sleep 0.1
done
: "${victim:?no task stored a tile}"
scancel --signal=KILL --full "${array}_$victim" || scancel "${array}_$victim"
echo "killed task $victim with $(stat -c %s "map.shards/$victim.tiles.part") bytes of tiles"
for _ in $(seq 600); do
  if [[ -z $(squeue -h -r -j "$array" -o %K 2>/dev/null | grep -x "$victim") ]]; then break; fi
  sleep 0.2
done
[[ ! -e map.shards/$victim.tiles ]] || { echo "task $victim was done before it was killed" >&2; exit 1; }
"$here/requeue.sh" 8 map classic "${options[@]}"
for _ in $(seq 1200); do
  if [[ -e map.json ]]; then break; fi
  sleep 0.5
done
"$here/watch.sh" map

mkdir single
"$STRATCLI" map classic "${options[@]}" --quiet -o single/map.exr >/dev/null
for file in map.exr map.png map.fits.csv map.json; do
  cmp "$file" "single/$file"
done
echo "same bytes as a single run: map.exr map.png map.fits.csv map.json"
