#!/bin/sh
# From an empty folder to a verified controller, by what README and --help say alone: new, check, design, and the compiled self-test.
# Usage: tests/walk/new-machine.sh [PROGRAM]
set -eu
cd "$(dirname "$0")/../.."
program=$(realpath "${1:-target/release/counterpoise}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# What a new user reads first names every command of this walk.
"$program" --help > "$work/help"
for command in new check design; do
    grep -q "^  $command " "$work/help" || { echo "--help does not name $command"; exit 1; }
done
grep -q 'counterpoise new FOLDER --like' README.md || { echo "the README does not name new --like"; exit 1; }
kinds=$("$program" new --help | grep -o '<sight|[a-z|-]*>' | tr -d '<>' | tr '|' ' ')
test -n "$kinds" || { echo "new --help does not list the kinds of machine"; exit 1; }

cd "$work"
for kind in $kinds; do
    "$program" new "$kind" --like "$kind" > /dev/null
    lines=$(wc -l < "$kind/project.toml")
    test "$lines" -le 25 || { echo "$kind: $lines lines"; exit 1; }
    "$program" check "$kind" > "$kind/check.txt"
    grep -q '^Assumed' "$kind/check.txt" || { echo "$kind: nothing is said to be assumed"; exit 1; }
    if "$program" design "$kind" -o "$kind/out" --quiet > "$kind/design.txt" 2>&1; then :; else
        echo "$kind: design fails"; cat "$kind/design.txt"; exit 1
    fi
    test -s "$kind/out/report.html"
    if grep 'the C in .* was not compared' "$kind/design.txt"; then echo "$kind: the compiled C was not compared with its model"; exit 1; fi
    (cd "$kind/out" && cc -std=c99 -O1 -ffp-contract=off -o self_test controller.c controller_self_test.c controller_test.c -lm 2> compiler.txt \
        && ./self_test > self_test.txt) || { echo "$kind: the self-test fails"; exit 1; }
    echo "$kind: $lines lines, designed, verified, exported, self-test passed"
done
