#!/usr/bin/env python3
"""Reads Structured Text as far as can be done without a compiler: every token is one of the language,
blocks end as they began, names are declared before they are used, and the constants are those of the
twin in C.

Usage: plc_text.py FILE.st TWIN.h
"""
import re
import sys

TOKEN = re.compile(r"(?P<comment>\(\*.*?\*\))|(?P<space>\s+)|(?P<number>16#[0-9A-F]+|\d+)"
                   r"|(?P<name>[A-Za-z_]\w*)|(?P<operator>:=|<>|<=|>=|\.\.|[-+*/<>=.,:;()\[\]])",
                   re.DOTALL)
ENDS = {"IF": "END_IF", "CASE": "END_CASE", "FOR": "END_FOR", "WHILE": "END_WHILE",
        "TYPE": "END_TYPE", "STRUCT": "END_STRUCT", "FUNCTION_BLOCK": "END_FUNCTION_BLOCK",
        "PROGRAM": "END_PROGRAM", "VAR": "END_VAR", "VAR_INPUT": "END_VAR",
        "VAR_OUTPUT": "END_VAR", "VAR_GLOBAL": "END_VAR"}
WORDS = set(ENDS) | set(ENDS.values()) | set(
    "ARRAY OF CONSTANT THEN ELSIF ELSE DO TO AND OR NOT TRUE FALSE BOOL INT UINT UDINT WORD DWORD "
    "MIN SHL WORD_TO_UINT UINT_TO_WORD WORD_TO_DWORD".split())


def tokens(text):
    """(kind, text, line) without comments and spaces."""
    at, line = 0, 1
    while at < len(text):
        match = TOKEN.match(text, at)
        if not match:
            raise SystemExit(f"line {line}: '{text[at:at + 20].splitlines()[0]}' is no token")
        if match.lastgroup not in ("comment", "space"):
            yield match.lastgroup, match[0], line
        line += match[0].count("\n")
        at = match.end()


def number(word):
    return int(word[3:], 16) if word.startswith("16#") else int(word)


def read(text):
    """Faults, and the constants with their values."""
    words = list(tokens(text))
    faults, constants, open_blocks = [], {}, []
    shared, own, declaring = set(), set(), False
    for index, (kind, word, line) in enumerate(words):
        before = words[index - 1][1] if index else ""
        after = words[index + 1][1] if index + 1 < len(words) else ""
        if word in ENDS:
            open_blocks.append((word, line))
            declaring = word.startswith("VAR") or word in ("TYPE", "STRUCT")
            if word in ("FUNCTION_BLOCK", "PROGRAM"):
                shared.add(after)
                own = set()
        elif word in ENDS.values():
            if not open_blocks or ENDS[open_blocks[-1][0]] != word:
                faults.append(f"line {line}: {word} ends nothing")
            else:
                open_blocks.pop()
            declaring = False
        elif word == "=" and before == ":":
            faults.append(f"line {line}: ': =' must be ':='")
        elif kind == "name" and word not in WORDS and before != ".":
            blocks = [name for name, _ in open_blocks]
            if declaring and after == ":":
                (shared if "VAR_GLOBAL" in blocks or "TYPE" in blocks else own).add(word)
                if "VAR_GLOBAL" in blocks and words[index + 3][1] == ":=":
                    constants[word] = number(words[index + 4][1])
            elif after == ":=" and before in ("(", ","):
                pass  # an input in a call
            elif word not in shared | own:
                faults.append(f"line {line}: '{word}' is not declared")
    faults += [f"line {line}: {word} has no {ENDS[word]}" for word, line in open_blocks]
    return faults, constants


def twin_constants(text):
    found = re.findall(r"^#define (PACKCELL_\w+) (0x[0-9A-Fa-f]+|\d+)u?\b", text, re.MULTILINE)
    return {name: int(value, 0) for name, value in found}


def main():
    with open(sys.argv[1], encoding="ascii") as file:
        faults, constants = read(file.read())
    with open(sys.argv[2], encoding="ascii") as file:
        twin = twin_constants(file.read())
    for name in sorted(constants.keys() | twin.keys()):
        ours, theirs = constants.get(name), twin.get(name)
        if ours != theirs:
            faults.append(f"{name}: {ours} in Structured Text, {theirs} in C")
    if not constants:
        faults.append("no constants")
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: plc_text.py FILE.st TWIN.h")
    sys.exit(main())
