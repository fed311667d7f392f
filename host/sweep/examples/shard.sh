#!/usr/bin/env bash
# One shard of a sweep, unless it is done already: what sweep.parallel.sh and sweep.sbatch run many times.
#
#   shard.sh OUT I SHARDS SCENARIO [OPTION of armada sweep ..]     leaves OUT/I.json, and what was said in OUT/I.txt
#
# ARMADA: the program; JOBS: threads of the shard.
set -euo pipefail
out=$1 i=$2 shards=$3
shift 3

mkdir -p "$out"
# Shards of another sweep in the same directory would be joined to this one's.
command="$shards $(printf ' %q' "$@")"
echo "$command" >"$out/.command.$i"
ln "$out/.command.$i" "$out/command" 2>/dev/null || true
rm "$out/.command.$i"
[ "$(cat "$out/command")" = "$command" ] || {
  echo "shard.sh: $out holds shards of another sweep: $(cat "$out/command")" >&2
  exit 2
}

[ ! -s "$out/$i.json" ] || exit 0
# Exit code 1 says that a fleet is not ok, which is a result; without its file it is none.
"${ARMADA:-build/release/bin/armada}" sweep "$@" --shard "$i/$shards" --jobs "${JOBS:-1}" --json "$out/$i.json" \
  >"$out/$i.txt" 2>&1 || [ -s "$out/$i.json" ] || { cat "$out/$i.txt" >&2; exit 1; }
