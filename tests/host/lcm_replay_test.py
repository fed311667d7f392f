"""lcm-logger and lcm-logplayer on Armada's channels: what a run left in lcm.log is played on another LCM url,
and lcm-logger there hears the same messages, byte for byte and in order on each channel.

usage: lcm_replay_test.py BIN_DIR SOURCE_DIR, in a network of its own
"""

import pathlib
import socket
import struct
import subprocess
import sys
import tempfile
import time

GROUP, PORT = "239.255.76.67", 7701
REPLAY_URL = f"udpm://{GROUP}:{PORT}?ttl=0"
PATIENCE_S = 60
# Slow enough for the kernel's default queue to outlast a logger that gets no processor for half a second.
SPEED = "0.25"


def read_log(path):
    """(channel, payload) of each whole event of an LCM log.

    An event is a sync word, its number, its time, two lengths, the channel and the payload.
    """
    events, data, at = [], path.read_bytes(), 0
    header = struct.Struct(">Iqqii")
    while at + header.size <= len(data):
        sync, _, _, channel_size, payload_size = header.unpack_from(data, at)
        assert sync == 0xEDA1DA01, f"{path}: no event at byte {at}"
        at += header.size
        end = at + channel_size + payload_size
        if end > len(data):  # still being written
            break
        events.append((data[at:at + channel_size].decode(), data[at + channel_size:end]))
        at = end
    return events


def by_channel(events):
    channels = {}
    for channel, payload in events:
        channels.setdefault(channel, []).append(payload)
    return channels


def wait_until_heard(channel, log):
    """Sends empty messages on `channel` until one is in the log: all that was sent before is there then."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        deadline = time.monotonic() + PATIENCE_S
        while not (log.exists() and any(heard == channel for heard, _ in read_log(log))):
            assert time.monotonic() < deadline, f"lcm-logger does not hear {channel}"
            sender.sendto(b"LC02" + struct.pack(">I", 0) + channel.encode() + b"\0", (GROUP, PORT))
            time.sleep(0.05)


def record(programs, source, folder):
    """A run of one second in stepped time: its log is made by the run itself."""
    run = subprocess.run(
        [programs / "armada", "run", source / "hil/scenarios/paper.toml", "--seconds", "1", "--time", "stepped",
         "--pace", "0", "--set", "window_start_s=0.5", "--out", folder / "run"],
        capture_output=True, text=True, timeout=PATIENCE_S)
    # Exit code 1: ran, and was not settled so soon.
    assert (folder / "run/metrics.json").exists(), run.stdout + run.stderr
    return folder / "run/lcm.log"


def replay(recorded, folder):
    log = folder / "replayed.log"
    logger = subprocess.Popen(["lcm-logger", "--quiet", "--flush-interval=1", f"--lcm-url={REPLAY_URL}", log])
    try:
        wait_until_heard("BEGIN", log)
        subprocess.run(["lcm-logplayer", f"--speed={SPEED}", f"--lcm-url={REPLAY_URL}", recorded], check=True,
                       stdout=subprocess.DEVNULL, timeout=PATIENCE_S)
        wait_until_heard("END", log)
    finally:
        logger.terminate()
        logger.wait()
    return log


def main():
    programs, source = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        recorded = record(programs, source, folder)
        sent = by_channel(read_log(recorded))
        arms = range(1, 8)
        assert set(sent) == {"LEADER", *(f"EST_{i}" for i in arms), *(f"TEL_{i}" for i in arms)}, sorted(sent)

        heard = by_channel(read_log(replay(recorded, folder)))
        del heard["BEGIN"], heard["END"]
        assert set(heard) == set(sent), sorted(heard)
        for channel, payloads in sent.items():
            assert heard[channel] == payloads, f"{channel}: {len(payloads)} sent, {len(heard[channel])} heard"
        print(f"{sum(map(len, sent.values()))} messages on {len(sent)} channels replayed byte for byte")


main()
