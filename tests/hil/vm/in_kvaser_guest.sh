#!/usr/bin/env bash
# Inside a guest with two CAN buses, two Kvaser cards on each: the boards have can0 and can2, the emulated drives can1
# and can3.
set -euo pipefail
for interface in can0 can1 can2 can3; do
  ip link set dev "$interface" up type can bitrate 1000000
done
status=0
armada run hil/scenarios/two_arms.toml --seconds 6 --set window_start_s=4.0 --bus socketcan \
  --hil-bus 1=socketcan:can1 --hil-bus 2=socketcan:can3 --out out/run || status=$?
ip -details -statistics -json link show type can >out/interfaces.json
exit "$status"
