"""Judges the golden bytes of the LCM messages by lcm-gen's Python codecs, and of a sealed one by Python's BLAKE2b:
neither shares code with ours.

usage: golden_bytes.py LCM_GEN LCMTYPES_DIR GOLDEN_BYTES_H

Exits 1 and prints the expected line for each message whose bytes in GOLDEN_BYTES_H differ.
"""

import hashlib
import pathlib
import re
import struct
import subprocess
import sys
import tempfile


def leader(armada):
    m = armada.leader_t()
    m.stamp_ns, m.sequence, m.path_time_s, m.task_dim = 0x0102030405060708, 1, 0.25, 2
    m.x_m, m.v_m_s, m.a_m_s2 = [1.5, -2.0, 0.0], [0.5, 4.0, 0.0], [-8.0, 0.125, 0.0]
    m.jerk_m_s3 = [16.0, -0.5, 0.0]
    return m


def estimate(armada):
    m = armada.estimate_t()
    m.stamp_ns, m.sequence, m.arm_id, m.task_dim = 1_000_000_007, 258, 7, 3
    m.state, m.stopped, m.fleet_digest = 6, True, 0x1122334455667788
    m.agreement, m.leader_age_s = 0x0102, -1.0
    m.x_m, m.v_m_s, m.a_m_s2 = [1.0, 2.0, 3.0], [-1.0, -2.0, -3.0], [0.5, 0.25, 0.125]
    m.jerk_m_s3 = [-4.0, 8.0, -0.25]
    return m


def telemetry(armada):
    m = armada.telemetry_t()
    m.stamp_ns, m.sequence = 2_000_000_000, 3
    m.arm_id, m.dof, m.task_dim, m.parameter_count, m.state, m.cause, m.synced = 6, 7, 2, 35, 4, 3, True
    m.q_rad, m.dq_rad_s, m.tau_Nm, m.d_hat_Nm = ([base + i for i in range(7)] for base in (1.0, 11.0, 21.0, 31.0))
    m.x_m, m.error_m, m.subtask_error_rad_s, m.sigma_min = [0.5, 1.5, 0.0], 0.25, 0.75, 0.125
    m.theta_hat = [100.0 + i for i in range(35)]
    m.saturated_ticks, m.missed_ticks, m.wakeup_lateness_us = 1, 2, -3
    m.compute_us, m.sample_to_torque_us, m.heap_allocations, m.page_faults = 4, 5, 6, 7
    m.can_sent, m.can_received, m.can_dropped, m.lcm_received, m.lcm_rejected = 8, 9, 10, 11, 12
    return m


def command(armada):
    m = armada.command_t()
    m.stamp_ns, m.sequence, m.arm_id, m.request = 3_000_000_000, 5, 7, 2
    m.heard_stamp_ns, m.fleet_digest = 1_000_000_007, -2
    return m


def reply(armada):
    m = armada.reply_t()
    m.stamp_ns, m.sequence, m.arm_id, m.request = 1_010_000_007, 9, 7, 2
    m.command_stamp_ns, m.command_sequence, m.refusals, m.state, m.cause = 3_000_000_000, 5, 0x81, 5, 6
    return m


def sealed(sender, channel, payload):
    """With the fleet key 0, 1, .. 31, in epoch 3, as the sender's first message."""
    key = hashlib.blake2b(b"", digest_size=32, key=bytes(range(32)), salt=struct.pack("<QQ", sender, 0),
                          person=b"armadaLK").digest()
    times = struct.pack(">QQ", 3, 1)
    tag = hashlib.blake2b(times + bytes([len(channel)]) + channel + payload, digest_size=16, key=key).digest()
    return payload + times + tag


def main():
    lcm_gen, types, header = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([lcm_gen, "-p", "--ppath", folder, *map(str, sorted(types.glob("*.lcm")))], check=True)
        sys.path.insert(0, folder)
        import armada

        golden = dict(re.findall(r"(k\w+Hex)\[\] =((?:\s*\"[0-9a-f]*\")+);", header.read_text()))
        golden = {name: re.sub(r"[^0-9a-f]", "", text) for name, text in golden.items()}
        wrong = 0
        for name, expected in (("kLeaderHex", leader(armada).encode()), ("kEstimateHex", estimate(armada).encode()),
                               ("kTelemetryHex", telemetry(armada).encode()),
                               ("kCommandHex", command(armada).encode()),
                               ("kReplyHex", reply(armada).encode()),
                               ("kSealedEstimateHex", sealed(7, b"EST_7", estimate(armada).encode()))):
            expected = expected.hex()
            if golden.get(name) != expected:
                wrong += 1
                print(f"{name} should be {expected}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
