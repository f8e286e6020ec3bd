#!/usr/bin/env python3
"""Turns the plain C comments of a header into what Doxygen reads (its INPUT_FILTER).

A comment directly in front of a declaration belongs to it, and so does one behind it; a line
"---- Name ----" opens a group, and a comment that an empty line follows is about that group. What
the header leaves to its conventions (what `_free` and `_init` do, a field like `x`) is taken from
api_notes.txt beside this file. Every line stays where it is, for the sake of the warnings. Of a C++
header the comments are turned alone.

Usage: doxygen_filter.py FILE            writes the filtered text
       doxygen_filter.py --check FILE    writes the notes that describe nothing; exit 1 if any does
"""
import pathlib
import re
import sys

NOTES = pathlib.Path(__file__).with_name("api_notes.txt")

SECTION = re.compile(r"/\* -{4,} (.+?) -{4,} \*/$")
DEFINE = re.compile(r"#define (PKC_\w+)")
FUNCTION = re.compile(r"PKC_API [^;]*?\b(pkc_\w+)\(")
STRUCT = re.compile(r"typedef struct (pkc_\w+) \{$")
TYPE = re.compile(r"typedef .*?\b(pkc_\w+);")
FIELD = re.compile(r"    (?:[\w*]+ )+\**(\w+)[^;(]*;")
TWO_FIELDS = re.compile(r"    (\w+) (\w+), (\w+);(?: +/\* (.*) \*/)?$")

# Names that end so mean the same everywhere; they share one note.
SHARED = re.compile(r".*(_free|_clone|_init|_get_info|\.struct_size|\.reserved)$")


def read_notes():
    """Name to text: a line is "name: text", an indented one goes on with the text before it."""
    notes = {}
    name = ""
    for line in NOTES.read_text(encoding="utf-8").splitlines():
        if not line or line.startswith("#"):
            continue
        if line.startswith(" "):
            notes[name] += " " + line.strip()
            continue
        name, text = line.split(": ", 1)
        if name in notes:
            raise SystemExit(f"{NOTES}: '{name}' is there twice")
        notes[name] = text.strip()
    return notes


class Filter:
    """Goes over a header line by line. `lines`: what comes out; `used`: the notes that did."""

    def __init__(self, notes):
        self.notes = notes
        self.used = set()
        self.lines = []
        self.group = ""
        self.struct = ""
        self.in_comment = False
        self.commented = False
        self.opens = ""

    def note(self, name):
        """What the notes say of `name`, as a comment; "" if it needs none or there is none."""
        found = []
        shared = SHARED.match(name)
        if shared and (shared[1] == "_init" or not self.commented):
            found.append("*" + shared[1])
        if name in self.notes:
            found.append(name)
        found = [key for key in found if key in self.notes]
        self.used.update(found)
        return "".join(f"/** {self.notes[key]} */ " for key in found)

    def comment(self, line, behind):
        """The first line of a comment at the margin; `behind`: the line after its last one."""
        section = SECTION.match(line)
        if section:
            # An empty line is in front of each, which closes the group before.
            if self.group:
                self.lines[-1] = "/** @} */"
            self.group = re.sub(r"\W+", "_", section[1].split(" (")[0].lower())
            self.opens = " * @{ */"
            return f"/** @defgroup {self.group} {section[1]}"
        if not self.lines:
            return line.replace("/*", "/** @mainpage", 1)
        if not behind and self.group:
            if self.lines[-1] == " * @{ */":
                self.lines[-1] = " *"
                self.opens = "/** @{ */"
            else:
                self.lines[-1] = f"/** @addtogroup {self.group}"
            return line.replace("/*", " *", 1)
        self.commented = bool(behind)
        return line.replace("/*", "/**", 1) if behind else line

    def fields(self, line):
        """Two fields of one declaration apart, as Doxygen gives a comment to one alone."""
        match = TWO_FIELDS.match(line)
        if not match:
            return ""
        kind, first, second, text = match.groups()
        comment = f"/** {text} */ " if text else self.note(f"{self.struct}.{first}")
        return f"    {comment}{kind} {first}; {comment}{kind} {second};"

    def declared(self, line):
        """The name that a line declares, "" if none."""
        if self.struct:
            match = FIELD.match(line)
            return f"{self.struct}.{match[1]}" if match else ""
        for pattern in (DEFINE, FUNCTION, STRUCT, TYPE):
            match = pattern.match(line)
            if match:
                return match[1]
        return ""

    def declaration(self, line):
        """A line that is no comment, with the note on what it declares."""
        if line.startswith("}") or not line:
            self.commented = False
            self.struct = "" if line else self.struct
            return line
        if line == "#ifndef PACKCELL_H":
            return "/** @file */ " + line
        two = self.fields(line) if self.struct else ""
        if two:
            return two
        name = self.declared(line)
        margin = re.match(" *", line)[0]
        at = line.find("/*")
        if at > 0:
            self.in_comment = "*/" not in line
            line = f"{line[:at]}/**<{line[at + 2:]}"
        # What is said behind a field is enough; behind a function it is a remark.
        if name and not (self.struct and at > 0):
            line = margin + self.note(name) + line[len(margin):]
            self.commented = False
        struct = STRUCT.match(line[line.find("typedef"):])
        if struct:
            self.struct = struct[1]
        return line

    def run(self, text):
        source = text.splitlines()
        for index, line in enumerate(source):
            if self.in_comment:
                self.in_comment = "*/" not in line
            elif line.startswith("/*"):
                last = next(i for i in range(index, len(source)) if "*/" in source[i])
                self.in_comment = last > index
                line = self.comment(line, source[last + 1] if last + 1 < len(source) else "")
            elif self.opens:
                line, self.opens = self.opens, ""
            elif line == "#ifdef __cplusplus" and self.group:
                self.lines[-1] = "/** @} */"
            else:
                line = self.declaration(line)
            self.lines.append(line)


def filtered_cpp(text):
    """packcell.hpp: `//` in front of a declaration or behind one; not lines between sections."""
    lines = []
    for line in text.splitlines():
        if not lines:
            line = line.replace("// ", "/// @mainpage ", 1)
        elif line.lstrip().startswith("// ----"):
            line = ""
        else:
            line = re.sub(r"^( *)//(?!/)", r"\1///", line)
            line = re.sub(r"([;,{}] +)//(?!/)", r"\1///<", line)
        lines.append(f"/** @file */ {line}" if line == "#ifndef PACKCELL_HPP" else line)
    return lines


def main(arguments):
    check = arguments[:1] == ["--check"]
    if len(arguments) != 1 + check:
        raise SystemExit(__doc__)
    header = pathlib.Path(arguments[-1])
    text = header.read_text(encoding="utf-8")
    if header.suffix == ".hpp":
        print("\n".join(filtered_cpp(text)))
        return 0
    notes = read_notes()
    filtered = Filter(notes)
    filtered.run(text)
    if not check:
        # A full stop before a space would end what Doxygen takes for the first sentence.
        print(re.sub(r"\b(eq|Sec|Fig)\. ", r"\1.&nbsp;", "\n".join(filtered.lines)))
        return 0
    stale = sorted(set(notes) - filtered.used)
    for name in stale:
        print(f"{NOTES}: '{name}' is not in {header}, or says there itself what it is")
    return 1 if stale else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
