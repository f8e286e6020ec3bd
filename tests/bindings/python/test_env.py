"""The environments: their protocol, and that the vectorised one plays like the other."""
import copy
import random
import unittest

from setting import numpy

import packcell
from packcell.env import PackingEnv, VectorPackingEnv

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
    {"w": 128, "h": 31, "least_side": 8, "most_side": 20, "rotation": True},
]


def allowed(mask):
    return [at for at, bit in enumerate(mask) if bit]


def taken(observation):
    return int(sum(map(sum, observation["bin"])))


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
                before = taken(observation)
                w, h = map(int, observation["item"])
                observation, reward, terminated, truncated, info = env.step(chooser.choice(actions))
                self.assertEqual(taken(observation), before + w * h)
                cells = env.protocol.w * env.protocol.h
                self.assertEqual(info["utilization"], taken(observation) / cells)
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
        observation, _, _, _, info = env.step(allowed(info["action_mask"])[0])
        other = copy.deepcopy(env)
        action = allowed(info["action_mask"])[-1]
        one, two = env.step(action), other.step(action)
        self.assertGreater(taken(one[0]), taken(observation))
        self.assertEqual(taken(one[0]), taken(two[0]))
        self.assertEqual(list(one[0]["item"]), list(two[0]["item"]))
        env.reset()
        self.assertEqual(other.environment.info.steps, 2)
        self.assertEqual(sum(map(sum, other.environment.observe().cells[0])), taken(two[0]))

    def test_the_mask_is_a_bin_s(self):
        env = PackingEnv(7, 5, most_side=5, rotation=True)
        observation, info = env.reset(seed=2)
        closed = False
        while not closed:
            bin = packcell.Bin(7, 5)
            for y, row in enumerate(observation["bin"]):
                for x, cell in enumerate(row):
                    if cell:
                        bin.block(x, y, 1, 1)
            w, h = map(int, observation["item"])
            upright, turned = (list(map(int, bin.feasible(*size)))[:-1]
                               for size in ((w, h), (h, w)))
            if w == h:
                turned = [0] * len(turned)  # the same places again
            self.assertEqual(list(info["action_mask"]), upright + turned + [0])
            observation, _, closed, _, info = env.step(allowed(info["action_mask"])[-1])

    def test_a_step_that_was_interrupted_asks_for_a_reset(self):
        def busy(_):
            raise packcell.BusyError(packcell.Status.BUSY, "another thread looks at the bin")
        env = PackingEnv()
        _, info = env.reset(seed=1)
        told, env._told = env._told, busy
        at = allowed(info["action_mask"])[0]
        with self.assertRaises(packcell.BusyError):
            env.step(at)
        env._told = told
        with self.assertRaises(packcell.StateError):
            env.step(at)
        self.assertEqual(taken(env.reset()[0]), 0)

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
        self.assertEqual(env.render(), "###\n###\n###")
        self.assertEqual(env.action_space.n, 10)


@unittest.skipIf(numpy is None, "NumPy is not here")
class VectorPackingEnvTest(unittest.TestCase):
    def test_it_plays_like_single_ones(self):
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
        for wrong in ({"num_envs": 0}, {"num_envs": 2, "w": 129}, {"num_envs": 65537}, {"num_envs": 2, "items": -1}):
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


class EnvironmentTest(unittest.TestCase):
    def test_steps_and_observations(self):
        environment = packcell.Environment(3, 4, 5, most_side=4, rotation=packcell.Rotation.MIXED)
        environment.reset(seed=5)
        for _ in range(60):
            seen = environment.observe()
            some = environment.observe([2, 0])
            for found, index in zip(range(2), (2, 0)):
                for one, all_of_them in zip(some, seen):
                    self.assertEqual(self.plain(one[found]), self.plain(all_of_them[index]))
            before = self.plain(seen.occupied)
            rewards, contacts, closed = environment.step([allowed(m)[0] for m in seen.mask])
            for i, (w, h) in enumerate(self.plain(seen.sizes)):
                self.assertAlmostEqual(rewards[i], contacts[i] / 20)
                self.assertEqual(environment.observe().occupied[i], before[i] + w * h)
            self.assertEqual(environment.info.closed, sum(map(int, closed)))
            if any(closed):
                with self.assertRaisesRegex(packcell.StateError, "is closed"):
                    environment.step([0, 0, 0])
            environment.open()
        self.assertEqual(environment.info.steps, 180)
        self.assertGreater(environment.info.bins, 10)

    @staticmethod
    def plain(array):
        return array if numpy is None else numpy.asarray(array).tolist()

    def test_seeds(self):
        environment = packcell.Environment(4)
        environment.reset(seeds=[3, 4, 5, 3])
        sizes = self.plain(environment.observe().sizes)
        self.assertEqual(sizes[0], sizes[3])
        environment.reset(seed=3)
        self.assertEqual(self.plain(environment.observe().sizes)[0], sizes[0])
        environment.reset()
        self.assertEqual(self.plain(environment.observe().sizes)[0], sizes[0])
        for wrong in ([], [1], [1, 2, 3, -1]):
            with self.assertRaises(packcell.ArgumentError):
                environment.reset(seeds=wrong)

    def test_a_clone_plays_on_from_there(self):
        environment = packcell.Environment(2)
        environment.step([0, 0])
        clone = copy.copy(environment)
        environment.close()
        self.assertEqual(clone.info.steps, 2)
        self.assertEqual(self.plain(clone.observe().cells)[1][0][0], 1)

    def test_bad_input(self):
        for wrong, told in (({"count": 0}, "count 0: must be 1..65536"), ({"w": 0}, "bin w 0"),
                            ({"reward_fill": float("nan")}, "reward_fill"),
                            ({"rotation": 3}, "rotation 3: must be 0..2")):
            with self.assertRaisesRegex(packcell.ArgumentError, told):
                packcell.Environment(**wrong)
        with self.assertRaisesRegex(packcell.LimitError, "at most 16777216 cells in all"):
            packcell.Environment(65536, 17, 17)
        environment = packcell.Environment(2)
        for actions in ([0], [0, 101], [0, 1 << 31], [], (-1, 0)):
            with self.assertRaises(packcell.ArgumentError):
                environment.step(actions)
        for actions in ("ab", [0, None], 3):
            with self.assertRaises(TypeError):
                environment.step(actions)
        with self.assertRaisesRegex(packcell.ArgumentError, "index 2: must be 0..1"):
            environment.observe([2])
        if numpy is not None:
            for actions in (numpy.array([0, 1 << 40]), numpy.zeros((2, 1), int)):
                with self.assertRaises(packcell.ArgumentError):
                    environment.step(actions)
            with self.assertRaises(TypeError):
                environment.step(numpy.zeros(2))
        self.assertEqual(environment.info.steps, 0)
        environment.close()
        for call in (environment.observe, environment.open, lambda: environment.step([0, 0])):
            with self.assertRaises(packcell.ClosedError):
                call()


@unittest.skipUnless(numpy is None, "NumPy is here")
class WithoutNumpyTest(unittest.TestCase):
    def test_the_vectorised_one_says_what_it_needs(self):
        with self.assertRaisesRegex(ImportError, "needs NumPy"):
            VectorPackingEnv(2)


if __name__ == "__main__":
    unittest.main()
