#!/usr/bin/env bash
# desktop.sh PROGRAM PICTURES: the desktop program as a user meets it, a window that draws, and a report where there is
# no display.
set -euo pipefail
program=$(realpath "$1")
out=$2
work=$(mktemp -d)
mkdir -p "$out"
children=()
trap 'kill "${children[@]}" 2>/dev/null || true; rm -rf "$work"' EXIT

echo 'without a display: one line, a table and a report'
(cd "$work" && env -u DISPLAY -u WAYLAND_DISPLAY HOME="$work" "$program" >"$work/headless.txt" 2>"$work/headless.err")
grep -q 'kalmanscope-report.svg' "$work/headless.txt"
grep -q 'EKF' "$work/headless.txt"
if grep -qiE 'panicked|backtrace' "$work/headless.txt" "$work/headless.err"; then
  cat "$work/headless.txt" "$work/headless.err"
  exit 1
fi
# A reader that leaves early is no reason to panic.
(cd "$work" && env -u DISPLAY -u WAYLAND_DISPLAY HOME="$work" "$program" 2>"$work/pipe.err" | true)
if grep -q panicked "$work/pipe.err"; then
  cat "$work/pipe.err"
  exit 1
fi
[[ $(grep -c '<svg' "$work/kalmanscope-report.svg") -ge 1 ]]

echo 'with a display: a window that is not blank'
export DISPLAY=:$((90 + RANDOM % 900))
Xvfb "$DISPLAY" -screen 0 1280x800x24 >"$work/xvfb.txt" 2>&1 &
children+=($!)
for _ in $(seq 50); do xdotool getdisplaygeometry >/dev/null 2>&1 && break; sleep 0.1; done
HOME=$work "$program" >"$work/window.txt" 2>&1 &
window=$!
children+=("$window")
colors=0
for _ in $(seq 60); do
  sleep 0.5
  kill -0 "$window" || { cat "$work/window.txt"; exit 1; }
  import -window root "$out/window.png"
  colors=$(identify -format %k "$out/window.png")
  ((colors > 300)) && break
done
echo "the window has $colors colours"
((colors > 300))
