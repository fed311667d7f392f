#!/usr/bin/env bash
# The array job on Slurm itself: a cluster of one node, this one, in a network of its own. Needs root.
# usage: private_network.sh sweep_slurm_test.sh BIN_DIR SOURCE_DIR
# shellcheck disable=SC2317  # functions are called by wait_for and the trap
set -u
export ARMADA=$1/armada
work=$(mktemp -d)
cd "$2" || exit 1
. tests/host/expect.sh
trap clean_up EXIT

clean_up() {
  local file pid pids=()
  for file in "$work"/*.pid; do pids+=("$(cat "$file")"); done
  kill "${pids[@]}"
  for pid in "${pids[@]}"; do wait_for 20 gone "$pid"; done
  rm -rf "$work"
}
gone() {
  ! kill -0 "$1"
}

# wait_for SECONDS COMMAND...
wait_for() {
  local deadline=$((SECONDS + $1))
  shift
  until "$@" >/dev/null 2>&1; do
    [ $SECONDS -lt $deadline ] || return 1
    read -rt 0.1 <> <(:) || true
  done
}

# Slurm resolves no name, not even 127.0.0.1, where there is no address but that.
ip address add 192.0.2.1/32 dev lo || fail "no address"
node=$(hostname -s)
chmod 711 "$work"
mkdir "$work/state" "$work/spool"
(umask 077 && head -c 1024 /dev/urandom >"$work/key")
cat >"$work/slurm.conf" <<CONF
ClusterName=armada
SlurmctldHost=$node(127.0.0.1)
AuthInfo=socket=$work/munged.socket
SlurmUser=root
SlurmctldPort=36817
SlurmdPort=36818
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
NodeName=$node NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$node Default=YES State=UP
CONF
export SLURM_CONF=$work/slurm.conf
munged --force --key-file="$work/key" --socket="$work/munged.socket" --pid-file="$work/munged.pid" \
  --log-file="$work/munged.log" --seed-file="$work/munged.seed" >"$work/out" 2>&1 || fail "munged: $(cat "$work/out")"
slurmctld -f "$SLURM_CONF" || fail "no controller"
slurmd -f "$SLURM_CONF" -N "$node" || fail "no node"
idle() {
  [ "$(sinfo --noheader --format %t)" = idle ]
}
wait_for 20 idle || fail "the node never was idle: $(cat "$work/slurmctld.log" "$work/slurmd.log")"

sweep=(hil/scenarios/paper.toml --seeds 1:7 --seconds 0.5 --set window_start_s=0.2 --set "name=\"it's \$1 & 2\"")
"$ARMADA" sweep "${sweep[@]}" --jobs 1 --json "$work/whole.json" >/dev/null 2>&1
job=$(sbatch --parsable --array=1-3 --cpus-per-task=1 --output="$work/task_%a.txt" host/sweep/examples/sweep.sbatch \
  "$work/box" "${sweep[@]}")
sbatch --dependency="afterok:$job" --output="$work/merge.txt" \
  --wrap "$ARMADA sweep merge $work/box/shards/*.json --json $work/box/sweep.json" >"$work/out" 2>&1 || fail "$(cat "$work/out")"
none_left() {
  [ -z "$(squeue --noheader)" ]
}
wait_for 60 none_left || fail "the jobs did not end: $(squeue)"
cmp -s "$work/whole.json" "$work/box/sweep.json" ||
  fail "the array's sweep differs from the whole one: $(cat "$work"/task_*.txt "$work/merge.txt")"

[ $failures = 0 ] && echo "Slurm: all as expected"
exit $((failures > 0))
