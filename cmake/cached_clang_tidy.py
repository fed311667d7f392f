#!/usr/bin/env python3
"""Runs clang-tidy over the project's own sources, and only over those that changed since they last passed.

usage: cached_clang_tidy.py BUILD_DIR CACHE_DIR

BUILD_DIR is an up-to-date Ninja build with compile_commands.json. A source that passes leaves an empty file in
CACHE_DIR named after everything the verdict depends on: its compile command, the .clang-tidy files of its folders,
clang-tidy's version and the contents of every file the compiler read for it (Ninja's record). Findings go to standard
error, exit code 1.
"""

import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def own_sources(build):
    """Compile commands by source, without what the build itself made."""
    commands = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        source = pathlib.Path(entry["file"])
        if source.is_relative_to(ROOT) and not source.is_relative_to(build):
            commands.setdefault(source, entry["command"])
    return commands


def files_read(build):
    """For each source the files its compilation read; the first one that Ninja names is the source."""
    listing = subprocess.run(["ninja", "-C", build, "-t", "deps"], check=True, capture_output=True, text=True).stdout
    read = {}
    for block in listing.split("\n\n"):
        lines = block.splitlines()[1:]
        paths = [pathlib.Path(os.path.normpath(build / line.strip())) for line in lines]
        if paths:
            read[paths[0]] = paths
    return read


@functools.cache
def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def main():
    build, cache = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])
    cache.mkdir(parents=True, exist_ok=True)
    version = subprocess.run(["clang-tidy", "--version"], check=True, capture_output=True, text=True).stdout
    read = files_read(build)

    def passed_marker(source, command):
        configs = [folder / ".clang-tidy" for folder in source.parents if folder.is_relative_to(ROOT)]
        inputs = [config for config in configs if config.exists()] + read[source]
        parts = [version, command] + [f"{path} {digest(path)}" for path in inputs]
        return cache / hashlib.sha256("\n".join(parts).encode()).hexdigest()

    def check(source):
        return subprocess.run(["clang-tidy", "--quiet", "-p", build, source],
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)

    commands = own_sources(build)
    markers = {source: passed_marker(source, command) for source, command in commands.items()}
    changed = [source for source, marker in markers.items() if not marker.exists()]
    findings = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for number, (source, result) in enumerate(zip(changed, pool.map(check, changed)), start=1):
            if sys.stderr.isatty():
                print(f"\r\033[Kclang-tidy {number}/{len(changed)}", end="\r", file=sys.stderr)
            if result.returncode == 0:
                markers[source].touch()
            else:
                findings += 1
                print(result.stdout or f"clang-tidy failed on {source}", file=sys.stderr)
    print(f"{len(commands)} files, {len(changed)} checked, the others unchanged")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
