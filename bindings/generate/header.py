"""Reads packcell.h: clang's syntax tree for what is declared, a small C program for values and
layouts, and the text itself for comments and array parameters.
"""
import json
import os
import pathlib
import re
import subprocess
import tempfile

# Types that a field, a parameter or a constant may have, beside the header's own.
SCALARS = {"int32_t", "uint32_t", "int64_t", "uint64_t", "uint8_t", "size_t", "float", "double",
           "char", "void"}
ALIASES = {"pkc_status": "int32_t"}

# A pointer is to many when its name is a plural; these are the words that only look like one, and
# the ones that are one without looking so.
SINGULAR = {"options", "nodes"}
MANY = {"mask"}
# Arrays that are read and then written; what else is written is not read before.
IN_PLACE = {("pkc_allocate", "actions")}


class HeaderError(Exception):
    """The header has something that the bindings have no rule for."""


def run(command, text=None):
    done = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise HeaderError(f"{command[0]} failed:\n{done.stderr.strip()}")
    return done.stdout


def joined(comment):
    """A comment's text in one line, without its stars."""
    lines = (re.sub(r"^\s*\*(?!/) ?", "", line).strip() for line in comment.splitlines())
    return " ".join(line for line in lines if line)


class Text:
    """The header's own text, which clang gives byte offsets into."""

    def __init__(self, path):
        self.bytes = path.read_bytes()
        self.text = self.bytes.decode("ascii")
        self.comments = [(m.start(), m.end(), joined(m[1]))
                         for m in re.finditer(r"/\*(.*?)\*/", self.text, re.DOTALL)]

    def line_start(self, offset):
        return self.text.rfind("\n", 0, offset) + 1

    def comment_before(self, offset):
        """The comment that ends on the line above, if it stands alone there."""
        start = self.line_start(offset)
        for begin, end, text in self.comments:
            if self.text[end:start] == "\n" and not self.text[self.line_start(begin):begin].strip():
                return text
        return ""

    def comment_after(self, offset):
        """The comment that begins on the same line, whatever else stands between."""
        line_end = self.text.find("\n", offset)
        for begin, _, text in self.comments:
            if offset <= begin < line_end:
                return text
        return ""


def place(node):
    """Where a node begins and ends, as it stands in the header."""
    begin, end = node["range"]["begin"], node["range"]["end"]
    begin = begin.get("expansionLoc", begin)
    end = end.get("expansionLoc", end)
    return begin["offset"], end["offset"] + end["tokLen"]


def parsed_type(spelled):
    """const, base and number of stars of a C type; the const that counts is the innermost one."""
    match = re.fullmatch(r"(const )?(?:struct )?(\w+) ?(\*(?:const )?\*?)?", spelled)
    if not match:
        raise HeaderError(f"type '{spelled}': no rule for it")
    return bool(match[1]), match[2], (match[3] or "").count("*")


def is_many(name):
    word = name.removeprefix("out_")
    return word in MANY or (word.endswith("s") and word not in SINGULAR)


def role_of(param, following, handles, structs):
    """What a parameter is for; README.md says what each language makes of each."""
    base, pointers, const = param["base"], param["pointers"], param["const"]
    if pointers == 0:
        return "value"
    if pointers == 2:
        if base not in handles:
            raise HeaderError(f"parameter {param['name']}: a pointer to a pointer to {base}")
        return "handles" if const else "out_handle"
    if base in handles:
        return "handle"
    if base == "void":
        return "bytes" if const else "out_bytes"
    if base == "char":
        if not const:
            return "out_text"
        return "text" if following == "size" else "string"
    if "length" in param or is_many(param["name"]):
        return "array" if const else "out_array"
    if base in structs:
        return "struct" if const else "out_struct"
    return "out_value"


def read_parameter(node, text):
    const, base, pointers = parsed_type(node["type"]["qualType"])
    begin, end = place(node)
    param = {"name": node["name"], "type": node["type"]["qualType"],
             "base": ALIASES.get(base, base), "const": const, "pointers": pointers}
    extent = re.search(r"\[(\w+)\]$", text.text[begin:end])
    if extent:
        param["length"] = extent[1]
    return param


def read_function(node, text, handles, structs):
    params = [read_parameter(n, text) for n in node.get("inner", []) if n["kind"] == "ParmVarDecl"]
    names = [p["name"] for p in params] + [""]
    for index, param in enumerate(params):
        param["role"] = role_of(param, names[index + 1], handles, structs)
        if (node["name"], param["name"]) in IN_PLACE:
            param["role"] = "inout_array"
    roles = {p["role"] for p in params}
    lengths = {"count", "capacity", "size"} & set(names)
    init = node["name"].endswith("_init")
    if lengths and not init and not roles & {"array", "out_array", "inout_array", "bytes",
                                             "out_bytes", "text", "out_text"}:
        raise HeaderError(f"{node['name']}: has {lengths} but no array")
    returned = node["type"]["qualType"].split("(")[0].strip()
    const, base, pointers = parsed_type(returned)
    return {"name": node["name"], "comment": text.comment_before(place(node)[0]),
            "returns": {"type": returned, "base": ALIASES.get(base, base), "const": const,
                        "pointers": pointers},
            "params": params}


def read_fields(record, text):
    for node in record.get("inner", []):
        if node["kind"] != "FieldDecl":
            continue
        match = re.fullmatch(r"(\w+)(?:\[(\d+)\])?", node["type"]["qualType"])
        if not match:
            raise HeaderError(f"{record['name']}.{node['name']}: type {node['type']['qualType']}")
        end = place(node)[1]
        # Several names of one declaration share its comment.
        yield {"name": node["name"], "type": match[1],
               **({"length": int(match[2])} if match[2] else {}),
               "comment": text.comment_after(end)}


def read_constants(text):
    for match in re.finditer(r"^#define (PKC_\w+) (?!__attribute__)(\S.*)$", text.text,
                             re.MULTILINE):
        yield {"name": match[1], "comment": text.comment_after(match.start(2))}


def measure(path, api):
    """Fills in the values of constants, and sizes and offsets, as the C compiler has them."""
    lines = ["#include <packcell.h>", "#include <stdio.h>",
             '#define TYPE(x) _Generic((x), int: "int32_t", unsigned: "uint32_t", default: "?")',
             "int main(void) {"]
    for constant in api["constants"]:
        name = constant["name"]
        lines.append(f'printf("%s %lld\\n", TYPE({name}), (long long){name});')
    for struct in api["structs"]:
        name = struct["name"]
        lines.append(f'printf("%zu %zu\\n", sizeof({name}), _Alignof({name}));')
        for field in struct["fields"]:
            member = f"{name}, {field['name']}"
            lines.append(f'printf("%zu %zu\\n", offsetof({member}), sizeof((({name} *)0)->'
                         f'{field["name"]}));')
    lines += ["return 0;", "}", ""]
    with tempfile.TemporaryDirectory() as folder:
        program = pathlib.Path(folder) / "measure"
        source = program.with_suffix(".c")
        source.write_text("\n".join(lines), encoding="utf-8")
        compiler = os.environ.get("CC", "cc").split()
        run([*compiler, "-std=c11", f"-I{path.parent}", str(source), "-o", str(program)])
        measured = iter(run([str(program)]).splitlines())
    for constant in api["constants"]:
        kind, value = next(measured).split()
        if kind not in SCALARS:
            raise HeaderError(f"{constant['name']}: neither an int nor an unsigned")
        constant.update(type=kind, value=int(value), comment=constant.pop("comment"))
    for struct in api["structs"]:
        size, align = map(int, next(measured).split())
        struct.update(size=size, align=align)
        for field in struct["fields"]:
            offset, size = map(int, next(measured).split())
            field.update(offset=offset, size=size, comment=field.pop("comment"))
        struct["fields"] = struct.pop("fields")


def read(path):
    """Everything that the header offers, as README.md describes api.json."""
    text = Text(path)
    tree = json.loads(run(["clang", "-std=c11", "-Xclang", "-ast-dump=json", "-fsyntax-only",
                           "-x", "c", str(path)]))
    own = [n for n in tree["inner"] if n.get("name", "").startswith("pkc_")]
    functions = [n for n in own if n["kind"] == "FunctionDecl"]
    names = {n["name"] for n in functions}
    whole = {n["name"]: n for n in own if n["kind"] == "RecordDecl" and n.get("completeDefinition")}
    opaque = [n for n in own if n["kind"] == "TypedefDecl" and n["name"] not in whole
              and n["name"] not in ALIASES]
    handles = [{"name": n["name"], "free": f"{n['name']}_free",
                "comment": text.comment_before(place(n)[0])} for n in opaque]
    for handle in handles:
        if handle["free"] not in names:
            raise HeaderError(f"{handle['name']}: no {handle['free']}")
    structs = []
    for name, node in whole.items():
        fields = list(read_fields(node, text))
        versioned = fields[0]["name"] == "struct_size"
        # pkc_queue_info has pkc_queue_info_init, and so on.
        init = f"{name}_init" if f"{name}_init" in names else None
        if versioned != (init is not None):
            raise HeaderError(f"{name}: struct_size and {name}_init come together")
        structs.append({"name": name, "init": init, "comment": text.comment_before(place(node)[0]),
                        "fields": fields})
    known = SCALARS | {h["name"] for h in handles} | set(whole)
    api = {"version": None, "constants": list(read_constants(text)), "handles": handles,
           "structs": structs,
           "functions": [read_function(n, text, {h["name"] for h in handles}, set(whole))
                         for n in functions]}
    for function in api["functions"]:
        for thing in [function["returns"], *function["params"]]:
            if thing["base"] not in known:
                raise HeaderError(f"{function['name']}: type {thing['type']}")
    measure(path, api)
    values = {c["name"]: c["value"] for c in api["constants"]}
    api["version"] = ".".join(str(values[f"PKC_VERSION_{p}"]) for p in ("MAJOR", "MINOR", "PATCH"))
    for function in api["functions"]:
        for param in function["params"]:
            if "length" in param:
                length = param["length"]
                param["length"] = int(length) if length.isdigit() else values[length]
    api["statuses"] = [c["name"] for c in api["constants"]
                       if c["name"] == "PKC_OK" or c["name"].startswith("PKC_E_")]
    return api


def layout_lines(api):
    """`struct size align` and `struct.field offset size`: what a binding's layout is held to."""
    lines = []
    for struct in api["structs"]:
        lines.append(f"{struct['name']} {struct['size']}")
        lines += [f"{struct['name']}.{f['name']} {f['offset']}" for f in struct["fields"]]
    return lines
