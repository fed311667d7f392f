"""Ten thousand datagrams a second of a stranger, on the network of a running fleet: none is accepted, each is counted
where it was refused, none of the fleet's own is lost, and all arms track on.

The fleet's time is stepped, so that a busy machine loses nothing; the stranger keeps real time. With --time real the
fleet does, too: then a machine that stalls may fail the test, which tells what the run says of it.

usage: storm_test.py BIN_DIR SOURCE_DIR [--time real], in a network of its own
"""

import json
import pathlib
import subprocess
import sys
import tempfile

SECONDS, STORM_SECONDS, RATE = 8, 5, 10_000
LEAST_DELIVERED = {"stepped": 1.0, "real": 0.99}


def storm_over_a_run(programs, source, time, folder):
    """metrics.json of a run, what it printed, and what was sent to it meanwhile."""
    sent = folder / "storm.json"
    storm = subprocess.Popen(
        [programs / "armada", "storm", "--fleet", source / "firmware/fleets/paper.toml", "--wait", "60", "--rate",
         str(RATE), "--seconds", str(STORM_SECONDS), "--json", sent],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    run = subprocess.run(
        [programs / "armada", "run", source / "hil/scenarios/paper.toml", "--seconds", str(SECONDS), "--bus", "udp",
         "--time", time, "--set", "window_start_s=5", "--out", folder / "run"],
        capture_output=True, text=True, timeout=240)
    output, _ = storm.communicate(timeout=60)
    assert storm.returncode == 0, output + run.stdout + run.stderr
    assert run.returncode in (0, 1), run.stdout + run.stderr
    metrics = json.loads((folder / "run/metrics.json").read_text())
    return metrics, run.stdout + run.stderr, json.loads(sent.read_text())


def channel(sender):
    return f"EST_{sender}" if sender else "LEADER"


def check_nothing_accepted(arm, sent):
    """Each of the stranger's datagrams is counted where it was refused, but for those that the kernel dropped."""
    bus, kinds, on = arm["bus"], sent["sent"], sent["channels"]
    assert bus["lcm_overflowed"] >= kinds["oversized"], bus
    dropped = bus["lcm_overflowed"] - kinds["oversized"]

    def counts(refused, of_them):
        assert of_them - dropped <= refused <= of_them, (arm["id"], refused, of_them, dropped, bus)

    counts(bus["lcm_malformed"], sum(kinds[kind] for kind in ("random", "short_header", "unterminated", "fragment")))
    by_seal = bus["lcm_forged"] + bus["lcm_replayed"]
    counts(by_seal, sum(on.get(channel(sender["from"]), 0) for sender in bus["lcm_heard"]))
    counts(bus["lcm_rejected"] - by_seal - bus["lcm_late"] - bus["lcm_implausible"], on["CMD"])


def delivered(arm):
    """Least share of a sender's messages that the arm took."""
    return min(sender["accepted"] / (sender["accepted"] + sender["missed"]) for sender in arm["bus"]["lcm_heard"])


def main():
    programs, source = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    time = "real" if sys.argv[3:] == ["--time", "real"] else "stepped"
    with tempfile.TemporaryDirectory() as name:
        metrics, words, sent = storm_over_a_run(programs, source, time, pathlib.Path(name))
    assert sum(sent["sent"].values()) >= 0.9 * RATE * STORM_SECONDS, sent["sent"]
    for arm in metrics["arms"]:
        assert arm["memory"]["heap_allocations"] in (0, None), arm
        check_nothing_accepted(arm, sent)
    least = min(delivered(arm) for arm in metrics["arms"])
    print(f"ok: {metrics['ok']}, delivered: {least:.4f}, sent: {sent['sent']}")
    if not metrics["ok"] or least < LEAST_DELIVERED[time]:
        sys.exit("the run was not in order:\n" + words)


main()
