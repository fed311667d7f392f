"""Judges a capture of CiA 402 drives and their master: tshark dissects it, the rules of CiA 301 and 402 stand here.
usage: cia402_tshark_judge.py CAPTURE NODE...; says what is wrong, exit code 1."""
import subprocess
import sys

capture, nodes = sys.argv[1], [int(n) for n in sys.argv[2:]]
FIELDS = ["frame.number", "frame.protocols", "can.id", "can.len", "_ws.malformed", "_ws.expert.severity", "_ws.col.Info",
          "canopen.sdo.main_idx", "canopen.sdo.sub_idx", "canopen.sdo.data.bytes", "canopen.sdo.abort_code",
          "canopen.em.err_code", "canopen.pdo.data.bytes", "canopen.nmt_ctrl.node_id"]
command = ["tshark", "-r", capture, "-d", "can.subdissector,canopen", "-T", "fields", "-E", "occurrence=f"]
for field in FIELDS:
    command += ["-e", field]
text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
frames = [dict(zip(FIELDS, line.split("\t"))) for line in text.splitlines()]
errors = []


def check(condition, frame, what):
    if not condition:
        errors.append(f"frame {frame['frame.number'] if frame else '-'}: {what}")


def raw(frame, field):
    return bytes.fromhex(frame[field].replace(":", ""))


def number(data):
    return int.from_bytes(data, "little")


def state_of(statusword):
    short = {0x00: "not ready", 0x40: "disabled", 0x0F: "reaction", 0x08: "fault"}
    full = {0x21: "ready", 0x23: "on", 0x27: "enabled", 0x07: "quick stop"}
    return short.get(statusword & 0x4F) or full.get(statusword & 0x6F)


# CiA 402-2: command of a controlword, and where it leads.
def commands(word):
    if word & 0x80:
        return ["reset"]
    if not word & 0x02:
        return ["voltage off"]
    if not word & 0x04:
        return ["quick stop"]
    if not word & 0x01:
        return ["shutdown"]
    return ["switch on", "enable"] if word & 0x08 else ["switch on"]


EDGES = {("disabled", "shutdown"): "ready", ("ready", "switch on"): "on", ("on", "enable"): "enabled",
         ("ready", "voltage off"): "disabled", ("ready", "quick stop"): "disabled", ("on", "shutdown"): "ready",
         ("on", "voltage off"): "disabled", ("on", "quick stop"): "disabled", ("enabled", "shutdown"): "ready",
         ("enabled", "voltage off"): "disabled", ("enabled", "quick stop"): "quick stop",
         ("quick stop", "voltage off"): "disabled", ("fault", "reset"): "disabled"}


def by_itself(states, failed):
    if "quick stop" in states:
        states = states | {"disabled"}
    if failed:
        states = states | {"reaction", "fault"}
    return states | {"fault"} if "reaction" in states else states


check(len(frames) > 0, None, "nothing was captured")
for frame in frames:
    # A frame without data has no protocol layer of its own, but is named.
    known = frame["frame.protocols"] == "can:canopen" or (frame["can.len"], frame["_ws.col.Info"]) == ("0", "SYNC")
    check(known, frame, "not CANopen: " + frame["frame.protocols"])
    check(not frame["_ws.malformed"] and not frame["_ws.expert.severity"], frame, "malformed")
info = [frame["_ws.col.Info"] for frame in frames]
check(info.count("SYNC") > 100, None, "SYNCs are missing")
check(any(i.startswith("NMT Error Control: Operational [0x7f]") for i in info), None, "the master has no heartbeat")

for node in nodes:
    tag = f"[{node:#x}]"
    for service in ("NMT: Reset communication", "NMT Error Control: Boot-up", "NMT: Enter pre-operational state",
                    "NMT: Start remote node", "NMT Error Control: Pre-operational", "NMT Error Control: Operational"):
        check(f"{service} {tag}" in info, None, f"node {node}: no '{service}'")
    first = [info.index(f"{s} {tag}") for s in ("NMT Error Control: Boot-up", "NMT: Enter pre-operational state",
                                                "NMT: Start remote node", "NMT Error Control: Operational")]
    check(first == sorted(first), None, f"node {node}: NMT services out of order")

    asked = None        # SDO that waits for its answer
    written, read = {}, set()
    exists = {0x1400: True, 0x1800: True, 0x1801: True}
    state, edge_words, failed, last_word, seen, emergencies = None, [], False, 0, [], []
    for frame in frames:
        cob = int(frame["can.id"])
        if cob & 0x7F != node and not (cob == 0 and frame["canopen.nmt_ctrl.node_id"]):
            continue
        function = cob & 0x780
        what = frame["_ws.col.Info"]
        if cob == 0:
            if "Reset communication" in what and tag in what:
                exists, state = dict.fromkeys(exists, True), None
                failed = bool(emergencies) and emergencies[-1] != 0
        elif function == 0x600:
            check("Initiate" in what and "request" in what, frame, what)
            check(asked is None, frame, "a request before the answer to the last one")
            entry = (int(frame["canopen.sdo.main_idx"], 0), int(frame["canopen.sdo.sub_idx"], 0))
            asked = (entry, what, raw(frame, "canopen.sdo.data.bytes") if "download" in what else b"")
            index, sub = entry
            if "download" in what:
                if index in exists and sub == 1:
                    exists[index] = not number(asked[2]) & 0x80000000
                if index - 0x200 in exists:
                    check(not exists[index - 0x200], frame, "mapping written while the PDO exists")
        elif function == 0x580:
            entry = (int(frame["canopen.sdo.main_idx"], 0), int(frame["canopen.sdo.sub_idx"], 0))
            check(asked is not None and asked[0] == entry, frame, "an answer that nobody asked for")
            if "Abort" in what:
                check(entry in ((0x1802, 1), (0x1803, 1)) and int(frame["canopen.sdo.abort_code"], 0) == 0x06020000,
                      frame, f"abort {frame['canopen.sdo.abort_code']} of {entry[0]:X}:{entry[1]:X}")
            elif "download" in what:
                written[entry] = number(asked[2])
            else:
                value = number(raw(frame, "canopen.sdo.data.bytes"))
                ids = 0x800007FF if entry[1] == 1 and entry[0] in exists else 0xFFFFFFFF
                wanted = written.get(entry, value)
                check(value & ids == wanted & ids, frame, f"written {wanted:#x}, read {value:#x}")
                read.add(entry)
            asked = None
        elif function == 0x080:
            emergencies.append(int(frame["canopen.em.err_code"], 0))
            failed = emergencies[-1] != 0
        elif function == 0x200:
            data = raw(frame, "canopen.pdo.data.bytes")
            check(len(data) == 5, frame, "RPDO 1 is not 5 bytes long")
            word, torque, mode = number(data[:2]), number(data[2:4]), data[4]
            check(not word & 0xFF70, frame, f"controlword {word:#06x} has bits beside commands (halt, mode)")
            check(mode == 10, frame, f"mode {mode}")
            check(torque == 0 or state == "enabled", frame, f"torque in state {state}")
            check(not word & 0x80 or state == "fault", frame, f"fault reset in state {state}")
            check(word != 0x0F or state in ("on", "enabled"), frame, f"enable in state {state}")
            edge_words.append((word, last_word))
            last_word = word
        elif function == 0x180:
            data = raw(frame, "canopen.pdo.data.bytes")
            check(len(data) == 5, frame, "TPDO 1 is not 5 bytes long")
            new = state_of(number(data[:2]))
            check(new is not None, frame, f"statusword {number(data[:2]):#06x} is of no state")
            possible = by_itself({state} if state else {"disabled", "fault"}, failed)
            for word, before in edge_words:
                for order in commands(word):
                    if order == "reset" and before & 0x80:
                        continue
                    possible = by_itself({EDGES.get((s, order), s) for s in possible}, failed)
            check(new in possible, frame, f"{state} -> {new} by {[hex(w) for w, _ in edge_words]}")
            if new != state:
                seen.append(new)
            state, edge_words = new, []
            check(new != "enabled" or data[4] == 10, frame, f"enabled in mode {data[4]}")
        elif function == 0x280:
            check(len(raw(frame, "canopen.pdo.data.bytes")) == 8, frame, "TPDO 2 is not 8 bytes long")

    up = ["disabled", "ready", "on", "enabled"]
    wanted = up + ["fault", "fault"] + up
    check(seen[:len(wanted)] == wanted and seen[-1] == "disabled", None, f"node {node}: states {seen}")
    check(emergencies == [0x8250, 0], None, f"node {node}: emergencies {emergencies}")
    check(node == nodes[0] or "quick stop" in seen, None, f"node {node}: the moving joint shows no quick stop")
    check(set(written) == read & set(written), None, f"node {node}: not read back: {set(written) - read}")
    check(written.get((0x1400, 5)) == 30 and written.get((0x6060, 0)) == 10, None, f"node {node}: configuration")

print("\n".join(errors[:20]))
sys.exit(1 if errors else 0)
