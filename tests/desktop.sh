#!/usr/bin/env bash
# desktop.sh PROGRAM PICTURES: the desktop program as a user meets it, a window that draws, a state that survives, one that is set aside
# after a start that has ended, and an error where there is no display.
set -euo pipefail
program=$(realpath "$1")
out=$2
work=$(mktemp -d)
mkdir -p "$out"
children=()
trap 'kill "${children[@]}" 2>/dev/null || true; { rm -rf "$work" || { sleep 1; rm -rf "$work"; }; } 2>/dev/null || true' EXIT

echo 'without a display: one line'
status=0
env -u DISPLAY -u WAYLAND_DISPLAY HOME="$work" "$program" >"$work/headless.txt" 2>&1 || status=$?
[[ $status -eq 1 && $(wc -l <"$work/headless.txt") -eq 1 ]]
grep -q 'no window can be opened.*kalmanscope-cli' "$work/headless.txt"

echo 'with a display: a window that is not blank'
# Starts a display.
display() {
  export DISPLAY=:$((90 + RANDOM % 900))
  Xvfb "$DISPLAY" -screen 0 1280x800x24 >"$work/xvfb.txt" 2>&1 &
  screen=$!
  children+=("$screen")
  for _ in $(seq 50); do xdotool getdisplaygeometry >/dev/null 2>&1 && break; sleep 0.1; done
}

# Starts the program and waits for a picture NAME with more than COLOURS colours.
start() {
  HOME=$work XDG_DATA_HOME=$work/data "$program" >"$work/window.txt" 2>&1 &
  window=$!
  children+=("$window")
  colors=0
  for _ in $(seq 60); do
    sleep 0.5
    kill -0 "$window" || { cat "$work/window.txt"; exit 1; }
    import -window root "$out/$1.png"
    colors=$(identify -format %k "$out/$1.png")
    ((colors > $2)) && break
  done
  echo "the window has $colors colours"
  ((colors > $2))
}

# Waits until a file has a text.
await() {
  for _ in $(seq 100); do
    grep -q "$2" "$1" 2>/dev/null && return
    sleep 0.1
  done
  echo "$1 has no $2"
  exit 1
}

# Presses a key in the window, which no window manager gives the focus.
press() {
  xdotool windowfocus "$(xdotool search --name Kalmanscope | tail -1)" mousemove 640 600
  sleep 0.3
  xdotool key "$1"
}

folder=$work/data/kalmanscope
state=$folder/state.json
display
start window 300

echo 'a change is saved at rest'
press space
press l
await "$state" '"mode": "Whole"'

echo 'a change is saved before the system ends the program'
for signal in TERM INT; do
  press p
  sleep 0.5
  kill -"$signal" "$window"
  wait "$window"
  [[ $signal == TERM ]] && presenting=true || presenting=false
  grep -q "\"presenting\": $presenting" "$state" || { echo "not saved before SIG$signal"; exit 1; }
  start "restored-$signal" 300
done

echo 'a torn session is said and kept'
kill -KILL "$window"
wait "$window" || true
truncate -s 100 "$state"
start torn 300
[[ $(stat -c %s "$folder/state-kept-1.json") == 100 ]]

echo 'a display that goes leaves the session whole'
press space
await "$state" '"mode"'
kill -KILL "$screen"
status=0
wait "$window" || status=$?
((status > 0))
[[ -s $state ]]

echo 'a session with which a start has ended is set aside'
display
mv "$state" "$folder/state-opened.json"
start ended 300
[[ -s $folder/state-kept-2.json && ! -e $folder/state-opened.json ]]
