"""A PLC as an integrator would write it from docs/gateway.md, over pymodbus."""
import time

from pymodbus.client import ModbusTcpClient
from pymodbus.exceptions import ModbusException

from harness import PATIENCE, check, within

ARRIVED, PLAN, PLACED, FAILED, UNPACKED, CHANGED, JOB_START, JOB_END, RESOLVE, GONE = range(1, 11)
PACK, UNPACK, TERMINATE, SKIP = 1, 2, 3, 4
CONFLICT, SEQ_GAP, UNKNOWN_CODE, BAD_PAYLOAD, WRONG_STATE, UNRESOLVED, JOURNAL = range(1, 8)

STATES = ("Clearing Stopped Starting Idle Suspended Execute Stopping Aborting Aborted Holding Held "
          "Unholding Suspending Unsuspending Resetting Completing Complete").split()
COMMANDS = "Reset Start Stop Hold Unhold Suspend Unsuspend Abort Clear Complete".split()

LINK, STATUS, IDENTITY = 96, 200, 1000
HEARTBEAT, CANCEL, CONTROL, REQUEST, PAGES = 96, 97, 98, 99, 100
STATE, ACK, RESULT, REJECT, DEPTH, AGE = 205, 207, 209, 210, 215, 216
BIN_ITEMS, BELT_ITEMS, BUFFER_ITEMS = 221, 222, 223
COMMAND_WORDS = 48


class Lost(Exception):
    """The gateway does not answer."""


class Refused(Exception):
    """A Modbus exception."""

    def __init__(self, code):
        super().__init__("Modbus exception %d" % code)
        self.code = code


def words32(value):
    return [value >> 16, value & 0xFFFF]


class Action:
    def __init__(self, words):
        self.code = words[0]
        self.item = words[1] << 16 | words[2]
        self.x, self.y, self.rot, self.arm = words[3:7]


class Plc:
    """One connection; commands go by the channel of one arm."""

    def __init__(self, port, arm=0, source=None, host="127.0.0.1", seconds=PATIENCE):
        self.arm = arm
        self.client = ModbusTcpClient(host, port=port, timeout=seconds, retries=0,
                                      source_address=(source, 0) if source else None)
        if not self.client.connect():
            raise Lost("no connection")
        self.seq = self.ack()

    def close(self):
        self.client.close()

    def _answer(self, ask):
        try:
            answer = ask()
        except (ModbusException, OSError) as error:
            raise Lost(str(error)) from error
        if answer.isError():
            if hasattr(answer, "exception_code"):
                raise Refused(answer.exception_code)
            raise Lost(str(answer))
        return answer

    def read(self, address, count=1):
        answer = self._answer(lambda: self.client.read_holding_registers(address, count, slave=1))
        return answer.registers

    def write(self, address, *values):
        self._answer(lambda: self.client.write_registers(address, list(values), slave=1))

    # ---- Handshake -------------------------------------------------------------------------------
    def ack(self):
        return self.read(ACK + 4 * self.arm)[0]

    def block(self, number, code, *payload, flags=0, tail=None):
        words = [number, code, flags, *payload]
        words += [0] * (COMMAND_WORDS - 1 - len(words))
        return words + [number if tail is None else tail]

    def next_number(self):
        return self.seq % 65535 + 1

    def send(self, code, *payload, flags=0):
        """The next command; 0 or its reject code."""
        number = self.next_number()
        self.write(COMMAND_WORDS * self.arm, *self.block(number, code, *payload, flags=flags))
        ack, _, _, reject = self.read(ACK + 4 * self.arm, 4)
        if ack == number:
            self.seq = number
            return 0
        return reject

    def must(self, code, *payload, flags=0):
        reject = self.send(code, *payload, flags=flags)
        check(reject == 0, "command %d %s: reject %d" % (code, payload, reject))

    def arrive(self, item, w, h, flags=0):
        self.must(ARRIVED, *words32(item), w, h, flags=flags)

    def wait_done(self):
        """Until the last command's work has ended; the result."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            _, done, result, _ = self.read(ACK + 4 * self.arm, 4)
            if done == self.seq:
                return result
            time.sleep(0.001)  # polling without a pause would take the gateway's time
        check(False, "done_seq does not come")
        return 0

    def plan(self, deadline):
        """PLAN_NEXT; its result, and the actions."""
        self.must(PLAN, deadline)
        result = self.wait_done()
        return result, self.actions() if result in (1, 2) else []

    def actions(self):
        """All pages of the result."""
        found, page = [], 0
        while True:
            self.write(PAGES + self.arm, page)
            words = self.read(300 + 100 * self.arm, 64)
            check(words[0] == words[63], "a torn result though one alone writes")
            check(words[2] == page, "page %d of the result: %d" % (page, words[2]))
            count, pages = words[1], words[3]
            for i in range(min(7, count - 7 * page)):
                found.append(Action(words[4 + 8 * i:12 + 8 * i]))
            page += 1
            if page >= pages:
                check(len(found) == count, "%d actions of %d" % (len(found), count))
                return found

    def carry_out(self, action):
        """What the arms do, reported. 0 or the reject code."""
        item = words32(action.item)
        if action.code == PACK:
            return self.send(PLACED, *item, action.x, action.y, action.rot)
        if action.code == UNPACK:
            return self.send(UNPACKED, *item)
        return 0

    # ---- PackML ----------------------------------------------------------------------------------
    def state(self):
        return STATES[self.read(STATE)[0] - 1]

    def command(self, name):
        self.write(CONTROL, COMMANDS.index(name) + 1, 1)
        self.write(REQUEST, 0)

    def reaches(self, state):
        return within(lambda: self.state() == state, "state %s" % state)

    def bring(self, state):
        """Into a waiting state, from anywhere."""
        way = {"Aborted": [], "Stopped": ["Clear"], "Idle": ["Clear", "Reset"]}
        way["Execute"] = way["Idle"] + ["Start"]
        for name, last in (("Held", "Hold"), ("Suspended", "Suspend"), ("Complete", "Complete")):
            way[name] = way["Execute"] + [last]
        if self.state() != "Aborted":
            self.command("Abort")
        self.reaches("Aborted")
        ends = {"Clear": "Stopped", "Reset": "Idle", "Start": "Execute", "Hold": "Held",
                "Suspend": "Suspended", "Complete": "Complete"}
        for name in way[state]:
            self.command(name)
            self.reaches(ends[name])

    def beat(self):
        self.write(HEARTBEAT, (self.read(HEARTBEAT)[0] + 1) % 65536)
