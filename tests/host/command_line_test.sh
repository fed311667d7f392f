#!/usr/bin/env bash
# The programs as a user starts them: exit codes, messages, a run of processes that leaves nothing behind.
# usage: command_line_test.sh BIN_DIR SOURCE_DIR
set -u
bin=$1
source=$2
armada=$bin/armada
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
. "$source/tests/host/expect.sh"

scenario=$source/hil/scenarios/paper.toml
fleet=$source/firmware/fleets/paper.toml

# Bad input: one clear message, exit 78 or 2, nothing started.
expect 78 'nonexistent.toml' "$armada" sim /nonexistent.toml
expect 78 'nonexistent.toml' "$armada" run /nonexistent.toml --out "$work/none"
[ ! -e "$work/none" ] || fail "a run of a missing scenario made its output directory"
printf 'name = "broken\n' >"$work/broken.toml"
expect 78 'broken.toml:1' "$armada" check "$work/broken.toml"
expect 78 'broken.toml:1' "$bin/armada-arm" "$work/broken.toml" --arm 1
sed 's/m_kg = 0.6/m_kg = -0.6/' "$fleet" >"$work/impossible.toml"
expect 78 'impossible.toml:[0-9]+: .*m_kg' "$armada" check "$work/impossible.toml"
expect 78 'set.*no_such_key|no_such_key' "$armada" sim "$scenario" --set no_such_key=1
expect 78 '[Ll]eader|reach' "$armada" sim "$scenario" --set 'graph=[{pins=[1],edges=[]}]'
expect 2 'no such arm' "$bin/armada-arm" "$fleet" --arm 99
expect 2 'seeds 9:1' "$armada" sweep "$scenario" --seeds 9:1
expect 2 'seeds 9:1' "$armada" floor "$scenario" --seeds 9:1
expect 2 'excludes' "$armada" floor "$scenario" --seed 1 --seeds 1:2
for command in floor 'sim --floor' 'sweep --floor'; do
  # shellcheck disable=SC2086  # two words
  expect 2 'leaderless.toml has no leader' "$armada" $command "$source/hil/scenarios/leaderless.toml"
done
expect 2 'shard 3/2' "$armada" sweep "$scenario" --shard 3/2
expect 2 'seeds 9:1' "$armada" ablate "$scenario" --seeds 9:1
expect 78 'nonexistent.toml' "$armada" ablate /nonexistent.toml
expect 1 'nonexistent.json: cannot be read' "$armada" report /nonexistent.json
expect 2 'there are udp' "$armada" run "$scenario" --bus nonsense
expect 2 'unknown|not expected|required' "$armada" fly
expect 2 'network.lost.*armada sim' "$armada" run "$source/hil/scenarios/tree_cut.toml" --out "$work/none"
expect 2 'SHAPE' "$armada" fleet star "$fleet"
expect 2 'arms' "$armada" fleet line "$fleet" --arms 65
expect 2 'pins 8: there are 7 arms' "$armada" fleet line "$fleet" --pins 8
expect 78 'nonexistent.toml' "$armada" fleet line /nonexistent.toml

# Keys: for the owner alone, never over another; what others may read is refused before anything is started.
expect 0 "key_file = \"$work/fleet.key\"" "$armada" key new "$work/fleet.key"
[ "$(stat -c '%a %s' "$work/fleet.key")" = '600 32' ] || fail "a key is 32 bytes, mode 0600"
expect 1 'exists' "$armada" key new "$work/fleet.key"
sed "s/^lcm_url.*/key_file = 'fleet.key'/" "$fleet" >"$work/keyed.toml"
expect 0 '^ok' "$armada" check "$work/keyed.toml"
chmod 640 "$work/fleet.key"
expect 78 'fleet.key: has mode 0640, allowed are 0600' "$bin/armada-arm" "$work/keyed.toml" --arm 1 --state "$work/state"
[ ! -e "$work/state" ] || fail "a refused key leaves nothing behind"

own_network=(unshare --net)
[ "$(id -u)" = 0 ] || own_network+=(--user --map-root-user)
expect 1 'multicast' "${own_network[@]}" "$bin/armada-arm" "$fleet" --arm 1

# A result that fails its criterion exits 1 and says so.
expect 1 '^NOT ok' "$armada" sim "$source/hil/scenarios/benign.toml" --seconds 3 --set window_start_s=2.0 --law paper \
  --estimator paper

# check, sim with a trace, report, sweep in shards.
expect 0 'A1|reach' "$armada" check "$scenario"
expect 0 '^ok: fleet RMS .* times the floor of' "$armada" sim "$scenario" --seconds 6 --set window_start_s=5.0 --floor \
  --trace "$work/trace" --json "$work/sim.json"
cmp -s "$work/sim.json" "$work/trace/metrics.json" || fail "--json and --trace write different metrics"
expect 0 'report.html' "$armada" report "$work/trace"
[ -s "$work/trace/report.html" ] || fail "no page"
grep -q 'times the unavoidable' "$work/trace/report.html" || fail "the page does not tell the floor"
short=(--seconds 6 --set window_start_s=5.0)
"$armada" sweep "$scenario" "${short[@]}" --seeds 1:4 --jobs 1 --json "$work/whole.json" >/dev/null || fail "sweep"
"$armada" sweep "$scenario" "${short[@]}" --seeds 1:4 --shard 1/2 --json "$work/s1.json" >/dev/null || fail "shard 1/2"
"$armada" sweep "$scenario" "${short[@]}" --seeds 1:4 --shard 2/2 --json "$work/s2.json" >/dev/null || fail "shard 2/2"
"$armada" sweep merge "$work/s1.json" "$work/s2.json" --json "$work/merged.json" >/dev/null || fail "merge"
cmp -s "$work/whole.json" "$work/merged.json" || fail "merged shards differ from the whole sweep"
expect 0 ' times their floor of ' "$armada" sweep "$scenario" "${short[@]}" --seeds 1:2 --floor

# The floor: the same bytes on any number of threads.
for jobs in 1 2; do
  expect 0 '^floor: fleet RMS .* seeds 1 to 3' "$armada" floor "$scenario" "${short[@]}" --seeds 1:3 --jobs $jobs \
    --json "$work/floor_$jobs.json"
done
cmp -s "$work/floor_1.json" "$work/floor_2.json" || fail "the floor depends on --jobs"

# The command that a sweep names replays its worst seed to the same figures; the report is of the file or its directory.
(cd "$work" && PATH=$bin:$PATH /usr/bin/python3 -) <<'PY' || fail "a worst seed is not what its command replays"
import json, subprocess
sweep = json.load(open("whole.json"))
worst = sweep["worst"]["settled_s"][0]
subprocess.run(worst["command"] + " --json replay.json", shell=True, check=True, stdout=subprocess.DEVNULL)
replay = json.load(open("replay.json"))
run = next(run for run in sweep["runs"] if run["seed"] == worst["seed"])
assert replay["fleet_rms_mm"] == run["fleet_rms_mm"], (replay["fleet_rms_mm"], run)
assert max(arm["settled_s"] for arm in replay["arms"]) == worst["value"] == sweep["fleet_settled_s"]["max"], worst
PY
expect 0 'whole.html' "$armada" report "$work/whole.json"
[ -s "$work/whole.html" ] || fail "no page of the sweep"
mkdir "$work/box" && cp "$work/whole.json" "$work/box/sweep.json"
expect 0 'box/sweep.html' "$armada" report "$work/box"
expect 0 'governor  +changes the reference' "$armada" ablate "$scenario" "${short[@]}" --seeds 1:2 --json "$work/ablation.json"
grep -q '"mode": "ablation"' "$work/ablation.json" || fail "no ablation table"

# What each number is.
expect 0 'arm\.\*\.control\.reference\.braking_share = 0.9' "$armada" check "$scenario" --explain braking_share
expect 0 'default 0\.9, allowed' "$armada" check "$scenario" --explain braking_share
expect 0 'arm\.6\.torque_limit_Nm = .*300' "$armada" check "$fleet" --explain torque_limit_Nm
expect 2 'no parameter' "$armada" check "$scenario" --explain no_such_key
expect 78 'no_such_key' "$armada" check "$scenario" --explain . --set no_such_key=1

# Generated fleets: those that are committed are what their first lines say made them.
for name in ring line tree random_50; do
  file=firmware/fleets/$name.toml
  read -ra command < <(sed -n 's/^#   armada //p' "$source/$file")
  (cd "$source" && "$armada" "${command[@]}") | cmp -s - "$source/$file" || fail "$file is not what its heading says"
done
"$armada" fleet random "$fleet" --arms 12 --pins 2 --vary 0.1 --seed 3 >"$work/fleet.toml" || fail "fleet"
expect 0 '^ok' "$armada" check "$work/fleet.toml"
# A large fleet's effective files read back.
"$armada" sim "$source/hil/scenarios/random_50.toml" --seconds 1 --set window_start_s=0.5 --trace "$work/large" >/dev/null
expect 0 '^50 arms' "$armada" check "$work/large/scenario.toml"

# Time, stepped or real.
expect 2 'there are real' "$armada" run "$scenario" --time none --out "$work/none"
expect 2 'pace is for --time stepped' "$armada" run "$scenario" --pace 0 --out "$work/none"
expect 2 'allowed are 0' "$armada" run "$scenario" --time stepped --pace 1000 --out "$work/none"
expect 2 "the kernel's CAN does not wait" "$armada" run "$scenario" --time stepped --bus socketcan --out "$work/none"
expect 2 'ttl=1' "$armada" run "$scenario" --time stepped --set 'link.lcm_url="udpm://239.255.76.67:7667?ttl=1"' \
  --set "link.key_file=\"$work/fleet.key\"" --out "$work/none"
[ ! -e "$work/none" ] || fail "a refused run made its output directory"

# A board beside something real refuses a clock that waits, and a key that is no secret.
chmod 600 "$work/fleet.key"
sed '0,/^bus = .*/s//bus = "socketcan:can0"/' "$work/keyed.toml" >"$work/real.toml"
expect 78 'bus socketcan:can0 is of the kernel; stepped time is for emulated arms' "$bin/armada-arm" "$work/real.toml" \
  --arm 1 --state "$work/state" --stepped-clock 0:1
expect 78 'ttl=1; stepped time is for emulated arms' "$bin/armada-arm" \
  <(sed "s|^key_file.*|&\nlcm_url = 'udpm://239.255.76.67:7667?ttl=1'|; s|'fleet.key'|'$work/fleet.key'|" "$work/keyed.toml") \
  --arm 1 --state "$work/state" --stepped-clock 0:1
expect 0 '^ok: fleet RMS' "$armada" run "$scenario" --seconds 6 --set window_start_s=5.0 --time stepped --pace 0 \
  --out "$work/stepped"
expect 78 'is of a run in stepped time, made of its seed, and no secret' "$bin/armada-arm" "$work/stepped/fleet.toml" --arm 1 \
  --state "$work/state"

# Processes in real time. This checks that they work together, not how late this machine is: under a sanitizer or load
# the fleet may miss its criterion (exit 1), never its results.
left_behind() { pgrep -f "$work/" >/dev/null; }
"$armada" run "$scenario" --seconds 4 --set window_start_s=3.0 --out "$work/run" >"$work/out" 2>&1
code=$?
[ $code = 0 ] || [ $code = 1 ] || fail "run: exit code $code: $(cat "$work/out")"
for file in metrics.json hil.json lcm.log can_1.log arm_7.csv timing.csv fleet.toml; do
  [ -s "$work/run/$file" ] || fail "run left no $file: $(cat "$work/out")"
done
/usr/bin/python3 - "$work/run/metrics.json" <<'PY' || fail "metrics of the run"
import json, sys
metrics = json.load(open(sys.argv[1]))
assert metrics["mode"] == "run" and len(metrics["arms"]) == 7
for arm in metrics["arms"]:
    assert arm["memory"]["heap_allocations"] in (0, None), arm
    assert arm["timing"]["ticks"] + arm["timing"]["missed_ticks"] >= 390, arm
    assert arm["bus"]["lcm_malformed"] == 0 and arm["bus"]["can_malformed"] == 0, arm
PY
left_behind && fail "a finished run left processes: $(pgrep -af "$work/")"

# Ctrl-C, and a crash of a process, stop everything.
wait_for() { # wait_for SECONDS COMMAND...
  local deadline=$((SECONDS + $1))
  shift
  until "$@"; do
    [ $SECONDS -lt $deadline ] || return 1
    read -rt 0.05 <> <(:) || true
  done
}
all_up() { [ "$(pgrep -cf "armada-arm $work/")" = 7 ]; }
none_left() { ! left_behind; }
"$armada" run "$scenario" --seconds 60 --out "$work/interrupted" >"$work/out" 2>&1 &
run=$!
wait_for 20 all_up || fail "the arms did not start: $(cat "$work/out")"
kill -INT $run
wait $run
[ $? = 130 ] || fail "an interrupted run must exit 130: $(cat "$work/out")"
wait_for 10 none_left || fail "Ctrl-C left processes behind: $(pgrep -af "$work/")"

# A program that a signal ends early is named, though it ended well.
"$armada" run "$scenario" --seconds 60 --time stepped --out "$work/ended" >"$work/out" 2>&1 &
run=$!
wait_for 20 grep -q '^starting' "$work/out" || fail "the programs did not start: $(cat "$work/out")"
pkill -TERM -f "armada-leader $work/ended/" || fail "there is no leader: $(cat "$work/out")"
wait $run
[ $? = 1 ] || fail "a run whose leader was ended must exit 1: $(cat "$work/out")"
grep -q 'leader (pid [0-9]*) ended before the run did' "$work/out" || fail "the message must name the leader: $(cat "$work/out")"

# Without standard output; and as a user without rights, in a network without a route.
short=("$armada" run "$scenario" --seconds 1 --set window_start_s=0.5 --time stepped --pace 0)
"${short[@]}" --out "$work/silent" >&- 2>"$work/out"
[ $? -le 1 ] && [ -s "$work/silent/metrics.json" ] || fail "a run without standard output: $(cat "$work/out")"
nobody=(setpriv --reuid 65534 --regid 65534 --clear-groups)
if [ "$(id -u)" = 0 ] && "${nobody[@]}" test -x "$armada" -a -r "$scenario"; then
  home=$(mktemp -d /tmp/armada_nobody_XXXXXX)
  chmod 777 "$home"
  unshare --net "${nobody[@]}" env HOME="$home" TMPDIR="$home" "${short[@]}" --out "$home/run" >"$work/out" 2>&1
  [ $? -le 1 ] && [ -s "$home/run/metrics.json" ] || fail "a run of a user without rights: $(cat "$work/out")"
  rm -rf "$home"
else
  echo "note: no run of a user without rights: it takes root, and programs that everybody may read"
fi

for time in real stepped; do
  "$armada" run "$scenario" --seconds 60 --time $time --out "$work/crashed" >"$work/out" 2>&1 &
  run=$!
  wait_for 20 all_up || fail "$time: the arms did not start: $(cat "$work/out")"
  pkill -KILL -f "armada-arm $work/.* --arm 3 "
  wait $run
  [ $? = 1 ] || fail "$time: a run with a crashed arm must exit 1: $(cat "$work/out")"
  grep -q 'arm 3' "$work/out" || fail "$time: the message must name arm 3: $(cat "$work/out")"
  wait_for 10 none_left || fail "$time: a crash left processes behind: $(pgrep -af "$work/")"

  "$armada" run "$scenario" --seconds 60 --time $time --out "$work/killed" >"$work/out" 2>&1 &
  run=$!
  wait_for 20 all_up || fail "$time: the arms did not start: $(cat "$work/out")"
  kill -KILL $run
  wait $run 2>/dev/null
  wait_for 10 none_left || fail "$time: a killed run left processes behind: $(pgrep -af "$work/")"
done

[ $failures = 0 ] && echo "command line: all as expected"
exit $((failures > 0))
