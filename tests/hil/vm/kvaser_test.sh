#!/usr/bin/env bash
# Two arms, one with MIT frames and one with CANopen, over controllers with a real driver: Kvaser PCI cards (sja1000) at
# 1 Mbit/s, emulated by QEMU. The run meets its criterion, and no frame is lost. usage: kvaser_test.sh BIN_DIR SOURCE_DIR
set -euo pipefail
bin=$1
source=$2
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

buses=()
for bus in 0 1; do
  buses+=(-q -object -q "can-bus,id=bus$bus")
  for end in 0 1; do buses+=(-q -device -q "kvaser_pci,canbus=bus$bus,addr=$((16 + 2 * bus + end))"); done
done
"$source/hil/vm/run_virtual" -k stock -o "$out" -m kvaser_pci "${buses[@]}" -p "$bin/armada" -p "$bin/armada-arm" \
  -p "$bin/armada-hil" -p "$bin/armada-leader" -p lcm-logger -f "$source/firmware" -f "$source/hil" \
  -f "$source/tests/hil/vm/in_kvaser_guest.sh" -- bash in_kvaser_guest.sh || {
  echo "FAILED with exit code $?"
  exit 1
}

/usr/bin/python3 - "$out" <<'PY'
import json, pathlib, sys
out = pathlib.Path(sys.argv[1])
metrics = json.loads((out / "run/metrics.json").read_text())
hil = {arm["id"]: arm for arm in json.loads((out / "run/hil.json").read_text())["arms"]}
assert metrics["ok"], metrics
for arm in metrics["arms"]:
    drives = hil[arm["id"]]
    board, bench = arm["bus"], drives["bus"]
    assert arm["timing"]["missed_ticks"] == 0 and arm["timing"]["incomplete_samples"] == 0, arm["timing"]
    assert board["can_sent"] >= 600 * arm["dof"], board  # a torque for each joint, 6 s at 100 Hz
    for counters in (board, bench):
        for loss in ("can_dropped", "can_malformed", "can_errors"):
            assert counters[loss] == 0, (loss, arm["id"], counters)
    for profile_loss in ("can_nonsense", "can_dropped_late", "can_receive_overflowed", "can_error_passive", "can_bus_off"):
        assert board[profile_loss] == 0, (profile_loss, board)
# What one controller sent, the other one of its bus received, frame for frame.
interfaces = {link["ifname"]: link for link in json.loads((out / "interfaces.json").read_text())}
assert sorted(interfaces) == ["can0", "can1", "can2", "can3"], interfaces
for name, link in interfaces.items():
    can = link["linkinfo"]["info_data"]
    assert can["bittiming"]["bitrate"] == 1000000, can
    received, sent = link["stats64"]["rx"], link["stats64"]["tx"]
    assert received["errors"] == received["dropped"] == sent["errors"] == sent["dropped"] == 0, link["stats64"]
for board, bench in (("can0", "can1"), ("can2", "can3")):
    for sender, receiver in ((board, bench), (bench, board)):
        sent = interfaces[sender]["stats64"]["tx"]["packets"]
        received = interfaces[receiver]["stats64"]["rx"]["packets"]
        assert sent == received, f"{sender} sent {sent} frames, {receiver} received {received}"
print("every frame arrived")
PY
