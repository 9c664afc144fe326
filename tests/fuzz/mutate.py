#!/usr/bin/env python3
"""Runs the fascia tool on files mutated at random, as a whole process: whatever a file holds, the tool ends with
0, 1 or 4, within a time and a memory.

  mutate.py FASCIA RIG.glb [--seconds 120] [--seed 1] [--keep DIR] [--limit 20] [--memory 1024] [MORE_FILE...]

RIG.glb is mutated and given to info, pose, play and render; each further file to the command that reads its kind:
CSV and JSON curves, activations, edits, landmarks, snapshots, manifests and heads. A case's number is its seed, so
`--seed N --count 1` repeats it. Exit code 1 when a case failed; the failing files are kept in DIR.
"""
import argparse
import copy
import json
import os
import random
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import time

ODD_NUMBERS = [0, -1, 1, 2, 3, 4294967295, 4294967296, 2147483648, 9223372036854775807, 18446744073709551615, -2147483649,
               1e308, -1e308, 1e-320, 0.5, 5120, 5121, 5123, 5125, 5126]
ODD_VALUES = [None, True, "", "x", [], {}, [[[[]]]], [1e300] * 3, "NaN"]
ODD_FLOATS = [float("nan"), float("inf"), -float("inf"), 3e38, -3e38, 1e-42, 1e20]
ODD_WORDS = ["nan", "inf", "-inf", "1e999", "-1", "4294967296", "99999999999999999999", "", "x", "1,5", "0x7f", "\"", "\x00",
             "é", "1e-400"]


def places(tree, found, path=()):
    """Every place in a JSON tree, as a path."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in items:
        found.append(path + (key,))
        places(value, found, path + (key,))
    return found


def parent_of(tree, path):
    for key in path[:-1]:
        tree = tree[key]
    return tree


def mutate_json(tree, dice):
    tree = copy.deepcopy(tree)
    for _ in range(dice.choice([1, 1, 1, 2, 4])):
        every = places(tree, [])
        if not every:
            break
        path = dice.choice(every)
        parent, key = parent_of(tree, path), path[-1]
        kind = dice.randrange(7)
        if kind == 0:
            del parent[key]
        elif kind == 1:
            parent[key] = dice.choice(ODD_VALUES)
        elif kind == 2:  # two places swapped: accessors, buffer views, names
            other = dice.choice(every)
            try:
                there = parent_of(tree, other)
                parent[key], there[other[-1]] = copy.deepcopy(there[other[-1]]), copy.deepcopy(parent[key])
            except (KeyError, IndexError, TypeError):
                pass
        elif kind == 3 and isinstance(parent, list):
            parent.extend(copy.deepcopy(parent[key:key + 1]) * dice.choice([1, 3, 1000]))
        elif isinstance(parent[key], bool) or not isinstance(parent[key], (int, float)):
            numbers = [p for p in every if isinstance(parent_of(tree, p)[p[-1]], (int, float))]
            if numbers:
                p = dice.choice(numbers)
                parent_of(tree, p)[p[-1]] = dice.choice(ODD_NUMBERS)
        else:
            value = parent[key]
            parent[key] = dice.choice([dice.choice(ODD_NUMBERS), value + 1, value - 1, value * 2, value * 65537])
    return tree


def mutate_bytes(data, dice):
    data = bytearray(data)
    for _ in range(dice.choice([1, 1, 2, 8, 64])):
        if not data:
            break
        at = dice.randrange(len(data))
        kind = dice.randrange(5)
        if kind == 0:
            data[at] ^= 1 << dice.randrange(8)
        elif kind == 1:
            at &= ~3
            data[at:at + 4] = struct.pack("<f", dice.choice(ODD_FLOATS))[:len(data) - at]
        elif kind == 2:
            at &= ~3
            data[at:at + 4] = struct.pack("<I", dice.choice([0xFFFFFFFF, 0x80000000, 0, 1, 0x7FFFFFFF]))[:len(data) - at]
        elif kind == 3:
            size = dice.choice([1, 4, 64, 4096])
            data[at:at + size] = bytes(dice.randrange(256) for _ in range(min(size, len(data) - at)))
        else:
            other = dice.randrange(len(data))
            size = dice.choice([4, 12, 64])
            data[at:at + size] = data[other:other + size][:len(data) - at]
    if dice.randrange(8) == 0:
        data = data[:dice.randrange(len(data) + 1)]
    return bytes(data)


def mutate_glb(data, dice):
    if dice.randrange(8) == 0 or data[:4] != b"glTF":
        return mutate_bytes(data, dice)
    length = struct.unpack_from("<I", data, 12)[0]
    text, rest = data[20:20 + length], data[20 + length:]
    try:
        tree = json.loads(text)
    except (ValueError, RecursionError):  # a file broken on purpose
        return mutate_bytes(data, dice)
    if dice.randrange(4) == 0:  # numbers alone: the JSON stays sound
        return data[:20 + length] + rest[:8] + mutate_bytes(rest[8:], dice)
    text = json.dumps(mutate_json(tree, dice), separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest)) + struct.pack("<I4s", len(text), b"JSON") + text + rest


def mutate_text(data, dice):
    if dice.randrange(6) == 0:
        return mutate_bytes(data, dice)
    lines = data.decode("utf-8", "replace").split("\n")
    for _ in range(dice.choice([1, 1, 2, 8])):
        row = dice.randrange(len(lines))
        kind = dice.randrange(6)
        if kind == 0:
            del lines[row]
            lines = lines or [""]
        elif kind == 1:
            lines[row:row] = [lines[row]] * dice.choice([1, 2, 2000])
        elif kind == 2:
            lines[row] = lines[row][:dice.randrange(len(lines[row]) + 1)]
        else:
            separator = dice.choice([",", " ", ";", "\t"])
            words = lines[row].split(separator)
            words[dice.randrange(len(words))] = dice.choice(ODD_WORDS)
            lines[row] = separator.join(words)
    return "\n".join(lines).encode("utf-8", "replace")


def mutate(name, data, dice):
    if name.endswith((".glb", ".vrm")):
        return mutate_glb(data, dice)
    if name.endswith((".json", ".gltf")) and dice.randrange(4):
        try:
            return json.dumps(mutate_json(json.loads(data), dice)).encode()
        except (ValueError, RecursionError):
            pass
    if name.endswith((".stl", ".ply")) and b"\0" in data[:4096]:
        return mutate_bytes(data, dice)
    return mutate_text(data, dice)


def commands(fascia, name, file, rig, head, out):
    """What is run on a mutated file."""
    base = [fascia, "--threads", "1", "--quiet"]
    if file == rig:
        return [base + ["info", file, "--validate"],
                base + ["pose", file, "--set", "jaw_open=0.5", "-o", out + ".glb"],
                base + ["play", file, "--curves", os.path.join(os.path.dirname(file), "curves.csv"), "-o", out + ".glb"],
                base + ["render", file, "--size", "64", "-o", out + ".png"],
                base + ["export", file, "--part", "all", "-o", out + ".glb"]]
    kind = name.rsplit(".", 1)[-1].lower()
    if "poses" in name:
        return [base + ["snapshot", "record", rig, "--poses", file, "-o", out + ".json"]]
    if "snapshot" in name:
        return [base + ["snapshot", "check", rig, "--against", file]]
    if "activations" in name:
        return [base + ["pose", rig, "--activations", file, "-o", out + ".glb"]]
    if "edits" in name or "landmarks" in name:
        return [base + ["build", head, "--" + ("edits" if "edits" in name else "landmarks"), file, "-o", out + ".glb",
                        "--detail", "low"]]
    if kind == "jsonl":
        return [base + ["batch", file, "-o", out + ".d"]]
    if kind in ("csv", "json"):
        return [base + ["play", rig, "--curves", file, "-o", out + ".glb"]]
    return [base + ["info", file], base + ["build", file, "-o", out + ".glb", "--detail", "low"]]


def seed_of(source):
    """Name and bytes of a file to mutate. Those of a fuzzer's corpus are named after it, and of three a first byte tells
    the kind."""
    with open(source, "rb") as whole:
        data = whole.read()
    name, (place, folder) = os.path.basename(source), os.path.split(os.path.dirname(os.path.abspath(source)))
    if os.path.basename(place) != "corpus":
        return name, data
    return f"{folder}-{name}", data[1:] if folder in ("mesh", "landmarks", "snapshot") else data


def run(command, limit, memory):
    """What went wrong, or nothing."""
    with tempfile.TemporaryFile() as told:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=told,
                                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 1)))
        begin = time.monotonic()
        while True:
            done, status, used = os.wait4(process.pid, os.WNOHANG)
            if done:
                break
            if time.monotonic() - begin > 10 * limit:  # it waits for something
                process.kill()
                os.wait4(process.pid, 0)
                return f"no end in {10 * limit} s"
            time.sleep(0.003)
        process.returncode = 0  # it is reaped
        told.seek(0)
        text = told.read().decode("utf-8", "replace").strip()
    if used.ru_maxrss > memory * 1024:
        return f"{used.ru_maxrss // 1024} MB"
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) in (signal.SIGXCPU, signal.SIGKILL):
        return f"more than {limit} s of the processor"
    if os.WIFSIGNALED(status):
        return f"{signal.Signals(os.WTERMSIG(status)).name}: {text[-300:]}"
    code = os.WEXITSTATUS(status)
    if code not in (0, 1, 4):
        return f"exit code {code}: {text[-300:]}"
    if code == 1 and not text:
        return "exit code 1 and no word of why"
    return None


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("fascia")
    parser.add_argument("rig")
    parser.add_argument("more", nargs="*")
    parser.add_argument("--head", help="what edits and landmarks are tried on")
    parser.add_argument("--seconds", type=float, default=120.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=1 << 60)
    parser.add_argument("--limit", type=int, default=20, help="seconds of the processor a command")
    parser.add_argument("--memory", type=int, default=1024, help="MB a command")
    parser.add_argument("--keep", default="findings")
    given = parser.parse_intermixed_args()
    files = [given.rig] * max(1, len(given.more)) + given.more
    end = time.monotonic() + given.seconds
    runs = failures = 0
    with tempfile.TemporaryDirectory() as place:
        with open(os.path.join(place, "curves.csv"), "w") as curves:
            curves.write("time,jaw_open\n0,0\n0.1,0.5\n")
        for seed in range(given.seed, given.seed + given.count):
            if time.monotonic() > end:
                break
            dice = random.Random(seed)
            source = dice.choice(files)
            name, data = seed_of(source)
            file = os.path.join(place, name)
            data = mutate(name, data, dice)
            with open(file, "wb") as broken:
                broken.write(data)
            for command in commands(given.fascia, name, file, file if source == given.rig else given.rig, given.head,
                                    os.path.join(place, "out")):
                runs += 1
                wrong = run(command, given.limit, given.memory)
                if wrong:
                    failures += 1
                    os.makedirs(given.keep, exist_ok=True)
                    with open(os.path.join(given.keep, f"{seed}-{name}"), "wb") as kept:
                        kept.write(data)
                    print(f"case {seed}: {' '.join(command[4:6])} of {name}: {wrong}", flush=True)
    print(f"{runs} runs, {failures} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
