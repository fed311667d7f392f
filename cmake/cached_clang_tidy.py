#!/usr/bin/env python3
"""Runs clang-tidy over the project's own sources, and only over those that changed since they last passed.

usage: cached_clang_tidy.py [--alone] CACHE_DIR BUILD_DIR...

Each BUILD_DIR is an up-to-date Ninja build with compile_commands.json; a source is checked as the first build that has
it compiles it, alone or in a batch of CMake's, but without the compiler's precompiled headers.

Most of clang-tidy's time goes into the headers of the standard library and of Eigen. Therefore sources are checked in
batches, as one translation unit: those with the same flags, but for optimisation, folders of headers and macros that are
texts, such as paths, of which no two contradict each other. misc-unused-using-decls is run on each source alone. A batch
that does not pass, or does not compile as one, is halved, so that what is reported comes from a source alone.

What a batch is known to hide, as other code comes before a source's own: unused constants at file scope, `#pragma once` in
a source, bugprone-forward-declaration-namespace and bugprone-argument-comment where another source declares the same name,
what stands under a macro that another source defines or undefines, using-declarations of the global namespace or of
several names, and faults in a source that all others include (cmake/headers.cpp). With --alone there are no batches, and
nothing is hidden but the last.

A source that passes leaves an empty file in CACHE_DIR named after everything the verdict depends on: this script, its
compile command, the .clang-tidy files of its folders, clang-tidy's version and the contents of every file the compiler read
for it, or for the headers of its batch (Ninja's record). Findings go to standard error, exit code 1.
"""

import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import threading

ROOT = pathlib.Path(__file__).resolve().parent.parent
BATCH = 48  # sources
PER_SOURCE_CHECK = "misc-unused-using-decls"
# In a batch a name at the file scope of one source hides another's local one; the compilers check each source for that.
BATCH_OPTIONS = ["-Wno-shadow"]
ENTRY = "LLVMFuzzerTestOneInput"  # each fuzzer has one, in a batch each has another name
PRECOMPILED = re.compile(r" (-Winvalid-pch|-fpch-instantiate-templates|-Xclang -emit-pch|"
                         r"(-Xclang )?-include(-pch)?( -Xclang)? \S*cmake_pch\S*)(?= )")

DECLARED = re.compile(r"^(?!namespace|using)[a-zA-Z][^(={;/]*?[ *&](\w+) *(?:[({=;\[]|:(?!:))", re.MULTILINE)
USED = re.compile(r"^ *using [\w:]+::(\w+);", re.MULTILINE)
INCLUDED = re.compile(r'^#include "(.*)"$', re.MULTILINE)


def sources_of(unit, build):
    """The sources of a translation unit: itself, or those of a batch that CMake has made."""
    batched = unit.is_relative_to(build) and unit.name.startswith("unity_")
    return [pathlib.Path(path) for path in INCLUDED.findall(unit.read_text())] if batched else [unit]


def own_sources(builds):
    """Flags by source, without what the builds themselves made."""
    flags = {}
    for build in builds:
        for entry in json.loads((build / "compile_commands.json").read_text()):
            command = PRECOMPILED.sub("", entry["command"].partition(" -o ")[0] + " ")
            for source in sources_of(pathlib.Path(entry["file"]), build):
                if source.is_relative_to(ROOT) and not any(source.is_relative_to(made) for made in builds):
                    flags.setdefault(source, tuple(shlex.split(command)[1:]))
    return flags


def files_read(builds, sources):
    """For each source what its compilation read, less the other sources of its batch."""
    read = {}
    for build in builds:
        command = ["ninja", "-C", build, "-t", "deps"]
        listing = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        for block in listing.split("\n\n"):
            paths = [pathlib.Path(os.path.normpath(build / line.strip())) for line in block.splitlines()[1:]]
            for source in paths:
                if source in sources:
                    read.setdefault(source, [path for path in paths if path == source or path not in sources])
    return read


@functools.cache
def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def names_at_file_scope(source):
    """Roughly what the source declares there: two sources of one batch must not declare the same."""
    text = source.read_text()
    return (set(DECLARED.findall(text)) | set(USED.findall(text))) - {ENTRY}


class Batch:
    """Sources that can be checked as one."""

    def __init__(self, kind):
        self.kind = kind
        self.sources = []
        self.names = set()
        self.macros = {}
        self.folders = {}  # in order

    @property
    def flags(self):
        return [*self.kind, *(f"-D{name}={value}" for name, value in self.macros.items()), *self.folders]

    def takes(self, kind, names, macros, most):
        return (kind == self.kind and len(self.sources) < most and not names & self.names and
                all(self.macros.get(name, value) == value for name, value in macros.items()))

    def add(self, source, names, macros, folders):
        self.sources.append(source)
        self.names |= names
        self.macros |= macros
        self.folders |= dict.fromkeys(folders)


def parts_of(flags):
    """Flags that sources of a batch must share, macros that are texts with their values, folders of headers."""
    kind, macros, folders = [], {}, []
    rest = iter(flags)
    for flag in rest:
        if flag.startswith("-D") and '"' in flag:
            name, _, value = flag[2:].partition("=")
            macros[name] = value
        elif flag in ("-isystem", "-I"):
            folders.append(flag + next(rest))
        elif flag.startswith("-I"):
            folders.append(flag)
        elif not flag.startswith("-O"):
            kind.append(flag)
    return tuple(kind), macros, folders


def in_batches(sources, flags, most):
    batches = []
    for source in sources:
        kind, macros, folders = parts_of(flags[source])
        names = names_at_file_scope(source)
        batch = next((batch for batch in batches if batch.takes(kind, names, macros, most)), None)
        if not batch:
            batch = Batch(kind)
            batches.append(batch)
        batch.add(source, names, macros, folders)
    return sorted(batches, key=lambda batch: len(batch.sources), reverse=True)  # the long ones first


def main():
    most = 1 if "--alone" in sys.argv else BATCH
    cache, *builds = (pathlib.Path(argument).resolve() for argument in sys.argv[1:] if argument != "--alone")
    cache.mkdir(parents=True, exist_ok=True)
    version = subprocess.run(["clang-tidy", "--version"], check=True, capture_output=True, text=True).stdout
    flags = own_sources(builds)
    read = files_read(builds, flags)

    def passed_marker(source):
        configs = [folder / ".clang-tidy" for folder in source.parents if folder.is_relative_to(ROOT)]
        inputs = [config for config in configs if config.exists()] + read[source]
        parts = [version, digest(pathlib.Path(__file__)), str(most), *flags[source]] + [f"{path} {digest(path)}" for path in inputs]
        return cache / hashlib.sha256("\n".join(parts).encode()).hexdigest()

    def tidy(file, flags_of_file, *options):
        return subprocess.run(["clang-tidy", "--quiet", *options, file, "--", *flags_of_file],
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)

    markers = {source: passed_marker(source) for source in flags}
    changed = [source for source, marker in markers.items() if not marker.exists()]
    alone = {source for source in changed if USED.search(source.read_text())}
    done = 0
    lock = threading.Lock()

    def pass_as_one(batch, flags_of_batch):
        """Whether all of the sources as one pass all checks but PER_SOURCE_CHECK."""
        # What replaces functions of C comes after all that includes their headers.
        batch = sorted(batch, key=lambda source: 'extern "C"' in source.read_text())
        unit = cache / f"batch_{hashlib.sha256(str(batch).encode()).hexdigest()}.cpp"
        unit.write_text("".join(f"#define {ENTRY} {ENTRY}{place}\n"
                                f'#include "{source}"  // NOLINT(bugprone-suspicious-include)\n'
                                f"#undef {ENTRY}\n" for place, source in enumerate(batch)))
        try:
            return tidy(unit, [*flags_of_batch, *BATCH_OPTIONS], f"--checks=-{PER_SOURCE_CHECK}").returncode == 0
        finally:
            unit.unlink()

    def check(batch, flags_of_batch):
        """The number of sources with findings."""
        nonlocal done
        if len(batch) == 1:
            results = [tidy(batch[0], flags[batch[0]])]
        elif pass_as_one(batch, flags_of_batch):
            results = [tidy(source, flags[source], f"--checks=-*,{PER_SOURCE_CHECK}") if source in alone else None
                       for source in batch]
        else:
            middle = len(batch) // 2
            return check(batch[:middle], flags_of_batch) + check(batch[middle:], flags_of_batch)
        findings = 0
        with lock:
            for source, result in zip(batch, results):
                if result is None or result.returncode == 0:
                    markers[source].touch()
                else:
                    findings += 1
                    print(result.stdout or f"clang-tidy failed on {source}", file=sys.stderr)
            done += len(batch)
            if sys.stderr.isatty():
                print(f"\r\033[Kclang-tidy {done}/{len(changed)}", end="\r", file=sys.stderr)
        return findings

    batches = in_batches(changed, flags, most)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        findings = sum(pool.map(lambda batch: check(batch.sources, batch.flags), batches))
    print(f"{len(flags)} files, {len(changed)} checked, the others unchanged")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
