#!/usr/bin/env python3
"""Low-level decisions a second on one core: packcell's environments beside the same play in plain
Python, with the same streams of items and the same agent (the first position allowed).

    benchmark_env.py [--seconds 2] [--bins 1024] [--at-least DECISIONS]
"""
import argparse
import itertools
import os
import sys
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):  # one core, whatever NumPy is built with
    os.environ[name] = "1"

from packcell.env import PackingEnv, VectorPackingEnv  # noqa: E402


MASK = (1 << 64) - 1
CONTACT_SCALE = 20


def mix64(v):
    """SplitMix64."""
    v = (v + 0x9E3779B97F4A7C15) & MASK
    v = ((v ^ (v >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    v = ((v ^ (v >> 27)) * 0x94D049BB133111EB) & MASK
    return v ^ (v >> 31)


def rotate_left(v, by):
    return (v << by | v >> (64 - by)) & MASK


def drawn_items(seed, most, count):
    """The items of the library's stream 0 of a seed: xoshiro256**."""
    state, v = [], mix64(mix64(seed)) & ~1
    for _ in range(4):
        v = mix64(v)
        state.append(v)

    def side():
        result = rotate_left(state[1] * 5 & MASK, 7) * 9 & MASK
        t = state[1] << 17 & MASK
        state[2] ^= state[0]
        state[3] ^= state[1]
        state[1] ^= state[2]
        state[0] ^= state[3]
        state[2] ^= t
        state[3] = rotate_left(state[3], 45)
        # The library draws again where this would favour a side, once in 10^18 draws.
        return 1 + result % most

    return [(side(), side()) for _ in range(count)]


class PlainEnv:
    """PackingEnv of the default protocol as one writes it first: lists of cells and loops."""

    def __init__(self, items, side=10):
        self.items, self.side = itertools.cycle(items), side

    def reset(self, seed=None):
        if seed is not None:
            self.draw()
        self.grid = [[0] * self.side for _ in range(self.side)]
        return self.observation()

    def draw(self):
        self.item = next(self.items)

    def taken(self, x, y):
        inside = 0 <= x < self.side and 0 <= y < self.side
        return self.grid[y][x] if inside else 1

    def free(self, x, y):
        w, h = self.item
        return not any(any(row[x:x + w]) for row in self.grid[y:y + h])

    def mask(self):
        w, h = self.item
        mask = [0] * (self.side * self.side + 1)
        for y in range(self.side - h + 1):
            for x in range(self.side - w + 1):
                if self.free(x, y):
                    mask[x + y * self.side] = 1
        mask[-1] = int(not any(mask))
        return mask

    def observation(self):
        return {"bin": [row[:] for row in self.grid], "item": self.item}, {
            "action_mask": self.mask()}

    def step(self, action):
        y, x = divmod(action, self.side)
        w, h = self.item
        contact = (sum(self.taken(x + i, y - 1) + self.taken(x + i, y + h) for i in range(w)) +
                   sum(self.taken(x - 1, y + j) + self.taken(x + w, y + j) for j in range(h)))
        for j in range(h):
            self.grid[y + j][x:x + w] = [1] * w
        self.draw()
        observation, info = self.observation()
        return observation, contact / CONTACT_SCALE, bool(info["action_mask"][-1]), False, info


def first_allowed(mask):
    return mask.index(1) if isinstance(mask, list) else int(mask.argmax())


def single(env, seconds):
    """Decisions a second, and the rewards of the first hundred."""
    _, info = env.reset(seed=1)
    rewards, made, begin = [], 0, time.process_time()
    while time.process_time() - begin < seconds or made < 100:
        _, reward, closed, _, info = env.step(first_allowed(info["action_mask"]))
        if made < 100:
            rewards.append(reward)
        if closed:
            _, info = env.reset()
        made += 1
    return made / (time.process_time() - begin), rewards


def vectorised(env, seconds):
    _, infos = env.reset(seed=1)
    rewards, made, begin = [], 0, time.process_time()
    while time.process_time() - begin < seconds or made < 100 * env.num_envs:
        _, reward, _, _, infos = env.step(infos["action_mask"].argmax(axis=1))
        if len(rewards) < 100:
            rewards.append(float(reward[0]))
        made += env.num_envs
    return made / (time.process_time() - begin), rewards


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=2.0, help="of CPU time for each (2)")
    parser.add_argument("--bins", type=int, default=1024, help="side by side (1024)")
    parser.add_argument("--at-least", type=float, default=0, metavar="DECISIONS",
                        help="fail if the vectorised environment makes fewer a second")
    options = parser.parse_args()
    # Drawn beforehand, for it is not what is compared.
    plain, expected = single(PlainEnv(drawn_items(1, 5, 200000)), options.seconds)
    one, same = single(PackingEnv(), options.seconds)
    many, also = vectorised(VectorPackingEnv(options.bins), options.seconds)
    for got in (same, also):
        if any(abs(a - b) > 1e-9 for a, b in zip(expected, got)):
            sys.exit("the environments do not play alike")
    print(f"plain Python                 {plain:9.0f} decisions/s")
    print(f"PackingEnv                   {one:9.0f} decisions/s, {one / plain:6.1f} x")
    print(f"VectorPackingEnv, {options.bins:5} bins {many:9.0f} decisions/s, "
          f"{many / plain:6.1f} x")
    if many < options.at_least:
        sys.exit(f"fewer than {options.at_least:.0f}")


if __name__ == "__main__":
    main()
