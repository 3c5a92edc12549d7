#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# stop_by_signal.sh ROBOT_LOOP: starts the example on minutes of frames, sends SIGTERM once it has told a pose, and
# expects it to end well and to say why.
set -eu
log=$(mktemp)
trap 'rm -f "$log"' EXIT
"$1" 300 >"$log" &
robot=$!
until grep -q '^at ' "$log"; do
  kill -0 "$robot" 2>/dev/null || break
  sleep 0.1
done
kill -TERM "$robot" || true
verdict=0
wait "$robot" || verdict=$?
cat "$log"
[ "$verdict" -eq 0 ] && grep -q 'stopped by a signal, [1-9]' "$log"
