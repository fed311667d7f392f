"""Judges runs of the campaigns of processes. It knows the boards' messages and the drives' frames, and no code of the
boards.

usage: judge.py judge DIR        the run in DIR, or each in it: complaints, figures; a run without complaints is removed
       judge.py sum DIR SEED     one line of figures over all that was judged in DIR

Witnesses: in guests candump of can-utils, at the drives' end of each bus, in stepped time the emulation's log; the log of
LCM for what the boards say; hil.json for when a drive's power went off, which no frame tells in time.
"""

import bisect
import collections
import json
import math
import pathlib
import re
import shutil
import struct
import sys
import tomllib

WATCHDOG_S = 0.030  # of the drives: no frame for so long, and they take their power away
RESOLUTION_S = 0.0001  # of two clocks that are read one after the other, and of candump's stamps
DRIVE_STOP_S = 0.030
HOLD_S = 0.110
ERROR_M = 0.020
FOLLOWS_S = 0.6  # from then on a fleet that has started near the leader follows it
NOTICED_S = 0.120  # a silence of that length is noticed by all
UNNOTICED_S = 0.055  # and one of that length by none
LATE_S = 0.002  # a fault that was made later is another one
TORQUES_AFTER_S = 0.110  # a heartbeat and a tick: by then a board that was stopped knows that its drives are off
PERIOD_S = 0.010

# ODrive CAN Simple: node << 5 | command.
HEARTBEAT, AXIS_STATE, ESTIMATES, INPUT_TORQUE, CLEAR_ERRORS, VERSION = 0x01, 0x07, 0x09, 0x0E, 0x18, 0x00
FROM_DRIVES = (HEARTBEAT, ESTIMATES, VERSION)  # unless they are remote frames, by which a board asks
CLOSED_LOOP = 8
RUN, DEGRADED, HOLD = 3, 4, 5  # armada::ControllerState; what is worse has higher numbers

FIGURES = ("drive_stop_ms", "torque_stop_ms", "torques_after_ms", "hold_ms", "hold_behind_ms", "error_mm")  # worst of each, with its run
FLEET = pathlib.Path(__file__).parents[2] / "firmware/fleets/paper.toml"
Tick = collections.namedtuple("Tick", "t_s state x_m heap")


class Fleet:
    def __init__(self):
        fleet = tomllib.loads(FLEET.read_text())
        self.arms = {arm["id"]: arm for arm in fleet["arm"]}
        (graph,) = fleet["graph"]
        self.hears = {arm: set() for arm in self.arms}  # 0: the leader
        for pin in graph["pins"]:
            self.hears[pin].add(0)
        for edge in graph["edges"]:
            self.hears[edge["to"]].add(edge["from"])

    def nodes(self, arm):
        return range(1, len(self.arms[arm]["link"]) + 1)

    def informed(self, living):
        """Arms to which there is a path from the leader over the living."""
        reached = {0} & living
        while True:
            more = {arm for arm in living - reached if self.hears.get(arm, set()) & reached}
            if not more:
                return reached
            reached |= more

    def downstream(self, arm):
        """Arms that hear it, also over others, and over how many."""
        hops, found = {arm: 0}, [arm]
        for one in found:
            for other in self.arms:
                if one in self.hears[other] and other not in hops:
                    hops[other] = hops[one] + 1
                    found.append(other)
        return {other: n for other, n in hops.items() if n}


class Bus:
    """What came to an arm's drives: times of the frames to each node, and of its torques."""

    LINE = re.compile(r"\((\d+)\.(\d{6})\) (?:drives|can)(\d+) ([0-9A-F]{3})#(R\d?|[0-9A-F]*)\s*$")

    def __init__(self):
        self.to_node = collections.defaultdict(list)
        self.torques = collections.defaultdict(list)
        self.arming = []  # frames by which a drive could come on again


def read_buses(paths, epoch_ns, fleet, complain):
    buses = {arm: Bus() for arm in fleet.arms}
    for path in paths:
        for line in path.read_text(encoding="ascii").splitlines():
            match = Bus.LINE.match(line)
            if not match:
                complain(f"a line of {path.name} is none: {line!r}")
                continue
            t_s = (int(match[1]) * 10**9 + int(match[2]) * 1000 - epoch_ns) * 1e-9
            arm, can_id, data = int(match[3]), int(match[4], 16), match[5]
            node, command = can_id >> 5, can_id & 0x1F
            if command in FROM_DRIVES and not data.startswith("R"):
                continue
            bus = buses[arm]
            bus.to_node[node].append(t_s)
            if command == INPUT_TORQUE:
                bus.torques[node].append(t_s)
                (torque_Nm,) = struct.unpack("<f", bytes.fromhex(data)[:4])
                limit_Nm = fleet.arms[arm]["torque_limit_Nm"]
                if not math.isfinite(torque_Nm) or abs(torque_Nm) > limit_Nm * (1 + 1e-6):
                    complain(f"arm {arm} joint {node}: torque {torque_Nm:g} N m at {t_s:.6f} s, limit {limit_Nm:g}")
            elif command == CLEAR_ERRORS or command == AXIS_STATE and bytes.fromhex(data)[0] == CLOSED_LOOP:
                bus.arming.append(t_s)
    return buses


def read_telemetry(path, epoch_ns):
    """By arm, the ticks that it told."""
    ticks = collections.defaultdict(list)
    log = path.read_bytes()
    at = 0
    while at + 28 <= len(log):
        _, _, _, channel_size, size = struct.unpack_from(">IqqII", log, at)
        channel = log[at + 28 : at + 28 + channel_size]
        message = at + 28 + channel_size
        at = message + size
        if at > len(log) or not channel.startswith(b"TEL_"):
            continue
        stamp_ns, _, arm = struct.unpack_from(">qqb", log, message + 8)
        state = log[message + 28]
        x_m = struct.unpack_from(">2d", log, message + 31 + 3 * 56)
        (heap,) = struct.unpack_from(">q", log, message + 31 + 3 * 56 + 24 + 3 * 8 + 56 + 280 + 5 * 4)
        ticks[arm].append(Tick((stamp_ns - epoch_ns) * 1e-9, state, x_m, heap))
    return ticks


def leader_m(t_s):
    """x_0 of the paper."""
    return 1.2 + 0.5 * math.sin(math.pi * t_s), 1.3 + 0.3 * math.cos(math.pi * t_s)


def take_worst(worst, figures):
    for name, figure in figures.items():
        worst[name] = max(worst.get(name, figure), figure)


class Silence:
    """When somebody, an arm or the leader (0), says nothing."""

    def __init__(self, who, from_s, until_s):
        self.who, self.from_s, self.until_s = who, from_s, until_s

    def noticed(self):
        return self.until_s - self.from_s >= NOTICED_S


class Judge:
    def __init__(self, run, fleet):
        self.run, self.fleet = run, fleet
        self.complaints = []
        self.plan = tomllib.loads((run / "plan.toml").read_text())
        self.policy = run.name.split("_", 1)[1]
        self.faults = self.plan["fault"]
        self.counts = collections.Counter()
        self.worst = {}

    def complain(self, text):
        self.complaints.append(text)

    def judge(self):
        try:
            metrics = json.loads((self.run / "metrics.json").read_text())
            hil = json.loads((self.run / "hil.json").read_text())
        except (OSError, ValueError) as error:
            said = (self.run / "output.txt").read_text(errors="replace")[-1500:]
            return self.complain(f"the run did not come to its end: {error}\n{said}")
        self.end_s = self.plan["seconds"]
        logs = [*self.run.glob("candump.log")] or sorted(self.run.glob("can_*.log"))
        self.buses = read_buses(logs, hil["epoch_wall_ns"], self.fleet, self.complain)
        self.ticks = read_telemetry(self.run / "lcm.log", hil["epoch_ns"])
        self.powers = {arm["id"]: arm["drives"] for arm in hil["arms"]}
        self.made(metrics.get("process_faults", []))
        self.allocations(metrics, hil)
        self.no_arming()
        self.drives()
        self.dead()
        self.others()

    def made(self, made):
        """Every fault was made, at its time; `process_faults` is what was. Its end may be late beside another fault."""
        times = {(one["to"], one["what"]): one["made_s"] for one in made}
        for fault in self.faults:
            self.counts[self.name_of(fault)] += 1
            kind, arm = fault["kind"], fault.get("arm", 0)
            what = {"controller_stops": "stopped", "bus_down": "down", "cpu_hog": None}.get(kind, "killed")
            who = f"vcan{arm}" if kind == "bus_down" else f"arm {arm}" if arm else "leader"
            if what and abs(times.get((who, what), math.inf) - fault["at_s"]) > LATE_S:
                self.complain(f"{who} {what} at {times.get((who, what))} s in place of {fault['at_s']} s")
            if "until_s" in fault and arm:
                fault["until_s"] = times.get((who, "continued"), times.get((who, "started"), math.inf))

    @staticmethod
    def name_of(fault):
        kind = fault["kind"]
        if kind == "cpu_hog":
            return "FIFO hogs" if fault["value"] else "hogs"
        if kind == "controller_stops":
            return "stopped and continued" if "until_s" in fault else "stopped"
        return {"controller_dies": "killed", "controller_restarts": "restarted", "bus_down": "links down",
                "leader_dies": "leaders killed"}[kind]

    def allocations(self, metrics, hil):
        for process in [*metrics["arms"], hil]:
            if process.get("memory", {}).get("heap_allocations"):
                self.complain(f"{process.get('name', process.get('id'))}: allocates memory in its loop")
        for arm, ticks in self.ticks.items():
            if any(tick.heap > 0 for tick in ticks):
                self.complain(f"arm {arm}: allocates memory in its loop")

    def no_arming(self):
        for arm, bus in self.buses.items():
            for t_s in bus.arming:
                if t_s > 0:
                    self.complain(f"arm {arm}: a drive is told at {t_s:.6f} s to come on")

    def drives(self):
        """A drive that hears nothing has no power 30 ms later, and never again."""
        for arm, bus in self.buses.items():
            for node, power in zip(self.fleet.nodes(arm), self.powers[arm]):
                where = f"arm {arm} joint {node}"
                if power["on_s"] is None or power["on_s"] > 0:
                    self.complain(f"{where}: its power came on at {power['on_s']} s")
                    continue
                heard = bus.to_node[node]
                first = bisect.bisect_left(heard, 0.0)
                ends = [*heard[first + 1 :], self.end_s]
                last = next((t for t, after in zip(heard[first:], ends) if after - t > WATCHDOG_S + RESOLUTION_S), None)
                if last is None:
                    continue
                off_s = math.inf if power["off_s"] is None else power["off_s"]
                stop_s = off_s - last
                if stop_s > DRIVE_STOP_S + RESOLUTION_S:
                    self.complain(f"{where}: {1e3 * stop_s:.3f} ms from the last frame, at {last:.6f} s, to the drive's stop")
                if stop_s > 0:
                    torque_s = bus.torques[node][bisect.bisect_right(bus.torques[node], off_s) - 1]
                    self.figure("drive_stop_ms", 1e3 * stop_s)
                    self.figure("torque_stop_ms", 1e3 * (off_s - torque_s))

    def figure(self, name, value):
        take_worst(self.worst, {name: [value, self.run.name]})

    def dead(self):
        """Who is dead or cut off says nothing; who goes on when its drives have stopped gives up soon."""
        for fault in self.faults:
            arm, kind = fault.get("arm", 0), fault["kind"]
            if not arm:
                continue
            bus = self.buses[arm]
            silent = kind in ("controller_dies", "bus_down") or kind == "controller_stops" and "until_s" not in fault
            frames = bus.to_node if silent else bus.torques if kind == "controller_restarts" else {}
            for node, times in frames.items():
                if times[-1] > fault["at_s"] + LATE_S:
                    self.complain(f"arm {arm} joint {node}: a frame at {times[-1]:.6f} s, {kind} was at {fault['at_s']:.6f} s")
            if kind == "controller_stops" and "until_s" in fault and fault["until_s"] - fault["at_s"] > WATCHDOG_S:
                after_s = max(times[-1] for times in bus.torques.values()) - fault["until_s"]
                self.figure("torques_after_ms", 1e3 * after_s)
                if after_s > TORQUES_AFTER_S and self.stopped(arm):
                    self.complain(f"arm {arm}: torques for {1e3 * after_s:.0f} ms after it went on, to drives that had stopped")

    def stopped(self, arm):
        return any(power["off_s"] is not None and power["off_s"] > power["on_s"] for power in self.powers[arm])

    def others(self):
        hog_s = min((f["at_s"] for f in self.faults if f["kind"] == "cpu_hog" and f["value"]), default=math.inf)
        silences, disturbed, stops = [], {}, []
        for fault in self.faults:
            kind, who, at_s = fault["kind"], fault.get("arm", 0), fault["at_s"]
            if kind == "cpu_hog":
                continue
            disturbed[who] = at_s
            until_s = math.inf if kind in ("controller_dies", "leader_dies") else fault.get("until_s", math.inf)
            silence = Silence(who, at_s, until_s)
            if kind != "bus_down" and until_s - at_s > UNNOTICED_S:
                silences.append(silence)
            if who and (kind == "bus_down" or silence.noticed()):
                stops.append((at_s, who))
        everyone = {0, *self.fleet.arms}

        def surely_living(t_s):
            return everyone - {s.who for s in silences if s.from_s <= t_s}

        def perhaps_living(t_s):
            return everyone - {s.who for s in silences if s.from_s <= t_s < s.until_s}

        moments = sorted({t for s in silences for t in (s.from_s, s.until_s) if t < self.end_s})
        for arm, ticks in self.ticks.items():
            if not ticks or ticks[0].t_s > 0.1:
                self.complain(f"arm {arm} was not heard from the start")
            alone_s = next((t for t in moments if arm not in self.fleet.informed(surely_living(t) | {arm})), math.inf)
            until_s = min(alone_s, hog_s, disturbed.get(arm, math.inf), self.end_s)
            if self.policy == "hold":
                until_s = min([until_s, *(t for who, t in disturbed.items() if arm in self.fleet.downstream(who))])
            self.follows(arm, ticks, until_s)
            # Alone without a doubt: over all of the time that it has to notice.
            for at_s in moments:
                window = [at_s, *(t for t in moments if at_s < t < at_s + HOLD_S)]
                if any(arm in self.fleet.informed(perhaps_living(t) | {arm}) for t in window):
                    continue
                who = next((s.who for s in silences if s.from_s == at_s), None)
                if who is not None:
                    self.holds(arm, ticks, at_s, self.fleet.downstream(who).get(arm, 1), disturbed, hog_s, silences)
                break
            if self.policy == "hold":
                for at_s, who in stops:
                    hops = self.fleet.downstream(who).get(arm)
                    if hops:
                        self.holds(arm, ticks, at_s, hops, disturbed, hog_s, silences)

    def follows(self, arm, ticks, until_s):
        """Until then the arm has nothing to stop for."""
        for tick in ticks:
            if not FOLLOWS_S <= tick.t_s < until_s:
                continue
            error_m = math.dist(tick.x_m, leader_m(tick.t_s))
            self.figure("error_mm", 1e3 * error_m)
            if tick.state not in (RUN, DEGRADED) or error_m > ERROR_M:
                return self.complain(f"arm {arm}: at {tick.t_s:.3f} s in state {tick.state}, {1e3 * error_m:.1f} mm from the "
                                     f"leader, with nothing to stop for until {until_s:.3f} s")
        last = max((tick.t_s for tick in ticks if tick.t_s < until_s), default=-math.inf)
        if last < until_s - 4 * PERIOD_S:
            self.complain(f"arm {arm} is not heard after {last:.3f} s")

    def holds(self, arm, ticks, at_s, hops, disturbed, hog_s, silences):
        """What makes the arm hold came at that time, so many hops away."""
        by_s = at_s + HOLD_S
        undisturbed = not at_s - NOTICED_S < disturbed.get(arm, -math.inf) < by_s
        silent = any(s.who == arm and s.from_s < by_s and s.until_s > at_s - NOTICED_S for s in silences)
        if silent or not undisturbed or by_s > min(hog_s, self.end_s):
            return
        since = [tick for tick in ticks if tick.t_s > at_s]
        following = [tick for tick in since if tick.state in (RUN, DEGRADED)]
        if not since or any(tick.t_s > by_s for tick in following):
            return self.complain(f"arm {arm}: follows {1e3 * HOLD_S:.0f} ms after {at_s:.6f} s, when it should hold")
        if following:
            first = next((tick.t_s for tick in since if tick.t_s > following[-1].t_s), math.inf)
            self.figure("hold_ms" if hops == 1 else "hold_behind_ms", 1e3 * (first - at_s))
            self.counts["holds"] += 1
            if first > by_s:
                self.complain(f"arm {arm}: holds {1e3 * (first - at_s):.1f} ms after {at_s:.6f} s")


def judge_all(folder):
    fleet = Fleet()
    one = (folder / "plan.toml").exists()
    runs = [folder] if one else sorted(path.parent for path in folder.glob("*/plan.toml"))
    counts, worst, bad = collections.Counter(), {}, 0
    for run in runs:
        judge = Judge(run, fleet)
        judge.judge()
        counts += judge.counts
        take_worst(worst, judge.worst)
        if judge.complaints:
            bad += 1
            for complaint in judge.complaints[:10]:
                print(f"run {run.name}: {complaint}", file=sys.stderr)
            again = (run / "plan.toml").read_text().splitlines()[0].removeprefix("# ")
            print(f"  its files are in {run}; again: {again}", file=sys.stderr)
        else:
            shutil.rmtree(run)
    figures = folder.with_name(f"{folder.name}_figures.json") if one else folder / "figures.json"
    figures.write_text(json.dumps({"runs": len(runs), "counts": counts, "worst": worst}))
    return 1 if bad or not runs else 0


def sum_up(folder, seed):
    runs, counts, worst = 0, collections.Counter(), {}
    for path in [*folder.glob("*/figures.json"), *folder.glob("*_figures.json")]:
        figures = json.loads(path.read_text())
        runs += figures["runs"]
        counts += collections.Counter(figures["counts"])
        take_worst(worst, figures["worst"])
    ms = {name: f"{worst[name][0]:.2f}" if name in worst else "-" for name in FIGURES}
    holds = counts.pop("holds", 0)
    boards = sum(counts[kind] for kind in ("killed", "stopped", "stopped and continued", "restarted"))
    kinds = ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items()))
    figures = {"seed": int(seed), "runs": runs, "counts": counts, "worst": worst}
    (folder / "figures.json").write_text(json.dumps(figures, indent=2) + "\n")
    print(f"{boards} kills and stops in {runs} fleets ({kinds}); drives stop at most {ms['drive_stop_ms']} ms after the "
          f"last frame, {ms['torque_stop_ms']} ms after the last torque; {holds} arms hold within {ms['hold_ms']} ms, "
          f"behind another arm {ms['hold_behind_ms']} ms, the rest stays within {ms['error_mm']} mm; seed {seed}")
    return 0


if __name__ == "__main__":
    if sys.argv[1] == "judge":
        sys.exit(judge_all(pathlib.Path(sys.argv[2])))
    sys.exit(sum_up(pathlib.Path(sys.argv[2]), sys.argv[3]))
