"""`armada spy` shows a fleet that runs: a real run, lcm-spy in a virtual display, judges of what is on it.

The titles of the windows, as X has them, say which channel a double click opened. tesseract reads what the
windows show: every channel with its type, and in a channel's window the fields of its message.

usage: spy_test.py BIN_DIR SOURCE_DIR [PNG], in a network of its own; keeps the screenshot as PNG
"""

import contextlib
import difflib
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import zipfile

URL = "udpm://239.255.76.67:7702?ttl=0"  # not the default: the url must reach lcm-spy
PATIENCE_S = 90
OPENED = {"LEADER": "leader_t", "EST_3": "estimate_t", "TEL_6": "telemetry_t"}
CHANNELS = sorted(["LEADER", *(f"{kind}_{arm}" for kind in ("EST", "TEL") for arm in range(1, 8))])
TYPES = {"LEADER": "leader", "EST": "estimate", "TEL": "telemetry"}


def wait_for(what, attempt, patience_s=PATIENCE_S):
    """What `attempt` returns once that is something."""
    deadline = time.monotonic() + patience_s
    while not (result := attempt()):
        assert time.monotonic() < deadline, f"not within {patience_s} s: {what}"
        time.sleep(0.1)
    return result


def output_of(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=PATIENCE_S)


@contextlib.contextmanager
def running(*command, stop=signal.SIGTERM, **options):
    with subprocess.Popen([str(word) for word in command], **options) as process:
        try:
            yield process
        finally:
            process.send_signal(stop)


@contextlib.contextmanager
def virtual_display():
    """Of a free number, which the server itself chooses and reports when it is up."""
    reading, writing = os.pipe()
    with running("Xvfb", "-displayfd", writing, "-screen", "0", "1440x1150x24", "-nolisten", "tcp",
                 pass_fds=[writing], stderr=subprocess.DEVNULL):
        os.close(writing)
        with os.fdopen(reading) as number:
            os.environ["DISPLAY"] = ":" + number.readline().strip()
        yield


def window(title):
    """X's number of the visible window of this very title."""
    found = output_of("xdotool", "search", "--onlyvisible", "--name", f"^{title}$").stdout.split()
    return found[0] if found else None


def read_text(number, folder, *filters):
    """Lines of a window as (text, y of its middle)."""
    image, scale = folder / "window.png", 3
    output_of("import", "-window", number, image)
    output_of("convert", image, "-colorspace", "gray", *filters, "-resize", f"{scale * 100}%", image)
    lines = {}
    for row in output_of("tesseract", image, "-", "--psm", "6", "tsv").stdout.splitlines()[1:]:
        _, _, block, paragraph, line, _, _, top, _, height, _, word = row.split("\t", 11)
        if word.strip():
            middle = (int(top) + int(height) / 2) / scale
            lines.setdefault((block, paragraph, line), ([], middle))[0].append(word)
    read = [(" ".join(words), middle) for words, middle in lines.values()]
    (folder / "read.txt").write_text("\n".join(text for text, _ in read))
    return read


def squeezed(text):
    """Letters and digits alone: underscores, dots and gaps are what a reader of pixels confuses."""
    return re.sub("[^A-Za-z0-9]", "", text)


def rows_of_channels(number, folder):
    """Row of each channel in the main window, once all of them show there with their types."""
    # The lines of the table look like letters: only what is dark is kept.
    lines = read_text(number, folder, "-threshold", "45%", "-filter", "triangle")
    rows = [(text, middle) for text, middle in lines if re.match("EST|LEADER|TEL", text)]
    kinds = [re.match("EST|LEADER|TEL", text)[0] for text, _ in rows]
    typed = all(TYPES[kind] in text for kind, (text, _) in zip(kinds, rows))
    if not typed or kinds != [channel.split("_")[0] for channel in CHANNELS]:
        return None
    return {channel: middle for channel, (_, middle) in zip(CHANNELS, rows)}


def field_names(source, message):
    text = re.sub("//.*", "", (source / f"lcmtypes/{message}.lcm").read_text())
    return re.findall(r"^ +\w+ +(\w+)", text, re.MULTILINE)


def put_aside(opened):
    """Moves windows away from the table, or they would be in the way of the next double click. A window that has just
    opened may still put itself back."""
    def attempt():
        for place, number in enumerate(opened.values()):
            output_of("xdotool", "windowmove", "--sync", number, 800, 380 * place)
        time.sleep(0.5)
        return all("Position: 800," in output_of("xdotool", "getwindowgeometry", number).stdout
                   for number in opened.values())
    wait_for("windows aside", attempt)


def open_channel(channel, main, y, opened):
    """Double-clicks the channel's row until a window of its name opens."""
    def attempt():
        put_aside(opened)
        output_of("xdotool", "mousemove", "--window", main, 40, round(y),
                  "click", "--repeat", 2, "--delay", 80, 1)
        with contextlib.suppress(AssertionError):
            return wait_for("the window", lambda: window(channel), patience_s=10)
    return wait_for(f"a window of {channel}", attempt)


def names_field(line, name):
    """Whether a line of a channel's window, "long stamp_ns 123", is that field's; a letter may be misread."""
    shown = squeezed(line.partition(" ")[2])[:len(name) + 1]
    return difflib.SequenceMatcher(None, name, shown).ratio() > 0.75


def check_decoded(channel, number, source, folder):
    """The first fields of the message show; the arm has its number, and the sequence counts."""
    missing = {squeezed(name) for name in field_names(source, OPENED[channel])[:8]}
    assert "sequence" in missing, missing
    arm = re.search(r"\d|$", channel)[0]
    sequences = []

    def attempt():
        lines = [line for line, _ in read_text(number, folder)]
        sequences.extend(int(digits) for line in lines for digits in re.findall(r"sequence (\d+)\b", line))
        for line in lines:
            missing.difference_update([name for name in missing if names_field(line, name)
                                       and (name != "armid" or f"00{arm}" in line)])
        return not missing and sequences[-1:] > sequences[:1]

    try:
        wait_for(f"fields of {channel}", attempt)
    except AssertionError as error:
        raise AssertionError(f"{error}; missing: {missing}, sequence: {sequences}") from None


def check_jar(armada):
    """Two starts at once in an empty cache make one whole jar; a third takes it as it is."""
    command = [armada, "spy", "--jar-only"]
    starts = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    paths = {start.communicate(timeout=PATIENCE_S)[0].strip() for start in starts}
    assert len(paths) == 1 and all(start.returncode == 0 for start in starts), paths
    jar = pathlib.Path(paths.pop())
    assert [entry.name for entry in jar.parent.iterdir()] == [jar.name], "more is left in the cache"
    with zipfile.ZipFile(jar) as content:
        assert content.testzip() is None
        assert {f"armada/{name}.class" for name in OPENED.values()} <= set(content.namelist())
    made = jar.stat()
    output_of(*command)
    assert jar.stat().st_mtime_ns == made.st_mtime_ns and jar.stat().st_ino == made.st_ino, "made again"


def check_messages(armada):
    """What keeps the spy from starting is said in one message."""
    nowhere = {**os.environ, "DISPLAY": ""}
    silent = subprocess.run([armada, "spy"], env=nowhere, capture_output=True, text=True)
    assert silent.returncode == 1 and "DISPLAY is not set" in silent.stderr, silent
    without_route = output_of("unshare", "--net", armada, "spy")
    assert without_route.returncode == 1 and "ip route add 224.0.0.0/4" in without_route.stderr, without_route
    bad_url = output_of(armada, "spy", "--lcm-url", "udpm://10.0.0.1:7667")
    assert bad_url.returncode == 2 and "10.0.0.1" in bad_url.stderr, bad_url
    no_file = output_of(armada, "spy", "/nonexistent.toml")
    assert no_file.returncode == 78 and "nonexistent.toml" in no_file.stderr, no_file


def explain_failure(folder):
    """After a failure: what the programs said and what was read from the last window."""
    if sys.exc_info()[0]:
        for file in (folder / "log.txt", folder / "read.txt"):
            print(f"--- {file.name}", file.read_text() if file.exists() else "does not exist", sep="\n")


def keep_picture(windows, main, folder, picture):
    """The windows side by side."""
    for number, (x, y, width, height) in {main: (0, 0, 860, 310), windows["LEADER"]: (0, 310, 430, 410),
                                          windows["EST_3"]: (430, 310, 430, 410),
                                          windows["TEL_6"]: (860, 0, 580, 720)}.items():
        output_of("xdotool", "windowmove", number, x, y, "windowsize", number, width, height)
    time.sleep(2)  # they draw themselves at their new sizes
    output_of("import", "-window", "root", "-crop", "1440x720+0+0", "+repage", folder / "screen.png")
    shutil.copy(folder / "screen.png", picture)


def main():
    programs, source = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    armada = programs / "armada"
    os.environ["OMP_THREAD_LIMIT"] = "1"  # tesseract takes every core otherwise
    with contextlib.ExitStack() as stack:
        folder = pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory()))
        stack.callback(explain_failure, folder)
        os.environ["XDG_CACHE_HOME"] = str(folder / "cache")
        check_jar(armada)
        stack.enter_context(virtual_display())
        check_messages(armada)

        log = stack.enter_context(open(folder / "log.txt", "w"))
        stack.enter_context(running(
            armada, "run", source / "hil/scenarios/paper.toml", "--seconds", 600, "--out", folder / "run",
            "--time", "stepped", "--set", f"link.lcm_url={URL}", stop=signal.SIGINT, stdout=log, stderr=log))
        # The run writes its inputs before its log.
        wait_for("log of the run", (folder / "run/lcm.log").exists)
        stack.enter_context(running(armada, "spy", folder / "run/fleet.toml", stdout=log, stderr=log))
        spy = wait_for("lcm-spy's window", lambda: window("LCM Spy"))
        rows = wait_for("15 channels and their types", lambda: rows_of_channels(spy, folder))
        opened = {}
        for channel in OPENED:
            opened[channel] = open_channel(channel, spy, rows[channel], opened)
        put_aside(opened)
        for channel, number in opened.items():
            check_decoded(channel, number, source, folder)
        if len(sys.argv) > 3:
            keep_picture(opened, spy, folder, sys.argv[3])
    print(f"lcm-spy shows {len(CHANNELS)} channels and the fields of {', '.join(OPENED)}")


main()
