#!/usr/bin/env python3
"""Made the blobs *.pkw here, by docs/blob-format.md and without packcell: one judges the other.

usage: make_blobs.py FOLDER

weights.pkw              every way to store a tensor; no policy is made of it
actor-critic.pkw         the paper's network for 4 x 3 bins, as small as it gets, not trained
fully-convolutional.pkw  the variant for any bin, likewise
"""
import pathlib
import struct
import sys

ANY_SIZE_STEPS = 16


def fnv1a(data):
    value = 0xCBF29CE484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001B3 % 2**64
    return value


def name(text):
    return text.encode("ascii").ljust(32, b"\0")


def blob(architecture, bin_size, policy, training, tensors):
    """tensors: name, shape, scale (0: float32), numbers."""
    table = b""
    data = b""
    begin = 112 + 64 * len(tensors)
    for label, shape, scale, numbers in tensors:
        table += name(label)
        table += struct.pack("<II", 2 if scale else 1, len(shape))
        table += struct.pack("<4I", *shape, *[0] * (4 - len(shape)))
        table += struct.pack("<fI", scale, begin + len(data))
        data += struct.pack(f"<{len(numbers)}{'h' if scale else 'f'}", *numbers)
        data += b"\0" * (-len(data) % 4)
    learner, seed, steps, reward_fill, utilization = training
    header = struct.pack("<IIII", architecture, *bin_size, len(tensors))
    header += name(policy) + name(learner)
    header += struct.pack("<QQff", seed, steps, reward_fill, utilization)
    whole = b"PKW\1" + struct.pack("<I", begin + len(data) + 8) + header + table + data
    return whole + struct.pack("<Q", fnv1a(whole))


class Numbers:
    """Multiples of 1/64 from -1 to 1, the same on every machine."""

    def __init__(self):
        self.state = 1

    def draw(self):
        self.state = (self.state * 6364136223846793005 + 1442695040888963407) % 2**64
        return (self.state >> 33) % 129 - 64

    def tensor(self, label, shape):
        count = 1
        for side in shape:
            count *= side
        whole = [self.draw() for _ in range(count)]
        if label.endswith(".weight"):
            return label, shape, 1 / 64, whole
        return label, shape, 0.0, [n / 64 for n in whole]


def actor_critic(w, h, channels, features, hidden):
    size = w + h
    shapes = [
        ("conv1.weight", (3, 3, 1, channels)), ("conv1.bias", (channels,)),
        ("conv2.weight", (3, 3, channels, channels)), ("conv2.bias", (channels,)),
        ("encoder.weight", (h - 2, w - 2, channels, features)), ("encoder.bias", (features,)),
        ("join.weight", (features, hidden)), ("join.size", (size, hidden)),
        ("join.bias", (hidden,)),
        ("actor.weight", (hidden, w * h + 1)), ("actor.bias", (w * h + 1,)),
        ("critic.weight", (hidden, 1)), ("critic.bias", (1,)),
    ]
    numbers = Numbers()
    return [numbers.tensor(*shape) for shape in shapes]


def fully_convolutional(channels, hidden):
    size = 2 * ANY_SIZE_STEPS
    shapes = [("conv1.weight", (3, 3, 1, channels)), ("conv1.bias", (channels,)),
              ("conv2.weight", (3, 3, channels, channels)), ("conv2.bias", (channels,))]
    for label in ("conv3", "conv4"):
        shapes += [(label + ".weight", (3, 3, channels, channels)),
                   (label + ".size", (size, channels)), (label + ".bias", (channels,))]
    shapes += [
        ("actor.weight", (channels, 1)), ("actor.bias", (1,)),
        ("head.weight", (channels, hidden)), ("head.size", (size, hidden)),
        ("head.bias", (hidden,)),
        ("nowhere.weight", (hidden, 1)), ("nowhere.bias", (1,)),
        ("critic.weight", (hidden, 1)), ("critic.bias", (1,)),
    ]
    numbers = Numbers()
    return [numbers.tensor(*shape) for shape in shapes]


BLOBS = {
    "weights.pkw": blob(1, (10, 8), "golden", ("by-hand", 2**64 - 1, 500000, 0.25, 0.826), [
        ("head/w.1", (2, 3), 0.0, (0.0, 1.0, -1.5, 3.25, -0.0078125, 65536.0)),
        ("table-2x2_0", (3,), 0.125, (-32768, 7, 32767)),
        ("c", (1, 1, 2, 1), 0.0, (-1e-20, 1e30)),
    ]),
    "actor-critic.pkw": blob(1, (4, 3), "golden-4x3", ("by-hand", 7, 0, 0.5, -1.0),
                             actor_critic(4, 3, 2, 3, 4)),
    "fully-convolutional.pkw": blob(2, (0, 0), "golden-any", ("by-hand", 8, 0, 1.0, -1.0),
                                    fully_convolutional(2, 3)),
}

for file, content in BLOBS.items():
    (pathlib.Path(sys.argv[1]) / file).write_bytes(content)
