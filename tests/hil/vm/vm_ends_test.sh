#!/usr/bin/env bash
# What a run on the kernel's CAN makes goes with it, however it ends; what was there stays.
# usage: vm_ends_test.sh BIN_DIR SOURCE_DIR
set -u
source "$(dirname "${BASH_SOURCE[0]}")/checks.sh"

cat >"$work/inside" <<'END'
exec 7<> <(:)  # says nothing, ever: reading it with a timeout waits without another process
pause() { read -rt 0.01 -u 7 || :; }
gone() { # within 5 s
  cd /sys/class/net
  for ((i = 0; i < 500; i++)); do
    names=(*)
    [ "${names[*]}" = 'can2 lo' ] && return
    pause
  done
  echo "left behind: ${names[*]}"
  exit 1
}
ip link add dev can2 type vcan && ip link set dev can2 mtu 72 up
for end in INT TERM KILL; do
  rm -rf "$1/ended"
  "$2/armada" run "$3/hil/scenarios/two_arms.toml" --seconds 60 --bus socketcan --out "$1/ended" >"$1/said" 2>&1 &
  run=$!
  until [ -d /sys/class/net/can0 ] && grep -qs 'on, seed' "$1/ended/hil.txt"; do pause; done
  kill -$end $run
  wait $run
  echo "$end: $?"
  gone
done
rm -rf "$1/ended"
"$2/armada" run "$3/hil/scenarios/two_arms.toml" --seconds 0.2 --set window_start_s=0.1 --bus socketcan --out "$1/ended" \
  >"$1/said" 2>&1
gone
grep 'used as they are: can2$' "$1/said"
rm -rf "$1/ended"
"$2/armada" run "$3/hil/scenarios/two_arms.toml" --seconds 60 --bus socketcan --namespaces --out "$1/ended" >"$1/said" 2>&1 &
run=$!
until grep -qs 'on, seed' "$1/ended/hil.txt"; do pause; done
kill -KILL $run
gone
[ -z "$(ls /run/netns)" ] || exit 1
END
"$vm" -o "$work/shared" -- bash "$work/inside" "$work/shared" "$bin" "$source" >"$work/out" 2>&1 ||
  fail "ends of runs: $(cat "$work/out" "$work/shared/said")"
for line in 'INT: 130' 'TERM: 130' 'KILL: 137' 'used as they are: can2'; do
  grep -q "$line" "$work/out" || fail "ends of runs: no '$line' in: $(cat "$work/out")"
done

finish
