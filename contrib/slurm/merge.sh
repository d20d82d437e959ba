#!/usr/bin/env bash
# The dependent job: every shard is there, so make the map.
set -euo pipefail
exec "$STRATCLI" merge "$STRAT_FOLDER"/*.tiles -o "$1"
