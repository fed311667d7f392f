"""Stepped time: the same seed leaves the same bytes, whatever the machine does meanwhile.

The paper's arms run unpaced under several conditions: on the machine as it is; beside eight busy loops; at nice 19; with
programs of the run stopped at random for 100 ms; without the right to real-time priorities and locked memory. Each run
must be ok, and leave what the first one left: metrics.json but for `timing` and `memory`, the logs of LCM and CAN and
the traces, byte for byte.

usage: stepped_test.py BIN_DIR SOURCE_DIR [--runs N] [--seconds S]      N of each condition, S seconds of the run
       stepped_test.py --demo CHECKOUT [--runs N]                       by `./run demo --pace 0` there
--only CONDITION: that one, against a single run on the machine as it is.
"""

import argparse
import contextlib
import hashlib
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

PROGRAMS = ("armada-arm", "armada-hil", "armada-leader")
STOP_S = 0.1


def pruned(value):
    """Without what the machine says of itself."""
    if isinstance(value, dict):
        return {key: pruned(item) for key, item in value.items() if key not in ("timing", "memory")}
    return [pruned(item) for item in value] if isinstance(value, list) else value


def left_by(folder):
    """Digests of what a run has left, by file."""
    left = {"metrics.json": json.dumps(pruned(json.loads((folder / "metrics.json").read_text())))}
    for pattern in ("lcm.log", "can_*.log", "*.csv"):
        for path in sorted(folder.glob(pattern)):
            left[path.name] = hashlib.sha256(path.read_bytes()).hexdigest()
    return left


def programs_of(folder):
    """Processes of the run that goes on in a folder."""
    for entry in pathlib.Path("/proc").iterdir():
        with contextlib.suppress(OSError, ValueError):
            words = (entry / "cmdline").read_bytes().decode().split("\0")
            place = (entry / "cwd").readlink()  # its words may be relative
            if words[0].endswith(PROGRAMS) and any((place / word).is_relative_to(folder) for word in words[1:]):
                yield int(entry.name)


@contextlib.contextmanager
def stopping(folder):
    """Stops programs of the run, one after another, at random."""
    over, stops, rng = threading.Event(), [], random.Random()

    def stop_them():
        while not over.is_set():
            pids = list(programs_of(folder))
            with contextlib.suppress(ProcessLookupError):
                if pids:
                    pid = rng.choice(pids)
                    os.kill(pid, signal.SIGSTOP)
                    time.sleep(STOP_S)
                    os.kill(pid, signal.SIGCONT)
                    stops.append(pid)
            time.sleep(rng.uniform(0, STOP_S))

    thread = threading.Thread(target=stop_them)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
    assert stops, "nothing was stopped"


CONDITIONS = {
    "idle": ([], lambda folder: contextlib.nullcontext()),
    "eight busy loops": ([], lambda folder: busy_loops(8)),
    "nice 19": (["nice", "-n", "19"], lambda folder: contextlib.nullcontext()),
    "stopped at random": ([], stopping),
    "no real-time rights": (NO_RIGHTS, lambda folder: contextlib.nullcontext()),
}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("places", nargs="*", type=pathlib.Path)
    parser.add_argument("--demo", type=pathlib.Path)
    parser.add_argument("--runs", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=6.0)
    parser.add_argument("--only", choices=CONDITIONS)
    options = parser.parse_args()
    series = dict.fromkeys(CONDITIONS, options.runs)
    if options.only:
        series = {"idle": 1, options.only: options.runs}
    failed, done, first = 0, 0, None
    with tempfile.TemporaryDirectory() as name:
        for condition, runs in series.items():
            prefix, around = CONDITIONS[condition]
            speeds = []
            for _ in range(runs):
                if options.demo:
                    folder = options.demo.resolve() / "out/demo"
                    command = [options.demo.resolve() / "run", "demo", "--pace", "0"]
                else:
                    folder = pathlib.Path(name) / "run"
                    command = [options.places[0] / "armada", "run", options.places[1] / "hil/scenarios/paper.toml",
                               "--seconds", str(options.seconds), "--set",
                               f"window_start_s={options.seconds - 1}", "--time", "stepped", "--pace", "0", "--out", folder]
                with around(folder):
                    run = subprocess.run([*prefix, *map(str, command)], capture_output=True, text=True)
                done += 1
                if run.returncode != 0:
                    failed += 1
                    print(f"{condition}: exit code {run.returncode}\n{run.stdout}{run.stderr}")
                    continue
                stepped = json.loads((folder / "metrics.json").read_text())["stepped"]
                speeds.append(stepped["stepped_s"] / stepped["timing"]["real_s"])
                left = left_by(folder)
                first = first or left
                differing = sorted(file for file in first.keys() | left.keys() if first.get(file) != left.get(file))
                if differing:
                    failed += 1
                    print(f"{condition}: differs in {', '.join(differing)}")
            if speeds:
                print(f"{condition}: {len(speeds)} runs, {min(speeds):.1f} to {max(speeds):.1f} times real time", flush=True)
    print(f"{done - failed} of {done} runs ok and the same, {len(first or {})} files each")
    sys.exit(failed > 0 or not first)


main()
