# A virtual display and the explorer on it, for the scripts that source this file. They set `out`,
# the folder that logs and the session go to.

# Starts a display of this size; DISPLAY is set.
start_display() {
    mkdir -p "$out"
    exec 3< <(exec Xvfb -displayfd 1 -screen 0 "$1x24" -nolisten tcp 2>"$out/xvfb.log")
    server=$!
    program=
    trap stop EXIT
    read -r -t 60 number <&3
    export DISPLAY=:$number LIBGL_ALWAYS_SOFTWARE=1
}

stop() {
    if [ -n "$program" ]; then kill "$program" 2>/dev/null || true; fi
    kill "$server" 2>/dev/null || true
}

# Starts the explorer with these words, and fills the display with its window.
start_explorer() {
    "$@" --session "$out/session.ron" 2>"$out/stratviz.log" &
    program=$!
    until_it_holds xdotool search --name '^stratviz$' >/dev/null
    window=$(xdotool search --name '^stratviz$' | head -n 1)
    # shellcheck disable=SC2046  # width and height
    xdotool windowmove "$window" 0 0 windowsize "$window" $(xdotool getdisplaygeometry)
    xdotool windowfocus "$window"
}

# Tries a command until it succeeds, for two minutes at the most.
until_it_holds() {
    for _ in $(seq 600); do
        if "$@" 2>/dev/null; then return; fi
        sleep 0.2
    done
    echo "$0: gave up on: $*" >&2
    return 1
}

# Whether there are many colours where the picture is.
picture_is_drawn() {
    [ "$(import -window root png:- | convert png:- -crop 400x300+80+250 -unique-colors txt:- | wc -l)" -gt 40 ]
}

# Whether nothing changes on the display for a second.
display_is_still() {
    local before after
    before=$(import -window root rgb:- | cksum)
    sleep 1
    after=$(import -window root rgb:- | cksum)
    [ "$before" = "$after" ]
}

# Runs what the palette finds by these words.
command_named() {
    xdotool key ctrl+shift+p
    sleep 0.5
    xdotool type "$1"
    sleep 0.5
    xdotool key Return
    sleep 0.5
}
