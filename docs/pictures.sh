#!/usr/bin/env bash
# Takes the pictures of the explorer that README.md and docs/explorer.md show, from a build of it:
#
#     cargo build --release --workspace --bins && docs/pictures.sh
#
# Needs what crates/stratviz/tests/window.sh needs (CONTRIBUTING.md). The pictures differ from
# machine to machine by the times that are on them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

out=$(mktemp -d)
. crates/stratviz/tests/display.sh
start_display 1280x720
start_explorer "${1:-target/release/stratviz}" edges
until_it_holds picture_is_drawn

# Writes docs/NAME.png once everything has been computed.
take() {
    until_it_holds display_is_still
    import -window root "docs/$1.png"
    convert "docs/$1.png" -strip -define png:compression-level=9 "docs/$1.png"
    echo "docs/$1.png"
}
open_line() {
    command_named "open a command"
    xdotool type "$1"
    xdotool key Return
    sleep 0.5
}

open_line "stratcli pixel edges --at 216,24 --samplers random,jittered,sobol,halton --n-policy snap --until p:0.02 --max-trials 4000"
xdotool mousemove 475 146
take explorer
xdotool key 2
take explorer-theory
xdotool key 3
command_named measure
take explorer-trade
xdotool key 4
take explorer-patterns
xdotool key 1 ctrl+shift+p
sleep 0.5
xdotool type map
take explorer-commands
xdotool key Escape
open_line "stratcli pixel classic --at 111,108 --samplers random,jittered,sobol,halton --n-policy snap --until p:0.02 --max-trials 4000"
until_it_holds display_is_still
xdotool key m
xdotool mousemove 244 330
take explorer-map
