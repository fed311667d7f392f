"""python-can's viewer on the user-space bus of an emulated arm: its screen shows the drives' frames.

usage: python_can_viewer_test.py ARMADA_HIL SCENARIO    in a network of its own, with a multicast route
"""

import fcntl
import os
import pty
import select
import signal
import struct
import subprocess
import sys
import termios
import time

GROUP = "239.74.163.11"  # of arm 1 in firmware/fleets/paper.toml
# Identifiers of the heartbeats of nodes 1 and 2, as the viewer prints them.
WANTED = (b"0x021", b"0x041")
PATIENCE_S = 60.0


def start_viewer():
    child, screen = pty.fork()
    if child == 0:
        os.environ["TERM"] = "xterm"
        os.execv(sys.executable, [sys.executable, "-m", "can.viewer", "-i", "udp_multicast", "-c", GROUP])
    fcntl.ioctl(screen, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 120, 0, 0))
    return child, screen


def main():
    hil = subprocess.Popen([sys.argv[1], sys.argv[2], "--seconds", "600"], stdout=subprocess.DEVNULL)
    child, screen = start_viewer()
    shown = b""
    end = time.monotonic() + PATIENCE_S
    try:
        while not all(text in shown for text in WANTED):
            if time.monotonic() > end:
                sys.exit(f"the viewer shows no {WANTED} but: {shown!r}")
            if select.select([screen], [], [], 1.0)[0]:
                try:
                    shown += os.read(screen, 65536)
                except OSError:  # the viewer has ended
                    sys.exit(f"the viewer ended, and said: {shown!r}")
    finally:
        hil.terminate()
        hil.wait()
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    print("the viewer shows", *(text.decode() for text in WANTED))


if __name__ == "__main__":
    main()
