"""What spoils a run: busy loops beside it, and rights that a container does not give."""

import contextlib
import os
import subprocess

# Words before a command that take its right to real-time priorities and locked memory.
NO_RIGHTS = ["prlimit", "--rtprio=0:0", "--memlock=65536:65536"]
if os.geteuid() == 0:
    NO_RIGHTS += ["setpriv", "--bounding-set=-sys_nice,-ipc_lock", "--inh-caps=-sys_nice,-ipc_lock"]


@contextlib.contextmanager
def busy_loops(count):
    loop = ["setpriv", "--pdeathsig", "KILL", "sh", "-c", "while :; do :; done"]  # none outlives a killed measurement
    loops = [subprocess.Popen(loop) for _ in range(count)]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()
