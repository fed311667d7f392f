#!/usr/bin/env bash
# Faults into a run that goes on. usage: fault_test.sh BIN_DIR SOURCE_DIR
set -u
bin=$1
source=$2
armada=$bin/armada
work=$(mktemp -d)
trap 'kill "$run" 2>/dev/null; wait; rm -rf "$work"' EXIT
. "$source/tests/host/expect.sh"
out=$work/run

"$armada" run "$source/hil/scenarios/campaign.toml" --seconds 6 --time stepped --out "$out" >"$work/run.txt" 2>&1 &
run=$!
for ((i = 0; i < 200; ++i)); do
  [ -p "$out/faults.hil" ] && break
  sleep 0.1
done
[ -p "$out/faults.hil" ] || fail "the run did not come about: $(cat "$work/run.txt")"

expect 78 'arm.*given 9' "$armada" fault bus_off --arm 9 --out "$out"
expect 78 'signal.*missing' "$armada" fault drive --arm 1 --out "$out"
expect 78 'kind' "$armada" fault nonsense --out "$out"
expect 2 'forge is of virtual time' "$armada" fault forge --arm 1 --value 0.1 --out "$out"
expect 1 'no run goes on' bash -c "mkdir '$work/old' && cp '$out'/*.toml '$work/old' && '$armada' fault bus_off --arm 1 --out '$work/old'"
expect 0 'from now on: .*stuck' "$armada" fault drive --arm 2 --joint 1 --signal position --way stuck --after 4 --out "$out"
expect 0 'from now on: .*controller_dies' "$armada" fault controller_dies --arm 1 --after 4 --out "$out"

wait "$run"
[ $? = 1 ] || fail "a run whose arms were taken out is not ok"
/usr/bin/python3 - "$out/metrics.json" <<'PY' || fail "metrics.json does not show what the faults did"
import json, sys
metrics = json.load(open(sys.argv[1]))
two, one = metrics["arms"][:2]
assert one["state"] == "FAULT" and "feedback" in one["faults"][0], one
assert two["state"] == "DEAD", two
assert [made["what"] for made in metrics["process_faults"]] == ["killed"], metrics["process_faults"]
PY
[ ! -e "$out/faults.hil" ] && [ ! -e "$out/faults.run" ] || fail "the pipes stay behind"
exit $((failures > 0))
