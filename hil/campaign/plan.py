"""Draws the runs of the campaigns of processes: which board is killed, stopped, cut off or slowed down, and when.

usage: plan.py guests|stepped SEED PHASES DIR [RUN]    writes DIR/<run>_<policy>.toml until PHASES kills and stops are
                                                       planned; with RUN only that run

In stepped time no link can be cut, since the user-space bus has none, and no program is slow. The same seed gives the
same runs, and each run is drawn by itself: it stays what it is whatever PHASES are.
"""

import itertools
import pathlib
import random
import sys

ARMS = range(1, 8)
SETTLED_S = 0.8  # every arm follows: fleets start near the leader
GAP_S = (0.20, 0.45)  # what a phase changes is there within 0.11 s
HOG_PRIORITY = 82  # above the boards' 80, below the emulated drives' 85: hardware is not slowed down
# Of the kills and stops, by weight: what happens, and for how long. What is not within 55 to 130 ms is for sure
# noticed by the others, or not.
KINDS = (
    (40, "controller_dies", None),
    (15, "controller_stops", None),
    (20, "controller_stops", (0.130, 0.400)),
    (10, "controller_stops", (0.031, 0.055)),
    (10, "controller_stops", (0.001, 0.030)),
    (5, "controller_restarts", (0.130, 0.400)),
)
BUS_DOWN = {"guests": 0.15, "stepped": 0.0}  # share of the boards that are cut off from their drives in place of that
LEADER_DIES = 0.25  # share of the runs
HOG = {"guests": 0.25, "stepped": 0.0}  # share of the runs with a hog that must change nothing; with one above the boards
HOLD = 0.3  # share of the runs in which a stopped neighbour stops an arm


def fault(kind, at_s, until_s=None, arm=0, value=None):
    lines = ["[[fault]]", f'kind = "{kind}"', f"at_s = {at_s:.9f}"]
    if until_s is not None:
        lines.append(f"until_s = {until_s:.9f}")
    if arm:
        lines.append(f"arm = {arm}")
    if value is not None:
        lines.append(f"value = {value}")
    return "\n".join(lines) + "\n"


def draw(where, seed, run):
    """(policy, scenario, number of kills and stops) of a run."""
    rng = random.Random(f"{seed}/{run}")
    hog = HOG[where]
    policy = "hold" if rng.random() < HOLD else "carry_on"
    end = rng.choices(("none", "hog", "leader"), weights=(1 - hog - LEADER_DIES, hog, LEADER_DIES))[0]
    victims = rng.sample(ARMS, len(ARMS) if end == "none" else 5)  # some are left to see the end
    quiet_hog_after = rng.choice(victims) if rng.random() < hog else None
    faults, count, t_s, end_s = [], 0, SETTLED_S, 0.0
    for arm in victims:
        t_s += rng.uniform(*GAP_S)
        if rng.random() < BUS_DOWN[where]:
            faults.append(fault("bus_down", t_s, arm=arm))
        else:
            _, kind, lengths = rng.choices(KINDS, weights=[kind[0] for kind in KINDS])[0]
            until_s = t_s + rng.uniform(*lengths) if lengths else None
            end_s = max(end_s, until_s or 0.0)
            faults.append(fault(kind, t_s, until_s, arm))
            count += 1
        if arm == quiet_hog_after:
            begin_s = t_s + rng.uniform(0.0, 0.2)
            faults.append(fault("cpu_hog", begin_s, begin_s + rng.uniform(0.05, 0.4), value=0))
    t_s += rng.uniform(*GAP_S)
    if end == "hog":
        end_s = max(end_s, t_s + rng.uniform(0.005, 0.2))
        faults.append(fault("cpu_hog", t_s, end_s, value=HOG_PRIORITY))
    elif end == "leader":
        faults.append(fault("leader_dies", t_s))
    seconds = max(t_s, end_s) + 0.3
    head = f"""# ./run campaign {"--guests " if where == "guests" else ""}--seed {seed} --only {run}

name = "campaign_{run}"
base = "../hil/scenarios/benign.toml"
seconds = {seconds:.3f}
window_start_s = {SETTLED_S}

"""
    return policy, head + "\n".join(faults), count


def main(where, seed, phases, folder, run=None):
    planned = 0
    for number in itertools.count() if run is None else [run]:
        if planned >= phases:
            break
        policy, scenario, count = draw(where, seed, number)
        (folder / f"{number:04d}_{policy}.toml").write_text(scenario)
        planned += count


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]), pathlib.Path(sys.argv[4]), *map(int, sys.argv[5:]))
