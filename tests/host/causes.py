"""Runs in real time until so many were not ok, under conditions that spoil them, and says what cause each named.

Conditions in turn: eight busy loops without the right to real-time priorities, the same with it, all programs of the run
stopped for 0.1 to 0.5 s, one board stopped. Fails when a run that is not ok names no cause, or when a stall that was made
is not named as one. A measurement, not part of the suite: run_words_test.sh has its short form.

usage: causes.py BIN_DIR SOURCE_DIR [--runs N] [--seconds S]
"""

import argparse
import collections
import contextlib
import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time

from disturbances import NO_RIGHTS, busy_loops


def programs_of(folder, everything):
    for entry in pathlib.Path("/proc").iterdir():
        with contextlib.suppress(OSError, ValueError):
            line = (entry / "cmdline").read_bytes()
            if str(folder).encode() in line and (b"armada" in line or b"lcm-logger" in line):
                if everything or b"armada-arm" in line and b"--arm\x003\x00" in line:
                    yield int(entry.name)


def stop_some(folder, everything, length_s):
    deadline = time.monotonic() + 20
    while not (folder / "arm_7.txt").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    time.sleep(4)
    pids = list(programs_of(folder, everything))
    for number in (signal.SIGSTOP, signal.SIGCONT):
        for pid in pids:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, number)
        if number == signal.SIGSTOP:
            time.sleep(length_s)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("bin", type=pathlib.Path)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("--runs", type=int, default=50)
    parser.add_argument("--seconds", type=float, default=6.0)
    options = parser.parse_args()
    rng, bad, ran, failures, kinds = random.Random(1), 0, 0, 0, collections.Counter()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name) / "run"
        while bad < options.runs and ran < 10 * options.runs:
            condition = ran % 4
            ran += 1
            prefix = NO_RIGHTS if condition == 0 else []
            command = [options.bin / "armada", "run", options.source / "hil/scenarios/paper.toml", "--time", "real", "--seconds",
                       options.seconds, "--set", f"window_start_s={options.seconds - 1}", "--seed", ran, "--out", folder]
            stopper = threading.Thread(target=stop_some, args=(folder, condition == 2, rng.uniform(0.1, 0.5)))
            with busy_loops(8) if condition < 2 else contextlib.nullcontext():
                if condition >= 2:
                    stopper.start()
                run = subprocess.run([*prefix, *map(str, command)], capture_output=True, text=True)
                if condition >= 2:
                    stopper.join()
            if run.returncode == 0:
                continue
            bad += 1
            said = run.stdout + run.stderr
            metrics = folder / "metrics.json"
            found = {"broke off"} if "the run broke off at" in said else set()
            if metrics.exists():
                found = {finding["kind"] for finding in json.loads(metrics.read_text()).get("diagnosis", [])}
            kinds.update(found)
            causeless = not found - {"none"} or "why it is not ok:" not in said
            if causeless or condition == 2 and "stall" not in found:
                failures += 1
                print(f"condition {condition}: {sorted(found)}\n{said}")
            metrics.unlink(missing_ok=True)
    print(f"{bad} of {ran} runs were not ok, {failures} of them without a cause; named: {dict(kinds.most_common())}")
    sys.exit(failures > 0 or bad < options.runs)


main()
