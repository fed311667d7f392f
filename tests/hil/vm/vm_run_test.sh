#!/usr/bin/env bash
# `armada run --bus vm`. usage: vm_run_test.sh BIN_DIR SOURCE_DIR
set -u
source "$(dirname "${BASH_SOURCE[0]}")/checks.sh"

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

finish
