#!/usr/bin/env bash
# armada can as a user starts it, on the user-space bus with drives that armada-hil emulates.
# usage: can_command_test.sh BIN_DIR SOURCE_DIR
set -u
bin=$1
source=$2
armada=$bin/armada
work=$(mktemp -d)
hil=
stop() {
  [ -z "$hil" ] || kill "$hil" 2>/dev/null
  rm -rf "$work"
}
trap stop EXIT
. "$source/tests/host/expect.sh"

bus=udp:239.74.163.98:43198
cat >"$work/fleet.toml" <<END
name = "mixed"
[[arm]]
id = 4
bus = "$bus"
torque_limit_Nm = 50.0
link = [
  { m_kg = 0.8, l_m = 0.6, r_m = 0.3, I_kgm2 = 6.0 },
  { m_kg = 0.8, l_m = 0.6, r_m = 0.3, I_kgm2 = 6.0 },
  { m_kg = 0.8, l_m = 0.6, r_m = 0.3, I_kgm2 = 6.0 },
  { m_kg = 0.6, l_m = 0.6, r_m = 0.3, I_kgm2 = 3.0 },
]
joint = [
  { drive = "odrive_cansimple", node_id = 17, gear_ratio = 10.0 },
  { drive = "damiao", node_id = 4, gear_ratio = 10.0, mit = { master_id = 20 } },
  { drive = "cia402", node_id = 5, gear_ratio = 50.0 },
  { drive = "moteus", node_id = 6, gear_ratio = 10.0 },
]
[[graph]]
pins = [4]
edges = []
END
cat >"$work/scenario.toml" <<END
name = "mixed"
fleet = "fleet.toml"
seconds = 100.0
window_start_s = 0.0
[leader]
kind = "sine"
axis = [{ offset_m = 1.0, amplitude_m = 0.1, frequency_hz = 0.5 }, { offset_m = 1.0 }]
[start]
kind = "near_leader"
[disturbance]
kind = "none"
END

# Bad input: one clear message.
expect 2 'required' "$armada" can decode
expect 2 'there are odrive_cansimple, ' "$armada" can dbc --profile odrive
expect 2 '--arm 9: no such arm; .* has 4' "$armada" can dbc --fleet "$work/fleet.toml" --arm 9
expect 78 'nonexistent.toml' "$armada" can check /nonexistent.toml
expect 1 'cannot read /nonexistent.log' "$armada" can decode /nonexistent.log --profile moteus
printf '(1.0) can0 029#R8\nnonsense\n' >"$work/log"
expect 1 "log:2: 'nonsense' is no line" "$armada" can decode "$work/log" --profile moteus
expect 1 'udp:nowhere' "$armada" can scan udp:nowhere

# A fleet's files and what is wrong with its buses.
expect 0 '^BO_ 544 J1_Version: 8 J1$' "$armada" can dbc --fleet "$work/fleet.toml"
expect 0 'DataType=0x0007' "$armada" can eds
expect 0 'joint 2 .*damiao .*register 9 and read back' "$armada" can check "$work/fleet.toml"
expect 0 '"load": 0\.' "$armada" can check "$work/fleet.toml" --json
expect 1 'error: arm 4: its bus would have to carry' "$armada" can check "$work/fleet.toml" \
  --set arm.4.can.bitrate_bit_s=20000

# Emulated drives are found, asked, and none is enabled by it.
"$bin/armada-hil" "$work/scenario.toml" >"$work/hil.out" 2>&1 &
hil=$!
for _ in $(seq 200); do
  grep -q 'arms on' "$work/hil.out" && break
  sleep 0.1
done
expect 0 '^4 drives' "$armada" can scan $bus --seconds 2.5
for drive in 'cia402 +5' 'damiao +4 +answers on 14h' 'moteus +6 +register map 5 +mode 0' 'odrive_cansimple +17 +0\.6\.10'; do
  grep -qE "^$drive" "$work/out" || fail "not found: $drive: $(cat "$work/out")"
done
expect 0 'J1 Heartbeat axis_error=' "$armada" can decode --fleet "$work/fleet.toml" --bus $bus --seconds 1

[ "$failures" = 0 ] && echo "ok"
exit $((failures > 0))
