#!/usr/bin/env bash
# One sweep in shards by GNU parallel, on this machine or several, joined at the end.
#
#   sweep.parallel.sh OUT SHARDS SCENARIO [OPTION of armada sweep ..]     leaves OUT/sweep.json and OUT/shards/
#
# Options of GNU parallel go into $PARALLEL. Several machines, which need this directory at the same path:
#
#   PARALLEL='--sshlogin 2/: --sshlogin 8/big --sshlogin 8/bigger' \
#     host/sweep/examples/sweep.parallel.sh out/box 64 hil/scenarios/paper.toml --seeds 1:10000
#
# N/HOST is N shards at a time there, `:` this machine. More shards than places keep all busy to the end. Shards that are
# done are not run again: the same command takes up a sweep that was stopped. docs/sweeps.md has more.
set -euo pipefail
[ $# -ge 3 ] || { sed -n '4s/^# *//p' "$0" >&2; exit 2; }
out=$1 shards=$2
shift 2

# Without it, and without SHELL as in a job of cron, GNU parallel may take a machine's shell for another and run nothing.
export PARALLEL_SHELL=/bin/bash
# A shard has one thread; GNU parallel runs as many as there are cores.
seq "$shards" | parallel --will-cite --workdir . --env ARMADA --quote \
  bash "$(dirname "$0")/shard.sh" "$out/shards" {} "$shards" "$@"
mapfile -t files < <(seq -f "$out/shards/%.0f.json" "$shards")
"${ARMADA:-build/release/bin/armada}" sweep merge "${files[@]}" --json "$out/sweep.json"
