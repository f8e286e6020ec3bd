#!/usr/bin/env python3
"""Judges the layout of the tree: which folder may include what.

usage: test_includes.py SOURCE_DIR    judge a tree; every broken rule is one line, exit status 1
       test_includes.py --self-test   prove on small trees that each rule is enforced
"""
import pathlib
import re
import sys
import tempfile

# From the ground up: a file includes its own floor and floors beneath it.
FLOORS = ["base", "bin", "feed", "policy", "search", "learn", "task", "motion", "cell", "trace",
          "capi"]

# Libraries by the start of their headers' names, and the floors that may include them.
LIBRARIES = [
    ("box2d/", {"cell"}),
    ("nlopt", {"motion"}),
    ("Eigen/", {"policy", "learn", "motion"}),
    ("unsupported/Eigen/", {"policy", "learn", "motion"}),
    ("nlohmann/", {"cell", "trace"}),
]

TOP_FOLDERS = {"include", "src", "bindings", "tests", "examples", "docs", "debian", ".ci", ".git",
               "build", "out"}

SOURCE_SUFFIXES = {".c", ".cpp", ".h", ".hpp", ".inc"}
HEADER_SUFFIXES = {".h", ".hpp"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def source_files(folder):
    return sorted(p for p in folder.rglob("*") if p.suffix in SOURCE_SUFFIXES)


def includes(path):
    """Yields (line number, True if quoted, name) for every include of a file."""
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        match = INCLUDE.match(line)
        if match:
            yield number, match[1] == '"', match[2]


def judge_source(path, floor, where):
    if path.suffix in HEADER_SUFFIXES and "#pragma once" not in path.read_text(encoding="utf-8"):
        yield f"{where}: header without #pragma once"
    for number, quoted, name in includes(path):
        for library, floors in LIBRARIES:
            if name.startswith(library) and floor not in floors:
                yield f"{where}:{number}: {name} outside {', '.join(sorted(floors))}"
        target = name.split("/")[0]
        if "/" in name and target in FLOORS:
            if FLOORS.index(target) > FLOORS.index(floor):
                yield f"{where}:{number}: {name} is above {floor}/"
        elif quoted and name != "packcell.h":
            yield f'{where}:{number}: "{name}" names no floor: must be "<floor>/<file>"'


def judge_outsider(path, root, where):
    """A file that sees the public header alone."""
    for number, _, name in includes(path):
        beside = (path.parent / name).resolve()
        inside = (root / "src" / name).is_file() or (root / "src").resolve() in beside.parents
        if inside and not (path.parent / name).is_file() or "src" in name.split("/"):
            yield f"{where}:{number}: {name} is not public"


def judge(root):
    """Yields one line for every broken rule of the tree."""
    for entry in sorted(root.iterdir()):
        if entry.is_dir() and entry.name not in TOP_FOLDERS:
            yield f"{entry.name}/: unknown top-level folder"
    for path in source_files(root / "src"):
        where = path.relative_to(root)
        floor = where.parts[1]
        if floor not in FLOORS:
            yield f"{where}: not in one of the folders {', '.join(FLOORS)}"
        else:
            yield from judge_source(path, floor, where)
    for folder in ("examples", "tests/api"):
        for path in source_files(root / folder):
            yield from judge_outsider(path, root, path.relative_to(root))


def self_test():
    sound = {
        "src/base/status.h": "#pragma once\n#include <string>\n",
        "src/bin/bin.h": '#pragma once\n#include "base/status.h"\n#include "packcell.h"\n',
        "src/policy/network.cpp": '#include <Eigen/Dense>\n#include "bin/bin.h"\n',
        "examples/common/args.h": "#pragma once\n#include <packcell.h>\n",
        "examples/pack/main.cpp": '#include <nlohmann/json.hpp>\n#include "common/args.h"\n',
        "tests/api/test_bin.c": "#include <cmocka.h>\n#include <packcell.h>\n",
    }
    # Each of these files, added to the sound tree, breaks exactly one rule.
    faults = {
        "src/base/up.cpp": '#include "bin/bin.h"\n',
        "src/base/up_in_brackets.cpp": "  # include <bin/bin.h>\n",
        "src/feed/up.cpp": '#include "capi/guard.h"\n',
        "src/feed/beside.cpp": '#include "queue.h"\n',
        "src/feed/climb.cpp": '#include "../bin/bin.h"\n',
        "src/feed/bare.h": "int f();\n",
        "src/motion/world.cpp": "#include <box2d/box2d.h>\n",
        "src/cell/layout.cpp": "#include <nlopt.hpp>\n",
        "src/search/tree.cpp": "#include <Eigen/Core>\n",
        "src/capi/json.cpp": "#include <nlohmann/json.hpp>\n",
        "src/cellar/wine.cpp": "int wine;\n",
        "src/loose.cpp": "int loose;\n",
        "examples/pack/inside.cpp": '#include "bin/bin.h"\n',
        "examples/pack/climb.cpp": '#include "../../src/bin/bin.h"\n',
        "tests/api/test_inside.c": "#include <bin/bin.h>\n",
        "vendor/box2d.h": "int box2d;\n",
    }

    def judged(files):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name, text in files.items():
                path = root / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            return list(judge(root))

    failures = []
    if judged(sound):
        failures.append(f"the sound tree is blamed: {judged(sound)}")
    for name, text in faults.items():
        found = judged({**sound, name: text})
        if len(found) != 1 or name.split("/")[0] not in found[0]:
            failures.append(f"{name}: expected one fault, got {found}")
    return failures


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    if sys.argv[1] == "--self-test":
        faults = self_test()
    else:
        faults = list(judge(pathlib.Path(sys.argv[1])))
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
