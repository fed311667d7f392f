#!/usr/bin/env bash
# A virtual machine as users and tests start it: hil/vm/run and `armada run --bus vm`; what they promise, and that
# nothing is left behind. usage: vm_test.sh BIN_DIR SOURCE_DIR
set -u
bin=$1
source=$2
vm=$source/hil/vm/run
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export TMPDIR=$work
failures=0

fail() {
  echo "FAILED: $*"
  failures=$((failures + 1))
}

# Without a kernel: one message that says what to do.
ARMADA_VM_CACHE=$work/none "$vm" -- true >"$work/out" 2>&1
[ $? = 125 ] || fail "without a kernel: not exit code 125"
grep -q 'hil/vm/image' "$work/out" || fail "without a kernel: $(cat "$work/out")"

# The command's words, status and output come through; a folder is written to; CAN is there, with echo when asked, and
# candump sees what is sent.
cat >"$work/inside" <<'END'
echo "words: $# $2"
cat /sys/module/vcan/parameters/echo
ip link add dev vcan5 type vcan && ip link set dev vcan5 mtu 72 up
candump -L -n 2 vcan5 >"$1/frames" &
until grep -q '^ *vcan5 ' /proc/net/can/rcvlist_all; do :; done
cansend vcan5 123#DEADBEEF
cansend vcan5 12345678##1AA
wait
touch "$1/written" || exit 1
! touch /written 2>/dev/null || exit 1
exit 42
END
mkdir "$work/shared"
"$vm" -o "$work/shared" -m 'vcan echo=1' -- bash "$work/inside" "$work/shared" 'two words' >"$work/out" 2>"$work/errors"
[ $? = 42 ] || fail "exit code: $(cat "$work/out" "$work/errors")"
[ "$(cat "$work/out")" = "$(printf 'words: 2 two words\nY')" ] || fail "output: $(cat "$work/out")"
[ -e "$work/shared/written" ] || fail "a file written in the guest is not here"
[ "$(cut -d ' ' -f 2- "$work/shared/frames")" = "$(printf 'vcan5 123#DEADBEEF\nvcan5 12345678##5AA')" ] ||  # 1: bit rate switched; 4: the kernel says that it is CAN FD
  fail "candump: $(cat "$work/shared/frames")"

# A whole run; then one with each board in a namespace, with drives on CAN FD.
whole_run() {
  "$bin/armada" run "$source/hil/scenarios/benign.toml" --seconds 3 --set window_start_s=2.0 --bus vm "$@" \
    --out "$work/run" --json "$work/copy.json" >"$work/out" 2>&1 || fail "run --bus vm $*: $(cat "$work/out")"
  cmp "$work/run/metrics.json" "$work/copy.json" || fail "--json of a run in the virtual machine"
  /usr/bin/python3 - "$work/run/metrics.json" <<'PY' || fail "metrics of run --bus vm $*"
import json, sys
metrics = json.load(open(sys.argv[1]))
assert metrics["ok"] and len(metrics["arms"]) == 7
for arm in metrics["arms"]:
    assert arm["timing"]["missed_ticks"] == 0, arm
    assert arm["bus"]["can_dropped"] == arm["bus"]["can_errors"] == arm["bus"]["lcm_rejected"] == 0, arm
PY
  grep -q 'bus = "socketcan:vcan7"' "$work/run/fleet.toml" || fail "the fleet of the run: $(grep bus "$work/run/fleet.toml")"
}
whole_run
whole_run --namespaces --set 'arm.*.drive="moteus"'
grep -q 'ttl=1' "$work/run/fleet.toml" || fail "boards in namespaces hear each other with ttl=1"

# The wall clock steps by an hour, ahead and back, while arms move: only the monotonic clock counts.
# shellcheck disable=SC2016  # expanded in the guest
steps='
step() { read -rt "$1" <> <(:) || :; busybox date -s "@$(($(busybox date +%s) + $2))" >/dev/null; }
(step 3.7 3600; step 0.6 -3600; busybox date >out/stepped) &
armada run hil/scenarios/benign.toml --seconds 4 --set window_start_s=1.5 --bus socketcan --out out/run
status=$?
wait
exit $status'
(cd "$source" && hil/vm/run_virtual -o "$work/stepped" -f firmware -f hil -p "$bin/armada" -p "$bin/armada-arm" \
  -p "$bin/armada-hil" -p "$bin/armada-leader" -p lcm-logger -- bash -c "$steps") >"$work/out" 2>&1 ||
  fail "a clock that steps: $(cat "$work/out")"
[ -s "$work/stepped/stepped" ] || fail "the clock did not step: $(cat "$work/out")"
/usr/bin/python3 - "$work/stepped/run/metrics.json" <<'PY' || fail "metrics of a run whose wall clock stepped"
import json, sys
metrics = json.load(open(sys.argv[1]))
assert metrics["ok"]
for arm in metrics["arms"]:
    assert arm["state"] == "RUN" and arm["timing"]["missed_ticks"] == 0 and arm["bus"]["lcm_rejected"] == 0, arm
PY

# What a run makes goes with it, however it ends; what was there stays.
cat >"$work/inside" <<'END'
names() { ip -o link | cut -d : -f 2 | xargs; }
gone() { # within 5 s
  for _ in $(seq 500); do
    [ "$(names)" = 'lo vcan3' ] && return
    read -rt 0.01 <> <(:) || :
  done
  echo "left behind: $(names)"
  exit 1
}
ip link add dev vcan3 type vcan && ip link set dev vcan3 mtu 72 up
for end in INT TERM KILL; do
  rm -rf "$1/ended"
  "$2/armada" run "$3/hil/scenarios/benign.toml" --seconds 60 --bus socketcan --out "$1/ended" >"$1/said" 2>&1 &
  run=$!
  until [ -d /sys/class/net/vcan7 ] && grep -qs 'on, seed' "$1/ended/hil.txt"; do read -rt 0.01 <> <(:) || :; done
  kill -$end $run
  wait $run
  echo "$end: $?"
  gone
done
rm -rf "$1/ended"
"$2/armada" run "$3/hil/scenarios/benign.toml" --seconds 0.2 --set window_start_s=0.1 --bus socketcan --out "$1/ended" \
  >"$1/said" 2>&1
gone
grep 'used as they are: vcan3$' "$1/said"
rm -rf "$1/ended"
"$2/armada" run "$3/hil/scenarios/benign.toml" --seconds 60 --bus socketcan --namespaces --out "$1/ended" >"$1/said" 2>&1 &
run=$!
until grep -qs 'on, seed' "$1/ended/hil.txt"; do read -rt 0.01 <> <(:) || :; done
kill -KILL $run
gone
[ -z "$(ls /run/netns)" ] || exit 1
END
"$vm" -o "$work/shared" -- bash "$work/inside" "$work/shared" "$bin" "$source" >"$work/out" 2>&1 ||
  fail "ends of runs: $(cat "$work/out" "$work/shared/said")"
for line in 'INT: 130' 'TERM: 130' 'KILL: 137' 'used as they are: vcan3'; do
  grep -q "$line" "$work/out" || fail "ends of runs: no '$line' in: $(cat "$work/out")"
done

# Killed or interrupted, the virtual machine ends.
guests() { pgrep -f "qemu-system-x86_64 .*$work/" >/dev/null; }
wait_for() { # wait_for SECONDS COMMAND...
  local deadline=$((SECONDS + $1))
  shift
  until "$@"; do
    [ $SECONDS -lt $deadline ] || return 1
    read -rt 0.05 <> <(:) || true
  done
}
no_guest() { ! guests; }
for signal in TERM KILL; do
  "$vm" -- tail -f /dev/null >"$work/out" 2>&1 &
  run=$!
  wait_for 20 guests || fail "the guest did not start: $(cat "$work/out")"
  kill -$signal $run
  wait $run 2>/dev/null
  wait_for 10 no_guest || fail "SIG$signal left the virtual machine behind"
done

[ $failures = 0 ] && echo "virtual machine: all as promised"
exit $((failures > 0))
