#!/usr/bin/env bash
# Runs in real time that something spoils say what, and do not mix. It does not matter how late this machine is.
# usage: run_words_test.sh BIN_DIR SOURCE_DIR
set -u
armada=$1/armada
source=$2
scenario=$source/hil/scenarios/campaign.toml
work=$(mktemp -d)
run=''
clean_up() {
  [ -z "$run" ] || kill -CONT "$run" 2>/dev/null
  [ -z "$run" ] || kill "$run" 2>/dev/null
  wait
  rm -rf "$work"
}
trap clean_up EXIT
. "$source/tests/host/expect.sh"

# start NAME SECONDS: a run in the background, in its time.
start() {
  rm -f "$work/$1/lcm.log"  # of a run before
  "$armada" run "$scenario" --time real --seconds "$2" --out "$work/$1" >"$work/$1.txt" 2>&1 &
  run=$!
  wait_for 20 up "$1" || fail "$1 did not begin: $(cat "$work/$1.txt")"
}
up() { [ -s "$work/$1/lcm.log" ]; }  # boards have ticked
wait_for() { # wait_for SECONDS COMMAND...
  local deadline=$((SECONDS + $1))
  shift
  until "$@"; do
    [ $SECONDS -lt $deadline ] || return 1
    read -rt 0.02 <> <(:) || true
  done
}
# ended CODES NAME: its exit code is one of them.
ended() {
  wait "$run"
  local code=$?
  [[ " $1 " == *" $code "* ]] || fail "$2 exits with $code, not $1: $(cat "$work/$2.txt")"
}
says() { # says NAME PATTERN
  grep -qE -- "$2" "$work/$1.txt" || fail "$1 does not say '$2': $(cat "$work/$1.txt")"
}
left_behind() {
  pgrep -f "$work/$1( |/|$)" || find "$work/$1" -type p -o -name run.lock | grep .
}
nothing_left() { ! left_behind "$1" >/dev/null; }

# A second run in the same folder is refused and touches nothing; one in another folder has a network of its own.
start stalled 7
expect 2 "stalled is in use by another run .process $run.: wait for its end, or give this one another folder" \
  "$armada" run "$scenario" --out "$work/stalled"
expect 2 'stalled is in use by another run' "$armada" report "$work/stalled"
"$armada" run "$scenario" --time real --seconds 0.5 --set window_start_s=0.1 --out "$work/second" >"$work/second.txt" 2>&1
[ $? -le 1 ] || fail "a second run: $(cat "$work/second.txt")"
says second "udpm://239.255.76.67:7667 is in use by another run .process $run.: running in a private network namespace"
[ -s "$work/second/metrics.json" ] || says second 'the run broke off'

# Everything stands still for 0.3 s: the machine, as far as the run can see.
mapfile -t programs < <(pgrep -P "$run")
kill -STOP "$run" "${programs[@]}"
sleep 0.3
kill -CONT "${programs[@]}" "$run"
ended 1 stalled
says stalled '^why it is not ok:'
says stalled 'the machine stood still .or every program of the run was stopped. for 0\.[3-9][0-9]* s at [0-9.]+ s'
says stalled 'arm 1 went to (FAULT|HOLD|SAFE_STOP) at [0-9.]+ s .*ticks missed at'
/usr/bin/python3 - "$work/stalled/metrics.json" <<'PY' || fail "the stall is not in metrics.json: $(cat "$work/stalled.txt")"
import json, sys
metrics = json.load(open(sys.argv[1]))
kinds = [finding["kind"] for finding in metrics["diagnosis"]]
assert not metrics["ok"] and "stall" in kinds and "stopped" in kinds, metrics["diagnosis"]
PY
nothing_left stalled || fail "a run leaves behind: $(left_behind stalled)"

# A run that is killed leaves nothing; the next one in its folder works at once, and tells whose end ended it.
start killed 20
[ -p "$work/killed/faults.run" ] || fail "no pipe"
kill -KILL "$run"
wait "$run" 2>/dev/null
mv "$work/killed.txt" "$work/killed_first.txt"
start killed 20
pkill -KILL -f "armada-arm $work/killed/.* --arm 2 "
ended 1 killed
says killed '^armada run: arm 2 .pid [0-9]+. was ended by signal 9 .SIGKILL.'
says killed '^  the run broke off at [0-9.]+ s( before the start)?: arm 2'
[ ! -e "$work/killed/metrics.json" ] || fail "a run that broke off has a result"
wait_for 5 nothing_left killed || fail "a killed run leaves behind: $(left_behind killed)"

# A disk that gets full. The file system is seen by this part only.
run_on_small_disk() { # run_on_small_disk SIZE
  mkdir -p "$work/disk"
  unshare --mount sh -c 'mount -t tmpfs -o size="$1" none "$2" && shift 2 && exec "$@"' sh "$1" "$work/disk" \
    bash -c '"$@"; code=$?; cp -r "$0" "$0.kept"; exit $code' "$work/disk" \
    "$armada" run "$scenario" --time real --seconds 4 --out "$work/disk/run"
}
if [ "$(id -u)" = 0 ] && unshare --mount true 2>/dev/null; then
  for size in 16k 400k; do
    rm -rf "$work/disk.kept"
    expect 1 'No space left on device' run_on_small_disk $size
    grep -qE 'disk/run/[a-z_0-9]+\.[a-z]+' "$work/out" || fail "a full disk, but no file: $(cat "$work/out")"
    [ ! -e "$work/disk.kept/run/metrics.json" ] || fail "a run on a full disk has a result"
  done
else
  echo "note: no full disk: it takes root and a mount namespace"
fi

[ $failures = 0 ] && echo "runs say what spoils them, and do not mix"
exit $((failures > 0))
