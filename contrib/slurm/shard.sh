#!/usr/bin/env bash
# One task of the array: one shard. Takes up what an earlier attempt of the same task left.
set -euo pipefail
# The number of shards is given, not read from the array: a task that is sent in again by hand is
# an array of its own.
exec "$STRATCLI" map "$@" --quiet --resume --threads "${SLURM_CPUS_PER_TASK:-1}" \
  --shard "$SLURM_ARRAY_TASK_ID/$STRAT_SHARDS" -o "$STRAT_FOLDER/$SLURM_ARRAY_TASK_ID.tiles"
