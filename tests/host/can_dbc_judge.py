"""Decodes frames with a DBC file as canmatrix (Debian: python3-canmatrix) reads it.

usage: can_dbc_judge.py FILE.dbc < frames
In: identifier (hex), "x" extended or "-", "f" CAN FD or "-", data (hex or "-"); out: a line with the frame's
name in the file, whether it is FD, and every signal that it has, `name=value`."""

import sys

import canmatrix.formats

matrix = canmatrix.formats.loadp_flat(sys.argv[1])
print("loaded %d" % len(matrix.frames))
for line in sys.stdin:
    identifier, extended, _, data = line.split()
    frame = matrix.frame_by_id(canmatrix.ArbitrationId(int(identifier, 16), extended == "x"))
    if frame is None:
        print("none")
        continue
    payload = bytes.fromhex("" if data == "-" else data).ljust(frame.size, b"\0")[: frame.size]
    signals = frame.decode(payload) if frame.signals else {}
    words = [frame.name, "f" if frame.is_fd else "-"]
    words += ["%s=%s" % (name, repr(float(signal.phys_value))) for name, signal in signals.items()]
    print(" ".join(words))
