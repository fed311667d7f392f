#!/usr/bin/env bash
# The examples of one sweep over several machines give the bytes of the same sweep on one.
# usage: sweep_examples_test.sh BIN_DIR SOURCE_DIR
set -u
export ARMADA=$1/armada
unset SHELL # as in a job of cron
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$2" || exit 1
. tests/host/expect.sh
examples=host/sweep/examples

# A setting that a shell could take apart on its way.
sweep=(hil/scenarios/paper.toml --seeds 1:7 --seconds 0.5 --set window_start_s=0.2 --set "name=\"it's \$1 & 2\"")
"$ARMADA" sweep "${sweep[@]}" --jobs 1 --json "$work/whole.json" >/dev/null 2>&1
[ -s "$work/whole.json" ] || fail "no sweep to compare with"
same() { cmp -s "$work/whole.json" "$1" || fail "$1 differs from the whole sweep: $(cat "$work/out")"; }

# Fleets of such short runs are not ok: exit code 1, and a result nevertheless.
expect 1 '0 of 7 fleets ok' $examples/sweep.parallel.sh "$work/local" 3 "${sweep[@]}"
same "$work/local/sweep.json"

# Taken up again: what is there is not run again, what is missing is.
rm "$work/local/shards/2.json" "$work/local/sweep.json"
touch -d 2001-01-01 "$work/local/shards/1.json"
expect 1 '0 of 7 fleets ok' $examples/sweep.parallel.sh "$work/local" 3 "${sweep[@]}"
same "$work/local/sweep.json"
[ "$(date -r "$work/local/shards/1.json" +%Y)" = 2001 ] || fail "a shard that was done was run again"
[ -s "$work/local/shards/2.json" ] || fail "a missing shard was not run"
expect 2 'shards of another sweep' bash $examples/shard.sh "$work/local/shards" 1 3 "${sweep[@]}" --law paper
expect 1 'no_such_key' bash $examples/shard.sh "$work/wrong" 1 3 "${sweep[@]}" --set no_such_key=1
expect 2 'OUT SHARDS SCENARIO' $examples/sweep.parallel.sh "$work/usage"

# Two machines: the other is this one, by way of a program in place of ssh.
cat >"$work/ssh" <<'SSH'
#!/usr/bin/env bash
echo "$1" >>"${0%/*}/machines"
shift
[ "$1" != -- ] || shift
exec bash -c "$*"
SSH
chmod +x "$work/ssh"
PARALLEL="--ssh $work/ssh --sshlogin 1/elsewhere --sshlogin 1/:" \
  expect 1 '0 of 7 fleets ok' $examples/sweep.parallel.sh "$work/remote" 4 "${sweep[@]}"
same "$work/remote/sweep.json"
grep -q elsewhere "$work/machines" || fail "GNU parallel asked no other machine"

# The array job's script, with the environment that Slurm gives a task; sweep_slurm_test.sh has Slurm itself.
for task in 1 2 3; do
  SLURM_ARRAY_TASK_ID=$task SLURM_ARRAY_TASK_COUNT=3 SLURM_CPUS_PER_TASK=1 bash $examples/sweep.sbatch "$work/array" "${sweep[@]}" \
    >"$work/out" 2>&1 || fail "task $task: $(cat "$work/out")"
done
# One task of it again, alone in its array.
rm "$work/array/shards/2.json"
SHARDS=3 SLURM_ARRAY_TASK_ID=2 SLURM_ARRAY_TASK_COUNT=1 bash $examples/sweep.sbatch "$work/array" "${sweep[@]}" \
  >"$work/out" 2>&1 || fail "task 2 again: $(cat "$work/out")"
expect 1 '0 of 7 fleets ok' "$ARMADA" sweep merge "$work"/array/shards/*.json --json "$work/array/sweep.json"
same "$work/array/sweep.json"

[ $failures = 0 ] && echo "examples: all as expected"
exit $((failures > 0))
