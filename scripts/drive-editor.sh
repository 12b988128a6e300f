#!/usr/bin/env bash
# Drives the real editor by mouse and keys under a virtual display.
#
# A round over a pipeline: open, orbit, undo, add a node, wire it from port to port, drag a widget, save, run in the window, run
# headless, compare the two pictures bit for bit; idle, light and dark, unsaved work. With the path of a data file as the second
# argument: from an empty window to a saved picture of two materials by the mouse alone. Pictures of the window are kept in the
# folder that the first argument names, else target/editor. With VOLTET_WRITE_DOCS=1 those that the pages show are written there.
#
# Needs Xvfb, xdotool, import, convert and compare (ImageMagick), and a built program: cargo build --features editor.
set -euo pipefail
cd "$(dirname "$0")/.."
program=$(realpath "${VOLTET:-target/debug/voltet}")
shots=$(mkdir -p "${1:-target/editor}" && cd "${1:-target/editor}" && pwd)
data=${2:+$(realpath "$2")}
for tool in Xvfb xdotool import compare; do
    command -v "$tool" >/dev/null || { echo "SKIPPED: $tool is not installed"; exit 0; }
done

work=$(mktemp -d)
export XDG_STATE_HOME=$work/state XDG_CACHE_HOME=$work/cache
xvfb=
editor=
finish() {
    [ -z "$editor" ] || kill "$editor" 2>/dev/null || true
    [ -z "$xvfb" ] || kill "$xvfb" 2>/dev/null || true
    rm -rf "$work"
}
trap finish EXIT

fail() {
    echo "FAILED: $*"
    shot failed
    cat "$work/editor.log" 2>/dev/null
    exit 1
}
shot() { import -window root "$shots/$1.png"; }
key() { xdotool key --clearmodifiers "$@"; sleep 0.4; }
# Waits for up to 20 s until a command succeeds.
until_true() {
    local i
    for i in $(seq 1 100); do
        "$@" && return 0
        sleep 0.2
    done
    return 1
}
display() { # its size
    [ -z "$xvfb" ] || kill "$xvfb"
    export DISPLAY=:$((90 + RANDOM % 800))
    # Without -noreset it begins anew when the last client leaves, and refuses the next one meanwhile.
    Xvfb "$DISPLAY" -noreset -screen 0 "$1x24" >"$work/xvfb.log" 2>&1 &
    xvfb=$!
    until_true xdotool getdisplaygeometry >/dev/null 2>&1 || fail "no virtual display comes"
}
at() { xdotool mousemove "$1" "$2"; sleep 0.15; }
click() { at "$1" "$2"; xdotool click "${3:-1}"; sleep 0.6; }
drag() { # from x y to x y, button
    at "$1" "$2"
    xdotool mousedown "${5:-1}"
    local i
    for i in 1 2 3 4 5 6 7 8; do
        xdotool mousemove $(($1 + ($3 - $1) * i / 8)) $(($2 + ($4 - $2) * i / 8))
        sleep 0.04
    done
    sleep 0.1
    xdotool mouseup "${5:-1}"
    sleep 0.6
}
save() { key ctrl+s; sleep 0.3; }
begin() { # a folder, the arguments of voltet edit
    local folder=$1
    shift
    (cd "$folder" && exec "$program" edit "$@" >"$work/editor.log" 2>&1) &
    editor=$!
    until_true xdotool search --onlyvisible --name voltet >/dev/null 2>&1 || fail "no window comes"
    sleep "${PATIENCE:-3}"
    # Without a window manager nobody gives the window the keys.
    xdotool search --onlyvisible --name voltet windowfocus
    sleep 0.3
}
end() {
    key ctrl+q
    until_true has_ended || fail "the window does not close"
    editor=
}
has_ended() { ! kill -0 "$editor" 2>/dev/null; }
ticks() { awk '{print $14 + $15}' "/proc/$editor/stat"; }
is_busy() { local before; before=$(ticks); sleep 0.5; [ $(($(ticks) - before)) -gt 2 ]; }
rests() { ! is_busy; }

said=$(env -u DISPLAY -u WAYLAND_DISPLAY "$program" edit 2>&1) && fail "a window opens without a display"
case $said in
    "error: there is no display"*) ;;
    *) fail "without a display it says: $said" ;;
esac

# Places below are of this size.
display 1280x720

# A picture of 32-bit floats: nothing is lost before it is compared.
sed 's/picture\.png/picture.exr/' crates/editor/ui_tests/scene.toml >"$work/scene.toml"
cp "$work/scene.toml" "$work/before.toml"
begin "$work" scene.toml
shot 01-opened

drag 960 200 1040 230
shot 02-orbited
save
cmp -s "$work/scene.toml" "$work/before.toml" && fail "an orbit changes nothing in the file"
grep -q "# coarse" "$work/scene.toml" || fail "a comment is lost"
key ctrl+z
save
cmp -s "$work/scene.toml" "$work/before.toml" || fail "undo does not give the file back"

# Below the others; its first port lies 22 points below its corner.
at 400 316
key space
xdotool type --delay 40 histogram
sleep 0.4
shot 03-menu
key Return
sleep 0.4
drag 304 127 400 338
shot 04-wired
save
grep -A3 'type = "histogram"' "$work/scene.toml" | grep -q 'volume = "gradient"' || fail "no wire is drawn"
key Delete
# The node may be hidden behind the panel below: F shows all.
key f
click 240 200

# The widget by its centre on the histogram, then the camera.
before=$(grep '^centre' "$work/scene.toml")
drag 972 534 1020 516
shot 05-widget
drag 960 200 910 220
save
[ "$(grep '^centre' "$work/scene.toml")" != "$before" ] || fail "no widget is moved"
grep -q 'type = "histogram"' "$work/scene.toml" && fail "the node is not deleted"

key ctrl+r
until_true test -s "$work/picture.exr" || fail "the window's run writes no picture"
sleep 0.5
shot 06-run
mv "$work/picture.exr" "$work/window.exr"
(cd "$work" && "$program" run scene.toml --quiet) || fail "the saved file does not run"
cmp "$work/window.exr" "$work/picture.exr" || fail "the picture of the window is not that of a run"
cmp -s "$work/picture.exr" "$work/scene.toml" && fail "nothing was compared"

key F1
shot 07-keys
key F1
key t
sleep 0.5
shot 08-light
key t
key c
sleep 0.5
shot 09-costs
key c
until_true rests || fail "the window does not come to rest"
before=$(ticks)
sleep 3
spent=$(($(ticks) - before))
echo "idle: $spent of $((3 * $(getconf CLK_TCK))) ticks of processor time in 3 s"
[ "$spent" -le 3 ] || fail "an idle window takes processor time"

key x
key ctrl+q
shot 10-unsaved
has_ended && fail "the window closed without asking about unsaved work"
key Escape
key ctrl+z
end

if [ -n "$data" ]; then
    mkdir "$work/data"
    cp "$data" "$work/data/"
    begin "$work/data"
    shot 11-empty
    click 640 269 # "Open data or a pipeline …"
    shot 12-asking
    # The one file of the folder.
    click 480 225
    click 842 549 # "Open"
    until_true rests || true
    sleep 4
    until_true rests || true
    at 60 380
    shot 13-data
    click 226 11 # "Save"
    click 270 11 # "Run"
    stem=$(basename "${data%.*}")
    until_true test -s "$work/data/$stem.png" || fail "no picture of the data is written"
    test -s "$work/data/$stem.toml" || fail "the pipeline is not saved"
    sleep 0.5
    shot 14-written
    cp "$work/data/$stem.png" "$shots/15-picture.png"
    end
fi

if [ -n "${VOLTET_WRITE_DOCS:-}" ]; then
    [ -n "$data" ] || fail "the pages show a data file: name data/heat_sink.vtu as the second argument"
    begin . pipelines/quickstart.toml
    sleep 4
    until_true rests || true
    at 60 380
    sleep 1
    shot 17-quickstart
    end
    page() {
        convert "$shots/$1.png" ${3:+-resize "$3"} -colors 256 -strip -define png:compression-level=9 "png8:docs/src/images/$2.png"
    }
    page 17-quickstart editor
    page 13-data editor_data
    page 11-empty editor_empty 800x450
fi

# Screens of a high density: the same window of 1280 x 720 points.
display 2560x1440
WINIT_X11_SCALE_FACTOR=2 begin "$work" scene.toml
shot 16-dense
key ctrl+q
echo "the round is done; pictures of the window are in $shots"
