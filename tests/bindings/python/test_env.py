"""The environments: their protocol, and that the vectorised one plays like the other."""
import copy
import random
import unittest

from setting import numpy

import packcell
from packcell.env import PackingEnv

try:
    import gymnasium
except ImportError:
    gymnasium = None

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


def added(infos, info, i, count):
    """Puts the info of environment i into the infos of a vector of so many, as Gymnasium's
    documents say: an array a key, dictionaries by the same rule, final_obs as objects, and for each
    key a mask of those that have it."""
    for key, value in info.items():
        if isinstance(value, dict) and key != "final_obs":
            infos[key] = added(infos.get(key, {}), value, i, count)
        elif key == "final_obs":
            infos.setdefault(key, numpy.full(count, None, object))[i] = value
        else:
            one = numpy.asarray(value)
            infos.setdefault(key, numpy.zeros((count, *one.shape), one.dtype))[i] = value
        infos.setdefault("_" + key, numpy.zeros(count, bool))[i] = True
    return infos


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

    def test_a_copy_plays_on_its_own(self):
        env = PackingEnv()
        _, info = env.reset(seed=4)
        env.step(allowed(info["action_mask"])[0])
        other = copy.deepcopy(env)
        for one in (other, env):
            before = one.bin.info.occupied_cells
            observation = one.step(allowed(one._mask)[-1])[0]
            self.assertGreater(one.bin.info.occupied_cells, before)
            self.assertEqual(sum(map(sum, observation["bin"])), one.bin.info.occupied_cells)

    def test_the_mask_is_the_librarys(self):
        env = PackingEnv(7, 5, most_side=5, rotation=True)
        observation, info = env.reset(seed=2)
        closed = False
        while not closed:
            w, h = map(int, observation["item"])
            upright, turned = (list(map(int, env.bin.feasible(*size)))[:-1]
                               for size in ((w, h), (h, w)))
            if w == h:
                turned = [0] * len(turned)  # the same places again
            self.assertEqual(list(info["action_mask"]), upright + turned + [0])
            observation, _, closed, _, info = env.step(allowed(info["action_mask"])[-1])

    def test_a_step_that_was_interrupted_asks_for_a_reset(self):
        def busy():
            raise packcell.BusyError(packcell.Status.BUSY, "another thread looks at the bin")
        env = PackingEnv()
        _, info = env.reset(seed=1)
        fits, env._fits = env._fits, busy
        at = allowed(info["action_mask"])[0]
        with self.assertRaises(packcell.BusyError):
            env.step(at)
        env._fits = fits
        with self.assertRaises(packcell.StateError):
            env.step(at)
        env.reset()
        self.assertEqual(env.bin.info.occupied_cells, 0)

    def test_it_closes_at_the_end_of_a_with(self):
        with PackingEnv() as env:
            env.reset(seed=1)
            self.assertIs(env.unwrapped, env)
        for call in (env.reset, env.render, lambda: env.step(0)):
            with self.assertRaises(packcell.ClosedError):
                call()

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
        for wrong in ({"w": "10"}, {"w": 5.0}, {"items": None}, {"reward_fill": "x"}):
            with self.assertRaises(TypeError):
                PackingEnv(**wrong)
        with self.assertRaises(TypeError):
            env.reset(seed=1.5)
        if numpy is not None:
            self.assertEqual(PackingEnv(numpy.int64(4), numpy.int8(5), most_side=4).protocol[:2],
                             (4, 5))

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
            expected = {}
            for i, (env, seed) in enumerate(zip(singles, (7, 8, 9, 7))):
                added(expected, env.reset(seed=seed)[1], i, 4)
            self.assert_alike(infos, expected)
            bins = 0
            for _ in range(120):
                actions = [chooser.choice(allowed(mask)) for mask in infos["action_mask"]]
                observations, rewards, terminated, truncated, infos = many.step(
                    numpy.array(actions))
                expected = {}
                for i, env in enumerate(singles):
                    observation, reward, done, _, info = env.step(actions[i])
                    self.assertAlmostEqual(reward, rewards[i])
                    self.assertEqual(done, terminated[i])
                    if done:
                        added(expected, {"final_obs": observation, "final_info": info}, i, 4)
                        observation, info = env.reset()
                    added(expected, info, i, 4)
                    self.assert_alike({name: observations[name][i] for name in observations},
                                      observation)
                    bins += done
                self.assert_alike(infos, expected)
                self.assertFalse(truncated.any())
            self.assertGreater(bins, 3)

    def assert_alike(self, found, expected):
        """Equal keys, types of numbers, shapes and values, however deep."""
        self.assertEqual(found.keys(), expected.keys())
        for key, value in expected.items():
            if isinstance(value, dict):
                self.assert_alike(found[key], value)
                continue
            self.assertEqual((found[key].dtype, found[key].shape), (value.dtype, value.shape), key)
            if value.dtype != object:
                self.assertTrue(numpy.allclose(found[key], value, rtol=0, atol=1e-12), key)
                continue
            for one, other in zip(found[key], value):
                self.assertEqual(one is None, other is None)
                if other is not None:
                    self.assert_alike(one, other)

    def test_what_is_given_out_is_the_callers(self):
        from packcell.env import VectorPackingEnv
        env, same = VectorPackingEnv(2, most_side=9), VectorPackingEnv(2, most_side=9)
        _, twin = same.reset(seed=1)
        given = env.reset(seed=1)
        for _ in range(10):
            for array in (*given[0].values(), *given[-1].values()):
                if not isinstance(array, dict):
                    array[...] = 1
            actions = twin["action_mask"].argmax(axis=1)
            given, expected = env.step(actions), same.step(actions)
            twin = expected[-1]
            self.assert_alike(given[0], expected[0])
            self.assert_alike(given[-1], expected[-1])

    def test_streams_differ_and_repeat(self):
        from packcell.env import VectorPackingEnv
        env = VectorPackingEnv(64)
        items = env.reset(seed=1)[0]["item"]
        self.assertGreater(len(set(map(tuple, items))), 10)
        self.assertTrue((env.reset(seed=1)[0]["item"] == items).all())
        self.assertTrue((env.reset()[0]["item"] == items).all())
        self.assertTrue((items[0] == PackingEnv().reset(seed=1)[0]["item"]).all())
        seeds = numpy.arange(64)
        items = env.reset(seed=seeds)[0]["item"]
        self.assertTrue((items == env.reset(seed=list(seeds))[0]["item"]).all())
        self.assertTrue((items[3] == PackingEnv().reset(seed=3)[0]["item"]).all())

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
        for seed in ("ab", 1.5, [1, None], numpy.zeros(2)):
            with self.assertRaises(TypeError):
                env.reset(seed=seed)
        for wrong in ({"num_envs": 0}, {"num_envs": 2, "w": 63}, {"num_envs": 2, "items": -1}):
            with self.assertRaises(packcell.ArgumentError):
                VectorPackingEnv(**wrong)
        self.assertTrue(env.step(numpy.zeros(2, numpy.int64))[1].all())
        env.close()
        for call in (env.reset, lambda: env.step(numpy.zeros(2, numpy.int64))):
            with self.assertRaises(packcell.ClosedError):
                call()


@unittest.skipIf(numpy is None or gymnasium is None, "Gymnasium is not here")
class GymnasiumTest(unittest.TestCase):
    def test_a_single_one(self):
        with PackingEnv(6, 4, most_side=4, rotation=True, render_mode="ansi") as env:
            self.assertIsInstance(env, gymnasium.Env)
            self.assertIn(env.render_mode, env.metadata["render_modes"])
            observation, info = env.reset(seed=numpy.int64(3))
            self.assertIsNotNone(env.np_random)
            closed = False
            while not closed:
                self.assertTrue(env.observation_space.contains(observation))
                action = env.action_space.sample(mask=info["action_mask"])
                observation, reward, closed, truncated, info = env.step(action)
                self.assertIsInstance(reward, float)
                self.assertIs(type(closed), bool)
                self.assertIs(truncated, False)
            self.assertTrue(env.observation_space.contains(observation))
            self.assertIsInstance(env.render(), str)

    def test_a_vectorised_one(self):
        from packcell.env import VectorPackingEnv
        env = VectorPackingEnv(5, 6, 4, most_side=4)
        self.assertIsInstance(env, gymnasium.vector.VectorEnv)
        self.assertEqual(env.metadata["autoreset_mode"], gymnasium.vector.AutoresetMode.SAME_STEP)
        self.assertEqual(env.action_space.shape, (5,))
        observations, infos = env.reset(seed=3)
        self.assertIsNotNone(env.np_random)
        finals = 0
        for _ in range(30):
            self.assertTrue(env.observation_space.contains(observations))
            one = {name: array[0] for name, array in observations.items()}
            self.assertTrue(env.single_observation_space.contains(one))
            actions = infos["action_mask"].argmax(axis=1)
            self.assertTrue(env.action_space.contains(actions))
            observations, rewards, terminated, truncated, infos = env.step(actions)
            for array in (rewards, terminated, truncated):
                self.assertEqual(array.shape, (5,))
            for i in numpy.flatnonzero(terminated):
                final = infos["final_obs"][i]
                self.assertTrue(env.single_observation_space.contains(final))
                finals += 1
        self.assertGreater(finals, 5)
        env.close()
        self.assertTrue(env.closed)


@unittest.skipUnless(numpy is None, "NumPy is here")
class WithoutNumpyTest(unittest.TestCase):
    def test_the_vectorised_one_says_what_it_needs(self):
        with self.assertRaises(ImportError):
            from packcell.env import VectorPackingEnv  # noqa: F401


if __name__ == "__main__":
    unittest.main()
