#!/usr/bin/env bash
# The wall clock steps by an hour, ahead and back, while arms move: only the monotonic clock counts.
# usage: vm_wall_clock_test.sh BIN_DIR SOURCE_DIR
set -u
source "$(dirname "${BASH_SOURCE[0]}")/checks.sh"

# shellcheck disable=SC2016  # expanded in the guest
steps='
step() { read -rt "$1" <> <(:) || :; busybox date -s "@$(($(busybox date +%s) + $2))" >/dev/null; }
(step 3.7 3600; step 0.6 -3600; busybox date >out/stepped) &
armada run hil/scenarios/two_arms.toml --seconds 4 --set window_start_s=1.5 --bus socketcan --out out/run
status=$?
wait
exit $status'
(cd "$source" && hil/vm/run_virtual -o "$work/stepped" -f firmware -f hil -p "$bin/armada" -p "$bin/armada-arm" \
  -p "$bin/armada-hil" -p "$bin/armada-leader" -p lcm-logger -- bash -c "$steps") >"$work/out" 2>&1 ||
  fail "a clock that steps: $(cat "$work/out")"
[ -s "$work/stepped/stepped" ] || fail "the clock did not step: $(cat "$work/out")"
/usr/bin/python3 - "$work/stepped/run/metrics.json" <<'PY' || fail "metrics of a run whose wall clock stepped"
import json, sys
metrics = json.load(open(sys.argv[1]))
assert metrics["ok"]
for arm in metrics["arms"]:
    assert arm["state"] == "RUN" and arm["timing"]["missed_ticks"] == 0 and arm["bus"]["lcm_rejected"] == 0, arm
PY

finish
