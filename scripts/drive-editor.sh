#!/usr/bin/env bash
# Drives the real editor by mouse and keys under a virtual display, through a person's round: open, add a node, wire it, drag a
# widget, orbit, undo, save, run headless, compare. Pictures of the window are kept in the folder given, or target/editor.
# Needs Xvfb, xdotool and import (ImageMagick), and a built program: cargo build --features editor.
set -euo pipefail
cd "$(dirname "$0")/.."
program=${VOLTET:-target/debug/voltet}
shots=$(mkdir -p "${1:-target/editor}" && cd "${1:-target/editor}" && pwd)
size=${SIZE:-1280x720}
for tool in Xvfb xdotool import; do
    command -v "$tool" >/dev/null || { echo "SKIPPED: $tool is not installed"; exit 0; }
done
program=$(realpath "$program")

work=$(mktemp -d)
display=:$((90 + RANDOM % 400))
Xvfb "$display" -screen 0 "${size}x24" >"$work/xvfb.log" 2>&1 &
xvfb=$!
editor=
finish() {
    [ -z "$editor" ] || kill "$editor" 2>/dev/null || true
    kill "$xvfb" 2>/dev/null || true
    rm -rf "$work"
}
trap finish EXIT
export DISPLAY=$display
sleep 1

cp editor/by_hand/scene.toml "$work/scene.toml"
cp "$work/scene.toml" "$work/before.toml"

fail() { echo "FAILED: $*"; shot failed; exit 1; }
shot() { import -window root "$shots/$1.png"; }
key() { xdotool key --clearmodifiers "$@"; sleep 0.4; }
drag() { # from x y to x y, button
    xdotool mousemove "$1" "$2" mousedown "${5:-1}"
    local i
    for i in 1 2 3 4 5 6 7 8; do
        xdotool mousemove $(($1 + ($3 - $1) * i / 8)) $(($2 + ($4 - $2) * i / 8))
        sleep 0.03
    done
    sleep 0.1
    xdotool mouseup "${5:-1}"
    sleep 0.5
}
save() { key ctrl+s; sleep 0.5; }

"$program" edit "$work/scene.toml" >"$work/editor.log" 2>&1 &
editor=$!
for _ in $(seq 1 60); do
    xdotool search --name voltet >/dev/null 2>&1 && break
    sleep 0.5
done
sleep "${PATIENCE:-4}"
# Without a window manager nobody gives the window the keys.
xdotool search --onlyvisible --name voltet windowfocus
sleep 0.3
shot 01-opened

width=${size%x*}; height=${size#*x}
# The picture lies in the upper half of the right half, the histogram below it, the graph in the upper left.
picture_x=$((width * 3 / 4)); picture_y=$((height / 4))

drag $picture_x $picture_y $((picture_x + 80)) $((picture_y + 30))
sleep 1
shot 02-orbited
save
cmp -s "$work/scene.toml" "$work/before.toml" && fail "an orbit changes nothing in the file"
grep -q "# coarse" "$work/scene.toml" || fail "a comment is lost"

key ctrl+z
save
diff "$work/scene.toml" "$work/before.toml" >/dev/null || fail "undo does not give the file back"

xdotool mousemove $((width / 4)) $((height / 2 - 40)); sleep 0.3
key space
sleep 0.4
xdotool type --delay 40 histogram
sleep 0.4
shot 03-menu
key Return
sleep 0.6
shot 04-added
save
grep -q 'type = "histogram"' "$work/scene.toml" || fail "no node is added by the menu"
key ctrl+z

# The widget: from the middle of the histogram, wherever it lies there.
drag $((width * 3 / 4)) $((height * 4 / 5)) $((width * 3 / 4 + 60)) $((height * 4 / 5 - 20))
sleep 1
shot 05-widget
key F1
sleep 0.5
shot 06-help
key F1
key t
sleep 0.7
shot 07-light
key t
drag $picture_x $picture_y $((picture_x - 50)) $((picture_y + 20))
sleep 2
save
shot 08-saved

(cd "$work" && "$program" run scene.toml --quiet --set file.path=headless.exr) || fail "the saved file does not run"
test -s "$work/headless.exr" || fail "no picture is written"

ticks() { awk '{print $14 + $15}' "/proc/$editor/stat"; }
before=$(ticks); sleep 3; after=$(ticks)
echo "idle: $((after - before)) of $((3 * $(getconf CLK_TCK))) ticks of processor time in 3 s"
[ $((after - before)) -le 6 ] || fail "an idle window takes processor time"

key x
key ctrl+q
sleep 0.7
shot 09-unsaved
kill -0 "$editor" 2>/dev/null || fail "the window closed without asking about unsaved work"
echo "the round is done; pictures of the window are in $shots"
