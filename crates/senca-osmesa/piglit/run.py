#!/usr/bin/env python3
"""Runs piglit's tests of OpenGL 1.x on libOSMesa.so.8 and compares with the expected results.

    apt install piglit xvfb libegl-dev
    cargo build --release -p senca-osmesa -p senca-glx
    crates/senca-osmesa/piglit/run.py
    crates/senca-osmesa/piglit/run.py --glx

`expected.csv` beside this file has a line for each test: its name, the program with its arguments, what Mesa 22.3.6
(llvmpipe) makes of it, what Senca makes of it, and why where that is not `pass`. The run fails when a result is
worse than expected. `--update` writes what was found in place of what was expected.

Each program runs on a small EGL over OSMesa (`egl.c`), built on the spot; nothing of the system's OpenGL is used. With
`--glx` it runs in a window of X on libGL.so.1 instead, and the same is expected.
"""

import argparse
import collections
import concurrent.futures
import csv
import glob
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
EXPECTED = os.path.join(HERE, "expected.csv")
COLUMNS = ["test", "command", "mesa", "senca", "reason"]
# The worst first.
ORDER = ["crash", "timeout", "fail", "warn", "skip", "pass"]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--library", help="libOSMesa.so or libGL.so (default: the release build of this repository)")
    parser.add_argument("--glx", action="store_true", help="run in windows of X, on libGL.so.1")
    parser.add_argument("--piglit", help="piglit's folder, with bin/ (default: where Debian has it)")
    parser.add_argument("--only", help="regular expression that names of tests must match")
    parser.add_argument("--timeout", type=float, default=60, help="seconds a test may take")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--update", action="store_true", help="write what was found to expected.csv")
    parser.add_argument("--verbose", action="store_true", help="say what each test that does not pass prints")
    return parser.parse_args()


def build_egl(folder, library):
    """libEGL.so.1 and libGL.so.1 over the library, all in one folder."""
    shutil.copy(library, os.path.join(folder, "libOSMesa.so.8"))
    for name, flags in (("libEGL.so.1", []), ("libGL.so.1", ["-DAS_GL"])):
        subprocess.check_call(
            ["cc", "-shared", "-fPIC", "-O1", "-Wl,--no-as-needed", f"-Wl,-soname,{name}", *flags]
            + ["-o", os.path.join(folder, name), os.path.join(HERE, "egl.c")]
            + [os.path.join(folder, "libOSMesa.so.8"), "-ldl"]
        )


def result_of(output, code):
    """Result, and results of the parts of a test."""
    whole, parts = None, {}
    for line in output.splitlines():
        # Some programs leave the line before open.
        before, found, after = line.partition("PIGLIT: {")
        if not found:
            continue
        try:
            told = json.loads("{" + after)
        except ValueError:
            continue
        for name in told.get("enumerate subtests", []):
            parts.setdefault(name, "fail")
        parts.update(told.get("subtest", {}))
        whole = told.get("result", whole)
    if code is None:
        return "timeout", parts
    if code < 0:
        return "crash", parts
    if whole is None:
        return "fail", parts
    if parts and whole in ("pass", "warn", "fail"):
        whole = min([whole, *parts.values()], key=lambda r: ORDER.index(r) if r in ORDER else 2)
        if whole == "skip":
            whole = "pass"
    return whole, parts


def run(row, options, environment):
    program, *rest = row["command"].split()
    path = os.path.join(options.piglit, "bin", program)
    if not os.path.exists(path):
        return "missing", {}, "the program is not in this piglit"
    process = subprocess.Popen([path, *rest], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                               errors="replace", env=environment, cwd=options.piglit, start_new_session=True)
    try:
        output, _ = process.communicate(timeout=options.timeout)
        code = process.returncode
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        output, _ = process.communicate()
        code = None
    result, parts = result_of(output, code)
    lines = [line for line in output.splitlines() if line.strip() and not line.startswith("PIGLIT:")]
    bad = [name for name, r in parts.items() if r not in ("pass", "skip")]
    said = " | ".join(lines[:12])[:600]
    if bad:
        said = f"[{'; '.join(bad[:20])}] {said}"
    return result, parts, said


def main():
    options = arguments()
    if options.glx and options.update:
        sys.exit("what is expected is found without --glx")
    name = "libGL.so" if options.glx else "libOSMesa.so"
    options.library = options.library or os.path.join(HERE, "../../../target/release", name)
    found = glob.glob("/usr/lib/*/piglit/bin")
    options.piglit = options.piglit or (os.path.dirname(found[0]) if found else None)
    if not options.piglit or not os.path.exists(options.library):
        sys.exit("piglit (apt install piglit) or the library (cargo build --release -p senca-osmesa -p senca-glx) is "
                 "not there")
    if "DISPLAY" not in os.environ:
        os.execvp("xvfb-run", ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24 -noreset", *sys.argv])
    with open(EXPECTED, newline="") as file:
        rows = list(csv.DictReader(file))
    chosen = [r for r in rows if not options.only or re.search(options.only, r["test"])]
    with tempfile.TemporaryDirectory() as folder:
        if options.glx:
            shutil.copy(options.library, os.path.join(folder, "libGL.so.1"))
        else:
            build_egl(folder, options.library)
        environment = dict(os.environ, LD_LIBRARY_PATH=folder, PIGLIT_PLATFORM="glx" if options.glx else "x11_egl",
                           PIGLIT_SOURCE_DIR=options.piglit)
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            results = list(pool.map(lambda row: run(row, options, environment), chosen))
    worse = 0
    for row, (result, _, said) in zip(chosen, results):
        if options.verbose and result not in ("pass", "skip"):
            print(f"{result}: {row['test']} ({row['command']}): {said}")
        if result != row["senca"]:
            grade = lambda r: ORDER.index(r) if r in ORDER else 2
            worse += grade(result) < grade(row["senca"] or "pass")
            print(f"{row['senca'] or 'new'} -> {result}: {row['test']}: {said[:200]}")
        if options.update:
            row["senca"] = result
            if result == "pass":
                row["reason"] = ""
    if options.update:
        with open(EXPECTED, "w", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    counts = collections.Counter(result for result, _, _ in results)
    both = [(row["mesa"], result) for row, (result, _, _) in zip(chosen, results)]
    of = sum(mesa == "pass" and result != "skip" for mesa, result in both)
    good = sum(mesa == "pass" and result == "pass" for mesa, result in both)
    print(", ".join(f"{n} {name}" for name, n in counts.most_common()))
    if of:
        print(f"of {of} tests that Mesa passes and that run here, {good} pass: {100 * good / of:.1f} %")
    sys.exit(1 if worse and not options.update else 0)


if __name__ == "__main__":
    main()
