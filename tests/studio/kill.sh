#!/bin/sh
# The real window under Xvfb, killed (SIGKILL) thirty times at odd moments of a scripted session; what was drawn before is compared
# with what the studio finds again. Needs: xvfb, Mesa. Usage: tests/studio/kill.sh [WINDOW-PROGRAM] [TIMES]
set -eu
cd "$(dirname "$0")/../.."
window=${1:-target/release/examples/window}
times=${2:-30}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export XDG_RUNTIME_DIR="$work" LIBGL_ALWAYS_SOFTWARE=1
unset WAYLAND_DISPLAY || true
# Edit k sets the gain to 25 + k/100: what is found again says how many edits were kept.
awk 'BEGIN { for (k = 1; k <= 5000; k++) printf "{\"set\":{\"path\":\"synth.feedback.error.gain\",\"value\":%.2f,\"gesture\":%d}}\n", 25 + k / 100, k / 20 }' > "$work/edits"
printf '"save"\n' > "$work/save"
worst=0
kill=1
while [ "$kill" -le "$times" ]; do
    rm -rf "$work/rig" "$work/state"
    cp -r examples/reference-rig "$work/rig"
    export XDG_STATE_HOME="$work/state"
    pause=$(awk -v k="$kill" 'BEGIN { print 2.5 + (k * 37 % 20) / 10 }')
    xvfb-run -a -s "-screen 0 1280x800x24" sh -c "
        '$window' '$work/rig' '$work/edits' 1280x800 '$work/frames' & pid=\$!
        sleep $pause
        kill -9 \$pid" > "$work/said" 2>&1 || true
    drawn=$(awk -F, 'NR > 1 { r = $1 } END { print r + 0 }' "$work/frames")
    NO_WINDOW=1 "$window" "$work/rig" "$work/save" > "$work/said" 2>&1
    found=$(awk '/^\[synth.feedback.error\]/ { on = 1 } on && /^gain/ { printf "%d\n", ($3 - 25) * 100 + 0.5; exit }' "$work/rig/project.toml")
    lost=$(( drawn > found ? drawn - found : 0 ))
    echo "kill $kill after $pause s: $drawn edits drawn, $found found again, $lost lost"
    [ "$lost" -gt "$worst" ] && worst=$lost
    kill=$(( kill + 1 ))
done
echo "$times kills; at most $worst edits that were drawn were lost"
