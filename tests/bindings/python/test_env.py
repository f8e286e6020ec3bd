"""The environments: their protocol, and that the vectorised one plays like the other."""
import random
import unittest

from setting import numpy

import packcell
from packcell.env import PackingEnv

PROTOCOLS = [
    {},
    {"rotation": True, "reward_fill": 0.25},
    {"w": 5, "h": 4, "most_side": 4, "items": 12, "reward_fill": 1.0},
    {"w": 4, "h": 4, "most_side": 2, "items": 40},
    {"w": 20, "h": 33, "most_side": 10},
    {"w": 62, "h": 31, "least_side": 8, "most_side": 20, "rotation": True},
]


def allowed(mask):
    return [at for at, bit in enumerate(mask) if bit]


class PackingEnvTest(unittest.TestCase):
    def test_an_episode(self):
        chooser = random.Random(1)
        for protocol in PROTOCOLS:
            env = PackingEnv(**protocol)
            observation, info = env.reset(seed=3)
            total = 0.0
            for _ in range(1000):
                actions = allowed(info["action_mask"])
                self.assertNotIn(env.protocol.positions, actions)
                before = env.bin.info.occupied_cells
                w, h = map(int, observation["item"])
                observation, reward, terminated, truncated, info = env.step(chooser.choice(actions))
                self.assertEqual(env.bin.info.occupied_cells, before + w * h)
                self.assertEqual(sum(map(sum, observation["bin"])), before + w * h)
                self.assertFalse(truncated)
                total += reward
                if terminated:
                    break
            self.assertTrue(terminated)
            self.assertEqual(allowed(info["action_mask"]), [env.protocol.positions])
            self.assertGreater(total, 0)
            with self.assertRaises(packcell.StateError):
                env.step(0)
            env.close()

    def test_rewards(self):
        env = PackingEnv(4, 4, least_side=2, most_side=2, reward_fill=0.5)
        env.reset(seed=0)
        rewards = [env.step(at)[1] for at in (0, 2, 8, 10)]
        # 4, 6, 6 and 8 cells of contact; the last fills and closes the bin
        self.assertEqual([round(r, 9) for r in rewards], [0.1, 0.15, 0.15, 0.7])

    def test_equal_seeds_equal_items_and_the_last_item_is_carried(self):
        first, second = PackingEnv(), PackingEnv()
        one, two = first.reset(seed=9), second.reset(seed=9)
        for _ in range(200):
            self.assertEqual(list(one[0]["item"]), list(two[0]["item"]))
            at = allowed(one[1]["action_mask"])[0]
            one, two = first.step(at), second.step(at)
            if one[2]:
                last = list(one[0]["item"])
                one, two = first.reset(), second.reset()
                self.assertEqual(list(one[0]["item"]), last)
            one, two = (one[0], one[-1]), (two[0], two[-1])

    def test_bad_input(self):
        env = PackingEnv()
        with self.assertRaises(packcell.StateError):
            env.step(0)
        env.reset(seed=1)
        for action in (-1, 101, 100, 99):
            with self.assertRaises(packcell.ArgumentError):
                env.step(action)
        with self.assertRaises(TypeError):
            env.step("1")
        with self.assertRaises(packcell.ArgumentError):
            env.reset(seed=-1)
        with self.assertRaises(packcell.ArgumentError):
            env.reset(options={"colour": 1})
        for wrong in ({"w": 0}, {"w": 129}, {"most_side": 11}, {"least_side": 6}, {"items": -1},
                      {"reward_fill": 2.0}, {"render_mode": "human"}):
            with self.assertRaises(ValueError):
                PackingEnv(**wrong)
        with self.assertRaises(TypeError):
            PackingEnv(w="10")

    def test_text_and_spaces(self):
        env = PackingEnv(3, 3, least_side=3, most_side=3)
        _, info = env.reset(seed=1)
        self.assertEqual(env.render(), "...\n...\n...")
        self.assertEqual(env.action_space.sample(mask=info["action_mask"]), 0)
        env.step(0)
        self.assertEqual(env.render(), "AAA\nAAA\nAAA")
        self.assertEqual(env.action_space.n, 10)


@unittest.skipIf(numpy is None, "NumPy is not here")
class VectorPackingEnvTest(unittest.TestCase):
    def test_it_plays_like_single_ones(self):
        from packcell.env import VectorPackingEnv
        chooser = random.Random(2)
        for protocol in PROTOCOLS:
            many = VectorPackingEnv(4, **protocol)
            singles = [PackingEnv(**protocol) for _ in range(4)]
            observations, infos = many.reset(seed=[7, 8, 9, 7])
            now = [env.reset(seed=seed) for env, seed in zip(singles, (7, 8, 9, 7))]
            bins = 0
            for _ in range(120):
                for i, (observation, info) in enumerate(now):
                    for name in ("bin", "item"):
                        self.assertTrue((observation[name] == observations[name][i]).all())
                    self.assertTrue((info["action_mask"] == infos["action_mask"][i]).all())
                actions = [chooser.choice(allowed(mask)) for mask in infos["action_mask"]]
                observations, rewards, terminated, _, infos = many.step(numpy.array(actions))
                for i, env in enumerate(singles):
                    observation, reward, done, _, info = env.step(actions[i])
                    self.assertAlmostEqual(reward, rewards[i])
                    self.assertEqual(done, terminated[i])
                    self.assertAlmostEqual(info["utilization"], infos["utilization"][i])
                    self.assertEqual(info["contact"], infos["contact"][i])
                    now[i] = env.reset() if done else (observation, info)
                    bins += done
            self.assertGreater(bins, 3)

    def test_streams_differ_and_repeat(self):
        from packcell.env import VectorPackingEnv
        env = VectorPackingEnv(64)
        items = env.reset(seed=1)[0]["item"]
        self.assertGreater(len(set(map(tuple, items))), 10)
        self.assertTrue((env.reset(seed=1)[0]["item"] == items).all())
        self.assertTrue((env.reset()[0]["item"] == items).all())
        self.assertTrue((items[0] == PackingEnv().reset(seed=1)[0]["item"]).all())

    def test_bad_input(self):
        from packcell.env import VectorPackingEnv
        env = VectorPackingEnv(2)
        with self.assertRaises(packcell.StateError):
            env.step(numpy.zeros(2, int))
        env.reset(seed=1)
        for actions in ([0], [[0, 0]], [0, 101], [-1, 0], [100, 0], [0, 99]):
            with self.assertRaises(packcell.ArgumentError):
                env.step(numpy.array(actions))
        with self.assertRaises(TypeError):
            env.step(numpy.zeros(2))
        with self.assertRaises(packcell.ArgumentError):
            env.reset(seed=[1])
        for wrong in ({"num_envs": 0}, {"num_envs": 2, "w": 63}, {"num_envs": 2, "items": -1}):
            with self.assertRaises(packcell.ArgumentError):
                VectorPackingEnv(**wrong)
        self.assertTrue(env.step(numpy.zeros(2, numpy.int64))[1].all())


@unittest.skipUnless(numpy is None, "NumPy is here")
class WithoutNumpyTest(unittest.TestCase):
    def test_the_vectorised_one_says_what_it_needs(self):
        with self.assertRaises(ImportError):
            from packcell.env import VectorPackingEnv  # noqa: F401


if __name__ == "__main__":
    unittest.main()
