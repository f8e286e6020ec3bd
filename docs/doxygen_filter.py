#!/usr/bin/env python3
"""Turns the plain C comments of a header into what Doxygen reads (its INPUT_FILTER).

A comment directly in front of a declaration belongs to it, and so does one behind it; a line
"---- Name ----" opens a group, and a comment that an empty line follows is about that group. What
the header leaves to its conventions (what `_free` and `_init` do, a field like `x`) is taken from
api_notes.txt beside this file: so are what each parameter is, with unit and range, and where a
function comes from. What a function may return is listed from its comment and its parameters. Every
line stays where it is, for the sake of the warnings. Of a C++ header the comments are turned alone.

Usage: doxygen_filter.py FILE            writes the filtered text
       doxygen_filter.py --check FILE    writes what a function lacks (the text of a parameter, the
                                         range of a number, an error that its kind has, a source),
                                         and notes that describe nothing; exit 1 if there is any
"""
import fnmatch
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

DECLARATION = re.compile(r"PKC_API (.+?)(pkc_\w+)\((.*?)\);", re.DOTALL)
PARAMETER = re.compile(r"(.+?)(\w+)(\[\w+\])?$", re.DOTALL)
STATUS = re.compile(r"PKC_E_[A-Z]+\b")

# What the text of a number says of its range: 1..128, >= 1, any, or a family of constants.
RANGE = re.compile(r"\.\.|>=? \d|\bany\b|\bPKC_[A-Z_]+_\*")
NUMBERS = {"int32_t", "uint32_t", "uint64_t", "double"}

# Handles that do not change: no call finds them busy.
SHAREABLE = {"pkc_policy", "pkc_cell", "pkc_simulation"}

# Calls that take no memory, as the header says or because there is nothing to take it for.
TAKES_NONE = re.compile(r".*(_init|_get_info|_cancel)$|pkc_planner_(plan|begin|step|result)$|"
                        r"pkc_environment_(reset|step|open|observe)$")

# Groups that a build with PACKCELL_CELL=OFF does without.
OF_CELL = {"cell", "tasks_and_schedule", "simulation", "traces"}


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


class Function:
    """A declaration of the header. `params`: type and name of each parameter."""

    def __init__(self, returns, name, params):
        self.name = name
        self.returns = returns.strip()
        self.params = []
        if params != "void":
            for param in params.split(","):
                kind, parameter, array = PARAMETER.match(param.strip()).groups(default="")
                self.params.append((" ".join(kind.split()) + array, parameter))

    def takes(self, types):
        """Whether it is given a pointer to one of these types."""
        return any("*" in kind and not kind.endswith("**")
                   and types.intersection(re.findall(r"pkc_\w+", kind)) for kind, _ in self.params)


class Filter:
    """Goes over a header line by line. `lines`: what comes out; `used`: the notes that did;
    `lacks`: what the functions should say and do not."""

    def __init__(self, notes, text):
        self.notes = notes
        self.text = text
        self.functions = {match[2]: Function(*match.groups())
                          for match in DECLARATION.finditer(text)}
        self.handles = set(re.findall(r"typedef struct (pkc_\w+) \1;", text))
        self.sized = set(re.findall(r"struct (pkc_\w+) \{\s+uint32_t struct_size;", text))
        self.statuses = re.findall(r"#define (PKC_E_[A-Z]+) ", text)
        self.used = set()
        self.lacks = []
        self.lines = []
        self.said = ""
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

    def parameter(self, function, kind, name):
        """What a parameter is."""
        if kind.endswith("**") and name.startswith("out_"):
            free = kind.rstrip("* ") + "_free"
            if free not in self.functions:
                self.lacks.append(f"{function.name}: there is no {free}")
            return f"gets the handle; it is the caller's, who gives it to {free}()"
        shared = f"param *_init.{'size' if name == 'size' else 'struct'}"
        keys = [f"param {function.name}.{name}", f"param {name}"]
        if function.name.endswith("_init"):
            keys.insert(0, shared)
        key = next((key for key in keys if key in self.notes), None)
        if key is None:
            self.lacks.append(f"{function.name}: parameter '{name}' has no text")
            return ""
        self.used.add(key)
        if kind in NUMBERS and not RANGE.search(self.notes[key]):
            self.lacks.append(f"{function.name}: the number '{name}' has no range")
        return self.notes[key]

    def may_return(self, function, said):
        """The statuses that the comment names, and those that follow from the parameters."""
        name = function.name
        found = set(STATUS.findall(said))
        if unknown := found - set(self.statuses):
            self.lacks.append(f"{name}: {', '.join(sorted(unknown))} is no status")
        if "_load" in name and "PKC_E_FORMAT" not in found:
            self.lacks.append(f"{name}: does not say when it returns PKC_E_FORMAT")
        parameters = {parameter for _, parameter in function.params}
        if "path" in parameters and "PKC_E_IO" not in found:
            self.lacks.append(f"{name}: does not say when it returns PKC_E_IO")
        found.add("PKC_E_ARGUMENT")
        if function.takes(self.sized):
            found.add("PKC_E_STRUCT")
        if not TAKES_NONE.match(name):
            found.add("PKC_E_MEMORY")
        if function.takes(self.handles - SHAREABLE) and not name.endswith("_cancel"):
            found.add("PKC_E_BUSY")
        if "capacity" in parameters:
            found.add("PKC_E_CAPACITY")
        if self.group in OF_CELL:
            found.add("PKC_E_UNSUPPORTED")
        return [status for status in self.statuses if status in found]

    def source(self, function):
        """Where it comes from: a note for its kind (*_init), or whose pattern says most."""
        patterns = [key for key in self.notes if key.startswith("source ")
                    and fnmatch.fnmatchcase(function.name, key.split()[1])]
        if not patterns:
            self.lacks.append(f"{function.name}: has no source")
            return ""
        key = max(patterns, key=lambda pattern: (pattern.startswith("source *"), len(pattern)))
        self.used.add(key)
        for path in re.findall(r"\b(?:docs|src)/[\w/.-]+\w", self.notes[key]):
            if not (NOTES.parent.parent / path).exists():
                self.lacks.append(f"{function.name}: its source {path} is not there")
        return self.notes[key]

    def reference(self, function, said):
        """Parameters, statuses and source of a function as Doxygen wants them."""
        parts = [f"@param {name} {self.parameter(function, kind, name)}"
                 for kind, name in function.params]
        answer = f"return {function.name}"
        if function.returns == "pkc_status":
            statuses = ", ".join(f"#{status}" for status in self.may_return(function, said))
            parts.append(f"@return #PKC_OK, or {statuses}")
        elif answer in self.notes:
            self.used.add(answer)
            parts.append(f"@return {self.notes[answer]}")
        elif function.returns != "void":
            self.lacks.append(f"{function.name}: does not say what it returns")
        parts.append(f"@source {self.source(function)}")
        return f"/** {' '.join(parts)} */ "

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
            return "/** @page conventions Conventions of every function"
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
            note = self.note(name)
            if name in self.functions:
                said = (self.said if self.commented else "") + note
                note += self.reference(self.functions[name], said)
            line = margin + note + line[len(margin):]
            self.commented = False
        struct = STRUCT.match(line[line.find("typedef"):])
        if struct:
            self.struct = struct[1]
        return line

    def run(self):
        source = self.text.splitlines()
        for index, line in enumerate(source):
            if self.in_comment:
                self.in_comment = "*/" not in line
            elif line.startswith("/*"):
                last = next(i for i in range(index, len(source)) if "*/" in source[i])
                self.in_comment = last > index
                self.said = " ".join(source[index:last + 1])
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
    if header.suffix == ".dox":
        print(text)
        return 0
    notes = read_notes()
    filtered = Filter(notes, text)
    filtered.run()
    if not check:
        # A full stop before a space would end what Doxygen takes for the first sentence.
        print(re.sub(r"\b(eq|Sec|Fig)\. ", r"\1.&nbsp;", "\n".join(filtered.lines)))
        return 0
    stale = sorted(set(notes) - filtered.used)
    for name in stale:
        print(f"{NOTES}: '{name}' is not in {header}, or says there itself what it is")
    for lack in filtered.lacks:
        print(f"{header}: {lack}")
    return 1 if stale or filtered.lacks else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
