"""Clients of four origins agree on what the gateway says and are understood by it alike.

usage: clients_check.py GATEWAY LIBMODBUS_CLIENT NODE_MODULES
"""
import json
import os
import pathlib
import re
import subprocess
import sys

from pymodbus.constants import Endian
from pymodbus.payload import BinaryPayloadDecoder

from harness import PATIENCE, Gateway, check, equal, finish, journal_records, run_gateway, work
from plc import ARRIVED, IDENTITY, STATUS, Plc, words32

HERE = pathlib.Path(__file__).resolve().parent
ITEM = 0x00030001  # read with its words turned round it is another one


def tool(*command):
    """stdout of another program."""
    environment = dict(os.environ, NODE_PATH=sys.argv[3])
    done = subprocess.run([str(part) for part in command], env=environment, capture_output=True,
                          text=True, timeout=2 * PATIENCE, check=False)
    name = os.path.basename(command[0])
    check(done.returncode == 0, "%s: %s" % (name, (done.stdout + done.stderr)[-300:]))
    return done.stdout


def other(*command):
    text = tool(*command)
    return json.loads(text) if text.startswith("{") else None


def with_pymodbus(port, order):
    plc = Plc(port)
    words = plc.read(IDENTITY, 16)
    decoder = BinaryPayloadDecoder.fromRegisters(
        words[4:8], byteorder=Endian.Big, wordorder=Endian.Big if order == "ABCD" else Endian.Little)
    seen = {"version": words[:3], "whole": decoder.decode_32bit_int(),
            "number": round(decoder.decode_32bit_float(), 3), "status": plc.read(STATUS, 3)}
    item = words32(ITEM) if order == "ABCD" else words32(ITEM)[::-1]
    plc.must(ARRIVED, *item, 2, 3)
    plc.close()
    return seen


def with_mbpoll(port, order):
    """mbpoll takes the low word first unless -B says otherwise."""
    turn = ["-B"] if order == "ABCD" else []
    to = ["mbpoll", "-m", "tcp", "-a", "1", "-p", port, "-0", "-1", "-o", "10"]

    def read(first, count, kind, *options):
        text = tool(*to, "-r", first, "-c", count, "-t", kind, *options, "127.0.0.1")
        return [float(v) for v in re.findall(r"^\[\d+\]:\s+(-?[\d.]+)", text, re.M)]

    seen = {"version": [int(v) for v in read(IDENTITY, 3, "4")],
            "whole": int((read(IDENTITY + 4, 1, "4:int", *turn) or [0])[0]),
            "number": round((read(IDENTITY + 6, 1, "4:float", *turn) or [0])[0], 3),
            "status": [int(v) for v in read(STATUS, 3, "4")]}
    equal([int(v) for v in read(IDENTITY, 3, "3")], seen["version"], "mbpoll: input registers")
    number = int(read(207, 1, "4")[0]) + 1
    item = words32(ITEM) if order == "ABCD" else words32(ITEM)[::-1]
    block = [number, ARRIVED, 0, *item, 2, 3] + [0] * 40 + [number]
    tool(*to, "-r", 0, "-t", "4", "127.0.0.1", *block)
    equal([int(v) for v in read(207, 2, "4")], [number, number], "mbpoll: ack_seq and done_seq")
    return seen


def agree(order):
    clients = {
        "pymodbus": with_pymodbus,
        "mbpoll": with_mbpoll,
        "libmodbus": lambda port, turn: other(sys.argv[2], port, turn, ITEM),
        "modbus-serial": lambda port, turn: other("node", HERE / "modbus_serial.js", port, turn,
                                                  ITEM),
    }
    _, version, _ = run_gateway("--version")
    wanted = {"version": [int(v) for v in re.findall(r"\d+", version)[:3]], "whole": 0x01020304,
              "number": 123.456, "status": [0x504B, 1, 2]}
    for name, client in clients.items():
        # A gateway each: an item is known once.
        journal = work / (name + order)
        gateway = Gateway(journal, "--word-order", order)
        what = "%s, %s" % (name, order)
        equal(client(gateway.port, order), wanted, what)
        gateway.end()
        got = [(r["item"], r["w"], r["h"]) for r in journal_records(journal)
               if r["kind"] == "command"]
        equal(got, [(ITEM, 2, 3)], what + ": the item that arrived")


def words():
    """Where each word lies: ids, the float and the counters high word first, unless turned."""
    for order, turn in (("ABCD", 1), ("CDAB", -1)):
        gateway = Gateway(work / ("words" + order), "--word-order", order)
        plc = Plc(gateway.port)
        plc.must(ARRIVED, *words32(ITEM)[::turn], 3, 3)
        plc.bring("Execute")
        equal(plc.plan(1000)[0], 1, "%s: result" % order)
        equal(plc.read(305, 2), words32(ITEM)[::turn], "%s: the id in the result" % order)
        equal(plc.read(IDENTITY + 4, 2), [0x0102, 0x0304][::turn], "%s: the whole number" % order)
        equal(plc.read(IDENTITY + 6, 2), [0x42F6, 0xE979][::turn], "%s: the float" % order)
        equal(plc.read(218, 2)[::turn], [0, 4], "%s: the journal's sequence" % order)
        plc.close()
        gateway.end()


def main():
    agree("ABCD")
    agree("CDAB")
    words()
    finish()


main()
