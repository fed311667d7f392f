#!/usr/bin/env bash
# armada ctl as an operator types it, with real boards on the user-space bus: two arms, a leader, sealed messages.
# usage: ctl_test.sh BIN_DIR SOURCE_DIR
set -u
bin=$1
source=$2
armada=$bin/armada
work=$(mktemp -d)
pids=()
stop() {
  ((${#pids[@]} == 0)) || kill -KILL "${pids[@]}" 2>/dev/null
  rm -rf "$work"
}
trap stop EXIT
. "$source/tests/host/expect.sh"

# A fleet of two arms, one behind the other, that starts at rest near the leader.
"$armada" key new "$work/fleet.key" >/dev/null
python3 - "$source" "$work" <<'END'
import pathlib, re, sys
source, work = map(pathlib.Path, sys.argv[1:])
fleet = (source / "firmware/fleets/paper.toml").read_text()
head, *arms = re.split(r"(?m)^(?=\[\[arm\]\])", fleet.split("[[graph]]")[0])
head = re.sub(r"(?m)^\[link\]$", '[link]\nkey_file = "fleet.key"', head)
# Patient, for a machine that may stall: no drive or sample is given up within 0.4 s.
head = re.sub(r"(?m)^\[timing\]$", "[timing]\nfeedback_stale_s = 0.4", head)
arms = [re.sub(r"(?m)^(id = .*)$", r"\1\nwatchdog_s = 0.5", arm) for arm in arms]
(work / "fleet.toml").write_text(head + "".join(arms[:2]) +
                                 "[[graph]]\npins = [1]\nedges = [{ from = 1, to = 2 }]\n")
benign = (source / "hil/scenarios/benign.toml").read_text()
benign = re.sub(r'(?m)^fleet = .*$', 'fleet = "fleet.toml"', benign)
benign = re.sub(r"(?m)^\[drive\]$", "[drive]\nwatchdog_s = 0.5", benign)
(work / "scenario.toml").write_text(re.sub(r"(?m)^seconds = .*$", "seconds = 200.0", benign))
END
export ARMADA_FLEET=$work/fleet.toml

start() { # NAME COMMAND...: in the background
  local name=$1
  shift
  "$@" >"$work/$name.txt" 2>&1 &
  pids+=($!)
}
start_board() {
  start "arm_$1" "$bin/armada-arm" "$work/fleet.toml" --arm "$1" --state "$work/state" --priority 0
}
# until COMMAND succeeds, for 20 s at most
until_ok() {
  for _ in $(seq 100); do
    "$@" >"$work/out" 2>&1 && return
    sleep 0.2
  done
  fail "never succeeded: $*: $(cat "$work/out")"
}

expect 1 'arm 1: not heard' "$armada" ctl arm --timeout 0.3
start hil "$bin/armada-hil" "$work/scenario.toml" --priority 0
start leader "$bin/armada-leader" "$work/scenario.toml" --state "$work/state" --priority 0
start_board 1
start_board 2

# Arms come up in MONITOR, and refuse what is not their turn.
until_ok "$armada" ctl reset
expect 1 'arm 1: refused: not possible in this state \((INIT|MONITOR)\)' "$armada" ctl start
until_ok "$armada" ctl arm
expect 0 'arm 2: HOLD' "$armada" ctl arm
until_ok "$armada" ctl start
grep -q 'arm 1: RUN' "$work/out" && grep -q 'arm 2: RUN' "$work/out" || fail "not running: $(cat "$work/out")"
expect 0 'arm 2: HOLD' "$armada" ctl hold --arm 2

# Bad input: one clear message.
expect 2 'no such arm' "$armada" ctl hold --arm 9
expect 78 'nonexistent' "$armada" ctl hold --fleet /nonexistent.toml
expect 2 'A subcommand is required' "$armada" ctl

# A stranger with another key, or without one, is not believed; nor is another fleet file.
"$armada" key new "$work/other.key" >/dev/null
sed 's/fleet.key/other.key/' "$work/fleet.toml" >"$work/stranger.toml"
expect 1 'arm 2: not heard' "$armada" ctl estop --fleet "$work/stranger.toml" --timeout 0.5
sed 's/beta_1_m_s = 4.0/beta_1_m_s = 4.5/' "$work/fleet.toml" >"$work/changed.toml"
cmp -s "$work/fleet.toml" "$work/changed.toml" && fail "the fleet file was not changed"
expect 1 'the fleet file is another one on this board' "$armada" ctl start --fleet "$work/changed.toml" --arm 2

# A board that is killed and started anew while its arm moves comes up in MONITOR and stays there.
kill -KILL "${pids[2]}"
start_board 1
until_ok "$armada" ctl reset --arm 1
sleep 2
expect 1 'arm 1: refused: not possible in this state.*\((INIT|MONITOR)' "$armada" ctl start --arm 1

# An e-stop needs no state; then only a reset helps.
expect 0 'arm 2: (SAFE_STOP|FAULT)' "$armada" ctl estop
sleep 2
expect 1 'arm 2: refused: .*FAULT, operator: e-stop' "$armada" ctl start --arm 2
expect 0 'arm 2: (INIT|MONITOR)' "$armada" ctl reset --arm 2

((failures == 0)) && echo "armada ctl: all as expected"
exit "$failures"
