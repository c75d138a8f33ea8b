#!/usr/bin/env python3
"""Calls the functions of libOSMesa.so.8 in any order with any arguments, and finds what crashes, hangs or eats memory.

    apt install gcc libosmesa6-dev
    cargo build --release -p senca-osmesa
    crates/senca-osmesa/fuzz/streams.py --streams 200

The functions and the types of their parameters are read from the system's GL/gl.h and GL/glext.h. Each stream is a
process of its own with a number that begins it: a stream that ends badly is told by its number, and `--stream N
--trace` shows its calls. Numbers are mostly small, and pointers lead to memory that is large enough for them, since a
program that promises more memory than it has breaks OpenGL's contract, not ours.

Under AddressSanitizer, with a nightly toolchain:

    RUSTFLAGS=-Zsanitizer=address cargo +nightly build -p senca-osmesa --target x86_64-unknown-linux-gnu
    crates/senca-osmesa/fuzz/streams.py --asan --library target/x86_64-unknown-linux-gnu/debug/libOSMesa.so
"""

import argparse
import ctypes
import os
import random
import re
import resource
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
SIDE = 64
ARENA = 16 << 20
NUMBERS = {
    "GLenum": ctypes.c_uint, "GLbitfield": ctypes.c_uint, "GLuint": ctypes.c_uint, "GLint": ctypes.c_int,
    "GLsizei": ctypes.c_int, "GLboolean": ctypes.c_ubyte, "GLbyte": ctypes.c_byte, "GLubyte": ctypes.c_ubyte,
    "GLshort": ctypes.c_short, "GLushort": ctypes.c_ushort, "GLfloat": ctypes.c_float, "GLclampf": ctypes.c_float,
    "GLdouble": ctypes.c_double, "GLclampd": ctypes.c_double, "GLintptr": ctypes.c_ssize_t,
    "GLsizeiptr": ctypes.c_ssize_t, "GLintptrARB": ctypes.c_ssize_t, "GLsizeiptrARB": ctypes.c_ssize_t,
}
PROTOTYPE = re.compile(r"GLAPI\s+([\w\s\*]+?)\s*(?:GL)?APIENTRY\s+(gl\w+)\s*\(([^)]*)\)\s*;", re.S)
TOKEN = re.compile(r"#define\s+(GL_[A-Z0-9_a-z]+)\s+0x([0-9A-Fa-f]+)\s")


def headers():
    """Prototypes by name, and the values of all tokens."""
    text = "".join(open(f"/usr/include/GL/{name}").read() for name in ("gl.h", "glext.h"))
    found = {}
    for result, name, parameters in PROTOTYPE.findall(text):
        types = [] if parameters.strip() in ("", "void") else [p.strip() for p in parameters.split(",")]
        found.setdefault(name, (result.strip(), types))
    core = text[: text.index("GL_VERSION_2_0")]
    return found, sorted({int(value, 16) for _, value in TOKEN.findall(core)})


class Stream:
    """One process's worth of calls."""

    def __init__(self, path, seed, trace):
        self.random = random.Random(seed)
        self.trace = trace
        self.library = ctypes.CDLL(path)
        # Small numbers whatever they are read as, so that indices stay within the arrays.
        small = (ctypes.c_uint32 * (ARENA // 4))(*[self.random.randrange(32) for _ in range(1024)])
        ctypes.memmove(ctypes.addressof(small) + 4096, small, 4096)
        self.arena, self.out = small, (ctypes.c_ubyte * ARENA)()
        self.pointers = (ctypes.c_void_p * 64)(*[ctypes.addressof(small)] * 64)
        self.picture = (ctypes.c_ubyte * (SIDE * SIDE * 16))()
        prototypes, self.tokens = headers()
        address = self.library.OSMesaGetProcAddress
        address.restype, address.argtypes = ctypes.c_void_p, [ctypes.c_char_p]
        self.calls = []
        for name, (result, types) in sorted(prototypes.items()):
            arguments = [self.kind(t) for t in types]
            found = address(name.encode())
            # Programs give functions to these, or promise memory for an address.
            if found and None not in arguments and not re.search("Callback|DeleteContext", name):
                self.calls.append((name, self.function(found, result, arguments), arguments))
        self.likely = {}

    def kind(self, declared):
        """C type of a parameter; `None` for one that cannot be made up."""
        if "*" in declared or "[" in declared:
            if declared.count("*") > 1 or "*const*" in declared.replace(" ", ""):
                return "pointers"
            return "in" if "const" in declared else "out"
        return NUMBERS.get(declared.replace("const", "").split()[0])

    def function(self, address, result, arguments):
        types = [ctypes.c_void_p if isinstance(a, str) else a for a in arguments]
        gives = None if result == "void" else ctypes.c_void_p if "*" in result else NUMBERS.get(result, ctypes.c_uint)
        return ctypes.CFUNCTYPE(gives, *types)(address)

    def argument(self, name, place, kind):
        pick = self.random
        if kind == "in":
            # Data that may be left out, sometimes is.
            return 0 if pick.random() < 0.1 and "Pointer" not in name else ctypes.addressof(self.arena)
        if kind == "out":
            return ctypes.addressof(self.out)
        if kind == "pointers":
            return ctypes.addressof(self.pointers)
        if kind in (ctypes.c_float, ctypes.c_double):
            return pick.choice([0, 1, -1, 0.5, 2, 1e-30, 3e38, float("inf"), float("nan"), pick.uniform(-2, 2)])
        if kind is ctypes.c_uint:
            # What was good once for this function is worth trying again.
            good = self.likely.setdefault((name, place), [])
            if good and pick.random() < 0.6:
                return pick.choice(good)
            return pick.choice([pick.choice(self.tokens), pick.randrange(20), pick.getrandbits(32)])
        return pick.choice([0, 1, 2, 3, 4, 8, 16, pick.randrange(20), -1])

    def context(self):
        create = self.library.OSMesaCreateContextExt
        create.restype = ctypes.c_void_p
        create.argtypes = [ctypes.c_uint, ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_void_p]
        current = self.library.OSMesaMakeCurrent
        current.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_uint, ctypes.c_int, ctypes.c_int]
        made = create(0x1908, 24, 8, 16, None)
        assert current(made, self.picture, 0x1401, SIDE, SIDE)

    def run(self, count):
        self.context()
        error = self.library.glGetError
        open_list = 0
        for _ in range(count):
            name, function, kinds = self.random.choice(self.calls)
            # What is recorded may call itself many times; sizes add up.
            open_list += 1 if name == "glNewList" else 0
            values = [self.argument(name, place, kind) for place, kind in enumerate(kinds)]
            if self.trace:
                print(name, *(hex(v) if isinstance(v, int) else v for v in values), file=sys.stderr, flush=True)
            function(*values)
            if name != "glGetError" and error() == 0:
                for place, (kind, value) in enumerate(zip(kinds, values)):
                    if kind is ctypes.c_uint:
                        self.likely[name, place].append(value) if len(self.likely[name, place]) < 64 else None
            elif self.random.random() < 0.05:
                # Out of a Begin or a list that would swallow everything.
                self.library.glEnd()
                self.library.glEndList()
        self.library.glFinish()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--library", default=os.path.join(HERE, "../../../target/release/libOSMesa.so"))
    parser.add_argument("--streams", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, help="number of the first stream")
    parser.add_argument("--calls", type=int, default=3000, help="calls of a stream")
    parser.add_argument("--seconds", type=float, default=60, help="time a stream may take")
    parser.add_argument("--gigabytes", type=float, default=4, help="memory a stream may have")
    parser.add_argument("--asan", action="store_true", help="the library is built with AddressSanitizer")
    parser.add_argument("--stream", type=int, help="run only this one, in this process")
    parser.add_argument("--trace", action="store_true", help="tell every call before it is made")
    options = parser.parse_args()
    options.library = os.path.abspath(options.library)
    if options.stream is not None:
        if not options.asan:
            most = int(options.gigabytes * (1 << 30))
            resource.setrlimit(resource.RLIMIT_AS, (most, most))
        Stream(options.library, options.stream, options.trace).run(options.calls)
        return
    environment = dict(os.environ)
    if options.asan:
        runtime = subprocess.check_output(["gcc", "-print-file-name=libasan.so"], text=True).strip()
        environment.update(LD_PRELOAD=runtime, ASAN_OPTIONS="detect_leaks=0:allocator_may_return_null=1")
    bad = 0
    for number in range(options.first, options.first + options.streams):
        words = [sys.executable, os.path.abspath(__file__), "--stream", str(number), "--library", options.library,
                 "--calls", str(options.calls), "--gigabytes", str(options.gigabytes)]
        words += ["--asan"] if options.asan else []
        try:
            done = subprocess.run(words, env=environment, capture_output=True, text=True, errors="replace",
                                  timeout=options.seconds)
            ended, said = done.returncode, done.stderr
        except subprocess.TimeoutExpired:
            ended, said = "no end", ""
        if ended != 0:
            bad += 1
            print(f"stream {number}: {ended}", *said.splitlines()[:12], sep="\n  ", flush=True)
    print(f"{options.streams} streams of {options.calls} calls, {bad} ended badly")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
