#!/bin/sh
# Starts the real window under Xvfb (software GL), drives it by a log of commands, and photographs each place into docs/pictures/.
# Needs: xvfb, xdotool, ImageMagick, Mesa. Usage: tests/studio/photograph.sh [WINDOW-PROGRAM] [NAME...]
set -eu
cd "$(dirname "$0")/../.."
window=${1:-target/release/examples/window}
[ $# -gt 0 ] && shift
only=" $* "
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export XDG_STATE_HOME="$work/state" XDG_RUNTIME_DIR="$work" LIBGL_ALWAYS_SOFTWARE=1
unset WAYLAND_DISPLAY || true
mkdir -p docs/pictures
rig=reference-rig
shoot() { # NAME SIZE SCALE SECONDS POINTER COMMANDS...
    name=$1 size=$2 scale=$3 seconds=$4 pointer=$5
    shift 5
    case "$only" in "  " | *" $name "*) ;; *) return 0 ;; esac
    rm -rf "$work/rig" "$work/state"
    cp -r "examples/$rig" "$work/rig"
    printf '%s\n' "$@" | sed "s|RIG|$work/rig|g" > "$work/script"
    points="$(( ${size%x*} / scale ))x$(( ${size#*x} / scale ))"
    xvfb-run -a -s "-screen 0 ${size}x24" sh -c "
        export WINIT_X11_SCALE_FACTOR=$scale
        '$window' '$work/rig' '$work/script' $points & pid=\$!
        sleep $seconds
        xdotool mousemove $pointer
        sleep 2
        import -window root docs/pictures/$name.png
        kill \$pid || echo '$name: the window has ended by itself' >&2"
}
foot="640 794"
drag=$(for k in 26 27 28 29 30 31; do printf '{"set":{"path":"synth.feedback.error.gain","value":%s,"gesture":1}}\n' $k; done)
shoot studio-design 1280x800 1 10 "$foot" '{"keep":{"slot":"A"}}' "$drag" '{"go":{"place":"design"}}'
shoot studio-history 1280x800 1 14 "$foot" '{"keep-design":{"name":"before the change"}}' '{"set":{"path":"synth.feedback.control.gain","value":2.0}}' '{"overlay-design":{"name":"before the change"}}' '{"look-at-design":{"tab":"history"}}'
shoot studio-plant 1280x800 1 9 "$foot" '{"go":{"place":"plant"}}'
shoot studio-reduce 1280x800 1 9 "$foot" '{"set-text":{"path":"reduce.method","value":"balanced"}}' '{"set-whole":{"path":"reduce.order","value":6}}' '{"go":{"place":"reduce"}}'
shoot studio-verify 1280x800 1 10 "560 220" '{"go":{"place":"verify"}}'
shoot studio-rejection 1280x800 1 10 "560 220" '{"look":{"evidence":"rejection"}}'
shoot studio-analyser 1280x800 1 40 "$foot" '{"look":{"evidence":"map"}}' '"measure"'
shoot studio-infeasible 1280x800 1 10 "$foot" '{"set-text":{"path":"synth.feedback.control.form","value":"lag"}}' '{"go":{"place":"design"}}'
shoot studio-light 1280x800 1 10 "$foot" '"toggle-theme"' '{"go":{"place":"design"}}'
shoot studio-loop 1280x800 1 10 "$foot" '{"keep":{"slot":"A"}}' "$drag" '{"look-at-design":{"tab":"loop"}}'
shoot studio-design-2560 2560x1440 1 12 "700 1434" '{"keep":{"slot":"A"}}' "$drag" '{"go":{"place":"design"}}'
shoot studio-design-2x 2560x1600 2 12 "700 1590" '{"go":{"place":"design"}}'
shoot studio-commands 1280x800 1 8 "$foot" '"palette"'
shoot studio-robustness 1280x800 1 60 "$foot" '{"look":{"evidence":"robustness"}}' '"sweep"'
shoot studio-verify-light 2560x1440 1 14 "1200 300" '"toggle-theme"' '{"go":{"place":"verify"}}'
shoot studio-open 1280x800 1 8 "$foot" '{"go":{"place":"plant"}}' '{"browse":{"purpose":"project"}}'
rig=left-out-friction
shoot studio-diagnose 1280x800 1 15 "600 500" '{"recordings":{"paths":["RIG"]}}' '{"inquire":{"inquiry":"errors"}}'
shoot studio-findings 1280x800 1 ${DIAGNOSIS_SECONDS:-240} "$foot" '{"recordings":{"paths":["RIG"]}}' '{"inquire":{"inquiry":"findings"}}' '"diagnose"'
