#!/usr/bin/env bash
# Starts the real window on a virtual display, clicks a pixel that an edge cuts, saves the curve,
# and holds its exponent against 3/2. Keeps the screenshot and the curve in target/window.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../../.."

out=target/window
rm -rf "$out"
. crates/stratviz/tests/display.sh
start_display 1280x720
start_explorer "${1:-target/debug/stratviz}" edges
# The target is mostly mid-grey patterns.
until_it_holds picture_is_drawn

# Pixel 216, 24 of the picture, in a window of 1280 × 720 as it opens the first time.
xdotool mousemove 475 146
sleep 0.5
xdotool click 1
curve="$PWD/$out/curve.csv"
save_curve() {
    xdotool key ctrl+e
    sleep 0.5
    xdotool key ctrl+a
    xdotool type "$curve"
    xdotool key Return
    sleep 0.5
    [ -s "$curve" ]
}
sleep 3
import -window root "$out/screenshot.png"
until_it_holds save_curve

# Jittered's exponent, and the pixel it belongs to.
awk -F, '
    $5 == "jittered" && !seen++ {
        printf "pixel %s, %s: jittered p = %.3f ± %.3f with M = %s\n", $2, $3, $16, $17, $10
        good = $2 == 216 && $3 == 24 && $16 > 1.4 && $16 < 1.65
    }
    END { exit !good }
' "$curve"
