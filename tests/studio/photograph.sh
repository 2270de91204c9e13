#!/bin/sh
# Starts the real window under Xvfb (software GL), drives it by a log of commands, and photographs each place into docs/.
# Needs: xvfb, ImageMagick, Mesa. Usage: tests/studio/photograph.sh [WINDOW-PROGRAM]
set -eu
cd "$(dirname "$0")/../.."
window=${1:-target/release/examples/window}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -r examples/reference-rig "$work/rig"
export XDG_STATE_HOME="$work/state" XDG_RUNTIME_DIR="$work" LIBGL_ALWAYS_SOFTWARE=1
unset WAYLAND_DISPLAY || true
mkdir -p docs
shoot() { # NAME SIZE SCALE SECONDS COMMANDS...
    name=$1 size=$2 scale=$3 seconds=$4
    shift 4
    printf '%s\n' "$@" > "$work/script"
    points="$(( ${size%x*} / scale ))x$(( ${size#*x} / scale ))"
    rm -rf "$work/state"
    xvfb-run -a -s "-screen 0 ${size}x24" sh -c "
        export WINIT_X11_SCALE_FACTOR=$scale
        '$window' '$work/rig' '$work/script' $points & pid=\$!
        sleep 2
        command -v xdotool > /dev/null && xdotool mousemove 300 $(( ${size#*x} - 6 ))
        sleep $(( seconds - 2 ))
        import -window root docs/$name.png
        kill \$pid || echo "$name: the window has ended by itself" >&2"
}
drag=$(for k in 26 27 28 29 30 31; do printf '{"set":{"path":"synth.feedback.error.gain","value":%s,"gesture":1}}\n' $k; done)
shoot studio-design 1280x800 1 6 '{"keep":{"slot":"A"}}' "$drag" '{"go":{"place":"design"}}'
shoot studio-plant 1280x800 1 5 '{"go":{"place":"plant"}}'
shoot studio-reduce 1280x800 1 5 '{"set-text":{"path":"reduce.method","value":"balanced"}}' '{"set-whole":{"path":"reduce.order","value":6}}' '{"go":{"place":"reduce"}}'
shoot studio-verify 1280x800 1 6 '{"go":{"place":"verify"}}' '"verify"'
shoot studio-infeasible 1280x800 1 6 '{"set-text":{"path":"synth.feedback.control.form","value":"integral"}}' '{"go":{"place":"design"}}'
shoot studio-light 1280x800 1 6 '"toggle-theme"' '{"go":{"place":"design"}}'
shoot studio-design-2560 2560x1440 1 7 '{"go":{"place":"design"}}'
shoot studio-commands 1280x800 1 5 '"palette"'
