#!/bin/sh
# The guide (docs/guide.md) taken literally, by mouse and keyboard in a real window under Xvfb: from an empty folder to code.
# Photographs each step into docs/pictures/. Needs: xvfb, xdotool, ImageMagick, Mesa. Usage: tests/studio/new-user.sh [WINDOW-PROGRAM]
set -eu
cd "$(dirname "$0")/../.."
window=$(realpath "${1:-target/release/examples/window}")
docs=$(realpath docs/pictures)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/machines"
export XDG_STATE_HOME="$work/state" XDG_RUNTIME_DIR="$work" LIBGL_ALWAYS_SOFTWARE=1 WINDOW="$window" WORK="$work" DOCS="$docs"
unset WAYLAND_DISPLAY || true
cat > "$work/hand" <<'HAND'
set -eu
pause() { sleep "${SLOW:-3}"; }
click() { xdotool mousemove "$1" "$2"; sleep 0.5; xdotool click 1; pause; }
picture() { xdotool mousemove 300 794; sleep 1; import -window root "$DOCS/guide-$1.png"; }
cd "$WORK/machines"
"$WINDOW" & pid=$!
pause; pause
xdotool search --name Counterpoise windowfocus --sync 2> /dev/null || true
click 900 248                                  # the field of the path
xdotool key End
xdotool type --delay 30 turret; pause
picture 1-new
click 902 564                                  # New project here
pause; pause
click 185 18                                   # Plant
picture 2-plant
click 311 18                                   # Design
xdotool mousemove 644 170 mousedown 1; sleep 0.5
for k in 1 2 3 4 5 6 7 8; do xdotool mousemove $(( 644 - k )) $(( 170 + k / 4 )); sleep 0.2; done
sleep 1; xdotool mouseup 1; pause
picture 3-design
click 373 18                                   # Verify
pause
picture 4-verify
click 112 57                                   # Export code
pause
picture 5-export
xdotool key ctrl+s; pause
kill $pid
HAND
xvfb-run -a -s "-screen 0 1280x800x24" sh "$work/hand"
find "$work/machines" -type f | sort | sed "s|$work/||"
grep -A3 'synth.feedback.error\]' "$work/machines/turret/project.toml"
test -f "$work/machines/turret/out/controller.c"
