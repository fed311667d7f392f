"""Judges a run of hil/vm/hil: deadlines, losses, and the frames that candump saw. Prints one line, or what is wrong.

usage: judge.py DIR    with run/ of `armada run` and candump.log
"""

import collections
import json
import pathlib
import sys

# Bounds in virtual time, microseconds. Nine programs share one processor of 1000 MIPS and all boards tick at the same
# instant: the last one waits for the work of the six others, in all about 4.5 ms. Measured figures: docs/hil.md.
WAKEUP_P999_US = 5000
WAKEUP_MAX_US = 8500  # the first tick, with cold caches; 10000 would be a missed one
TORQUE_P99_US = 1500
TORQUE_MAX_US = 6000  # ticks in which a lock of the network makes the boards take turns: all end with the last
# Counters of metrics.json that must stay 0.
LOSSES = ("can_dropped", "can_malformed", "can_errors", "lcm_rejected", "lcm_malformed", "lcm_overflowed")


def frames(path, bus):
    """(stamp, frame) of the lines of a candump log that are of this bus."""
    with open(path, encoding="ascii") as log:
        for line in log:
            stamp, channel, frame = line.split()
            if channel == bus:
                yield stamp, frame


def judge(directory):
    run = directory / "run"
    metrics = json.loads((run / "metrics.json").read_text())
    complaints = [] if metrics["ok"] else ["the run is not ok"]
    wakeup_us, torque_us, count = [], [], 0

    for arm in metrics["arms"]:
        name, timing = f"arm {arm['id']}", arm["timing"]

        def bound(value, limit, what):
            if value > limit:
                complaints.append(f"{name}: {what} {value:g}, allowed {limit:g}")

        bound(timing["missed_ticks"], 0, "missed ticks")
        bound(timing["incomplete_samples"], 0, "ticks with incomplete samples")
        for loss in LOSSES:
            bound(arm["bus"][loss], 0, loss)
        wakeup, torque = timing["wakeup_lateness_us"], timing["sample_to_torque_us"]
        bound(wakeup["p99.9"], WAKEUP_P999_US, "wake-up lateness p99.9 [us]")
        bound(wakeup["max"], WAKEUP_MAX_US, "wake-up lateness max [us]")
        bound(torque["p99"], TORQUE_P99_US, "sample to torque p99 [us]")
        bound(torque["max"], TORQUE_MAX_US, "sample to torque max [us]")
        wakeup_us.append((wakeup["p99.9"], wakeup["max"]))
        torque_us.append((torque["p99"], torque["p99.9"], torque["max"]))

        # Our log has all that candump saw; what came after its end are the boards' farewells.
        ours = list(frames(run / f"can_{arm['id']}.log", f"can{arm['id']}"))
        theirs = list(frames(directory / "candump.log", f"vcan{arm['id']}"))
        count += len(theirs)
        missing = collections.Counter(f for _, f in ours) - collections.Counter(f for _, f in theirs)
        extra = collections.Counter(f for stamp, f in theirs if stamp <= ours[-1][0])
        extra -= collections.Counter(f for _, f in ours)
        if missing or extra:
            complaints.append(f"{name}: candump lacks {missing.total()} of our frames, we lack {extra.total()}")

    for complaint in complaints:
        print(complaint, file=sys.stderr)
    wakeup, torque = map(max, zip(*wakeup_us)), map(max, zip(*torque_us))
    print("two runs identical, {} frames; no missed tick, wake-up p99.9/max {:.0f}/{:.0f} us, sample to torque "
          "p99/p99.9/max {:.0f}/{:.0f}/{:.0f} us, fleet RMS {:.3f} mm".format(count, *wakeup, *torque, metrics["fleet_rms_mm"]))
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(judge(pathlib.Path(sys.argv[1])))
