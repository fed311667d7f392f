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
# start_stepped NAME SECONDS: the same in stepped time, where the machine spoils nothing.
start_stepped() {
  "$armada" run "$scenario" --time stepped --seconds "$2" --out "$work/$1" >"$work/$1.txt" 2>&1 &
  run=$!
  wait_for 60 grep -qs 'arms on' "$work/$1/hil.txt" || fail "$1 did not begin: $(cat "$work/$1.txt")"
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
programs_ended() { ! pgrep -f "$work/$1/(fleet|scenario).toml" >/dev/null; }
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

# A board that cannot leave what it learnt has not done its run.
start_stepped unlearnt 4
rm -rf "$work/unlearnt/learned" && : >"$work/unlearnt/learned"
ended 1 unlearnt
says unlearnt '^armada run: arm [0-9] .*exited with code 1'
says unlearnt 'unlearnt/learned/arm_[0-9].toml'
[ ! -e "$work/unlearnt/metrics.json" ] || fail "a run without all of its results has a result"

# Who moves a run's folder ends it; what then has its name stays as it is.
start_stepped moved 20
mv "$work/moved" "$work/elsewhere" && mkdir "$work/moved" && echo kept >"$work/moved/kept"
ended 1 moved
says moved 'moved was moved or removed while it was written: everything is stopped'
[ "$(ls "$work/moved")" = kept ] || fail "a run writes into another's folder: $(ls "$work/moved")"

# A run whose programs were stopped by somebody else, alone, and at its end: they have ended, that is all.
start late 4
kill -STOP "$run"
wait_for 30 programs_ended late || fail "the programs do not end"
sleep 6
kill -CONT "$run"
ended '0 1' late
[ -s "$work/late/metrics.json" ] || fail "a run that saw its programs' end late: $(cat "$work/late.txt")"

# Programs that have an end and do not reach it say so.
stops_early() { # stops_early PROGRAM WORD ARGUMENT...: stopped when it has said WORD
  local program=$1 word=$2
  shift 2
  : >"$work/early.txt"
  "$(dirname "$armada")/$program" "$@" >"$work/early.txt" 2>&1 &
  local early=$!
  wait_for 20 grep -q -- "$word" "$work/early.txt" || fail "$program does not begin: $(cat "$work/early.txt")"
  kill "$early"
  wait "$early"
  [ $? = 130 ] || fail "$program, stopped before its end: $(cat "$work/early.txt")"
}
stops_early armada-hil 'arms on' "$scenario" --seconds 60
stops_early armada-leader epoch "$scenario" --seconds 60 --state "$work/state"

# Where there are no namespaces, an unpaced run says what it hears.
if unshare -r true 2>/dev/null; then
  expect '0 1' 'note: .*: what others send on udpm://[0-9.:]+.* is heard by this run' \
    unshare -r sh -c 'echo 0 >/proc/sys/user/max_user_namespaces; echo 0 >/proc/sys/user/max_net_namespaces; exec "$@"' sh \
    "$armada" run "$scenario" --time stepped --pace 0 --seconds 0.5 --set window_start_s=0.1 --out "$work/unpaced"
else
  echo "note: no user namespaces: nothing to forbid"
fi

# A table that nobody can read is no result.
if [ -c /dev/full ]; then
  "$armada" run "$scenario" --time stepped --pace 0 --seconds 0.5 --set window_start_s=0.1 --out "$work/unread" \
    >/dev/full 2>"$work/unread.txt"
  [ $? = 1 ] || fail "a run that cannot print its result succeeds"
  says unread 'cannot write to standard output'
fi

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
