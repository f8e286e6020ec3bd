// The actor-critic network: its outputs against numbers worked out by hand and against a plain
// reading of the layers, its gradient against finite differences, and the policy made of it.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "base/random.h"
#include "base/status.h"
#include "learn/network_gradient.h"
#include "policy/network_policy.h"

extern "C" {
#include <cmocka.h>
}

namespace {

size_t allocations = 0;

}  // namespace

// Counted, so that a session that touches the heap is found out. Not inline: GCC would take the
// pair for a mismatched one.
__attribute__((noinline)) void *operator new(size_t size) {
    ++allocations;
    void *p = std::malloc(size);
    if (p == nullptr) throw std::bad_alloc();
    return p;
}
__attribute__((noinline)) void operator delete(void *p) noexcept { std::free(p); }
__attribute__((noinline)) void operator delete(void *p, size_t) noexcept { std::free(p); }

namespace packcell {
namespace {

constexpr uint64_t kSeed = 20250801;

NetworkShape shape_of(Architecture architecture, int w, int h, int channels) {
    NetworkShape s;
    s.architecture = architecture;
    s.bin_w = architecture == Architecture::kActorCritic ? w : 0;
    s.bin_h = architecture == Architecture::kActorCritic ? h : 0;
    s.channels = channels;
    s.features = 7;
    s.hidden = 5;
    return s;
}

template <class Scalar>
std::vector<Scalar> random_parameters(const NetworkShape &shape, uint64_t seed) {
    Random random(seed);
    std::vector<Scalar> all(network_size(shape));
    for (const NetworkTensor &t : network_tensors(shape)) {
        const double most = t.inputs > 0 ? std::sqrt(6.0 / static_cast<double>(t.inputs)) : 0.5;
        for (size_t i = 0; i < t.size; ++i) {
            all[t.offset + i] = static_cast<Scalar>((2 * random.unit() - 1) * most);
        }
    }
    return all;
}

// A bin with some items in it.
Bin random_bin(Random &random, int w, int h) {
    Bin bin(w, h);
    for (int tries = 0; tries < w * h / 3; ++tries) {
        const Rect r = {static_cast<int>(random.below(static_cast<uint64_t>(w))),
                        static_cast<int>(random.below(static_cast<uint64_t>(h))),
                        1 + static_cast<int>(random.below(3)),
                        1 + static_cast<int>(random.below(3))};
        if (bin.inside(r) && bin.is_free(r)) bin.block(r);
    }
    return bin;
}

Size random_size(Random &random) {
    return {1 + static_cast<int>(random.below(4)), 1 + static_cast<int>(random.below(4))};
}

// ---- The layers, read plainly ------------------------------------------------------------------

struct Planes {
    int w;
    int h;
    int channels;
    std::vector<double> cells;

    double at(int x, int y, int c, double outside) const {
        if (x < 0 || x >= w || y < 0 || y >= h) return outside;
        return cells[static_cast<size_t>((y * w + x) * channels + c)];
    }
};

double relu(double v) { return v > 0 ? v : 0; }

class PlainNetwork {
public:
    PlainNetwork(const NetworkShape &shape, const std::vector<double> &parameters)
        : shape_(shape), tensors_(network_tensors(shape)), parameters_(parameters) {}

    std::vector<double> logits;
    double value = 0;

    void run(const Bin &bin, Size size) {
        Planes map = {bin.w(), bin.h(), 1, {}};
        for (int y = 0; y < map.h; ++y) {
            for (int x = 0; x < map.w; ++x) {
                map.cells.push_back((bin.row(y) >> x & 1) != 0 ? 1.0 : 0.0);
            }
        }
        std::vector<double> item(static_cast<size_t>(size_inputs(shape_)));
        encode_size(shape_, size, item.data());
        const std::vector<double> none(static_cast<size_t>(shape_.channels));
        Planes planes = convolve("conv1", map, 1, 1.0, none);
        planes = convolve("conv2", planes, 1, 0.0, none);
        if (shape_.architecture == Architecture::kActorCritic) {
            std::vector<double> inner;
            for (int y = 1; y < map.h - 1; ++y) {
                for (int x = 1; x < map.w - 1; ++x) {
                    for (int c = 0; c < shape_.channels; ++c) {
                        inner.push_back(planes.at(x, y, c, 0));
                    }
                }
            }
            std::vector<double> features = product("encoder.weight", inner, shape_.features);
            features = rectified(sum(features, tensor("encoder.bias")));
            const std::vector<double> joined = rectified(
                sum(sum(product("join.weight", features, shape_.hidden), tensor("join.bias")),
                    product("join.size", item, shape_.hidden)));
            logits = sum(product("actor.weight", joined, map.w * map.h + 1), tensor("actor.bias"));
            value = product("critic.weight", joined, 1)[0] + tensor("critic.bias")[0];
            return;
        }
        for (const std::string name : {"conv3", "conv4"}) {
            planes = convolve(name, planes, 2, 0.0,
                              product((name + ".size").c_str(), item, shape_.channels));
        }
        logits.clear();
        std::vector<double> mean(static_cast<size_t>(shape_.channels));
        for (int i = 0; i < map.w * map.h; ++i) {
            std::vector<double> cell;
            for (int c = 0; c < shape_.channels; ++c) {
                cell.push_back(planes.at(i % map.w, i / map.w, c, 0));
                mean[static_cast<size_t>(c)] += cell.back() / (map.w * map.h);
            }
            logits.push_back(product("actor.weight", cell, 1)[0] + tensor("actor.bias")[0]);
        }
        const std::vector<double> joined =
            rectified(sum(sum(product("head.weight", mean, shape_.hidden), tensor("head.bias")),
                          product("head.size", item, shape_.hidden)));
        logits.push_back(product("nowhere.weight", joined, 1)[0] + tensor("nowhere.bias")[0]);
        value = product("critic.weight", joined, 1)[0] + tensor("critic.bias")[0];
    }

private:
    const double *tensor(const char *name) const {
        return parameters_.data() + tensor_offset(tensors_, name);
    }

    static std::vector<double> sum(std::vector<double> a, const double *b) {
        for (double &v : a) v += *b++;
        return a;
    }
    static std::vector<double> sum(std::vector<double> a, const std::vector<double> &b) {
        return sum(std::move(a), b.data());
    }
    static std::vector<double> rectified(std::vector<double> a) {
        for (double &v : a) v = relu(v);
        return a;
    }

    std::vector<double> product(const char *name, const std::vector<double> &in, int out) const {
        std::vector<double> result(static_cast<size_t>(out));
        const double *weight = tensor(name);
        for (const double v : in) {
            for (double &r : result) r += v * *weight++;
        }
        return result;
    }

    // Reach 1 is a usual 3x3 convolution; at 2 the nine cells lie two apart.
    Planes convolve(const std::string &name, const Planes &in, int reach, double outside,
                    const std::vector<double> &added) const {
        Planes out = {in.w, in.h, shape_.channels, {}};
        const double *weight = tensor((name + ".weight").c_str());
        const double *bias = tensor((name + ".bias").c_str());
        for (int i = 0; i < in.w * in.h; ++i) {
            for (int c = 0; c < out.channels; ++c) {
                double v = bias[c] + added[static_cast<size_t>(c)];
                for (int k = 0; k < 9 * in.channels; ++k) {
                    const int tap = k / in.channels;
                    v += weight[k * out.channels + c] * in.at(i % in.w + (tap % 3 - 1) * reach,
                                                              i / in.w + (tap / 3 - 1) * reach,
                                                              k % in.channels, outside);
                }
                out.cells.push_back(relu(v));
            }
        }
        return out;
    }

    NetworkShape shape_;
    std::vector<NetworkTensor> tensors_;
    std::vector<double> parameters_;
};

struct Case {
    Architecture architecture;
    int w, h, channels;
};

const Case kCases[] = {
    {Architecture::kActorCritic, 3, 3, 2},         {Architecture::kActorCritic, 7, 5, 3},
    {Architecture::kActorCritic, 10, 10, 16},      {Architecture::kActorCritic, 6, 9, 32},
    {Architecture::kFullyConvolutional, 1, 1, 3},  {Architecture::kFullyConvolutional, 2, 7, 4},
    {Architecture::kFullyConvolutional, 8, 6, 16}, {Architecture::kFullyConvolutional, 20, 3, 5}};

void the_outputs_are_those_of_the_layers_read_plainly(void **) {
    Random random(kSeed);
    for (const Case &c : kCases) {
        const NetworkShape shape = shape_of(c.architecture, c.w, c.h, c.channels);
        const auto parameters = random_parameters<double>(shape, random.next());
        const std::vector<float> floats(parameters.begin(), parameters.end());
        PlainNetwork plain(shape, parameters);
        const Network network(shape, floats.data());
        Network::Scratch scratch;
        network.prepare(c.w, c.h, scratch);
        std::vector<float> encoding(network.encoding_size(c.w, c.h));
        std::vector<float> logits(static_cast<size_t>(c.w * c.h + 1));
        for (int k = 0; k < 20; ++k) {
            const Bin bin = random_bin(random, c.w, c.h);
            const Size size = k == 0 ? Size{c.w, c.h} : random_size(random);
            plain.run(bin, size);
            float value = 0;
            network.encode(bin, encoding.data(), scratch);
            network.evaluate(c.w, c.h, encoding.data(), size, logits.data(), &value, scratch);
            assert_float_equal(value, plain.value, 1e-4);
            for (size_t i = 0; i < logits.size(); ++i) {
                assert_float_equal(logits[i], plain.logits[i], 1e-4);
            }
        }
    }
}

void many_samples_at_once_give_what_each_gives_alone(void **) {
    Random random(kSeed + 1);
    for (const Case &c : kCases) {
        const NetworkShape shape = shape_of(c.architecture, c.w, c.h, c.channels);
        const auto parameters = random_parameters<double>(shape, random.next());
        PlainNetwork plain(shape, parameters);
        constexpr int kCount = 9;
        std::vector<Bin> bins;
        std::vector<Row> rows;
        std::vector<Size> sizes;
        for (int k = 0; k < kCount; ++k) {
            bins.push_back(random_bin(random, c.w, c.h));
            for (int y = 0; y < c.h; ++y) rows.push_back(bins.back().row(y));
            sizes.push_back(random_size(random));
        }
        NetworkGradient<double> gradient(shape, c.w, c.h, kCount);
        gradient.begin(parameters.data());
        gradient.forward(rows.data(), sizes.data(), kCount);
        for (int k = 0; k < kCount; ++k) {
            plain.run(bins[static_cast<size_t>(k)], sizes[static_cast<size_t>(k)]);
            assert_true(std::fabs(gradient.values()[k] - plain.value) < 1e-12);
            for (int i = 0; i <= c.w * c.h; ++i) {
                assert_true(std::fabs(gradient.logits()(k, i) -
                                      plain.logits[static_cast<size_t>(i)]) < 1e-12);
            }
        }
    }
}

// Channels that are and are not a multiple of the vectors, rows longer and shorter than the
// neighbours that are reckoned together.
const Case kWidthCases[] = {
    {Architecture::kActorCritic, 4, 5, 1},          {Architecture::kActorCritic, 12, 9, 23},
    {Architecture::kFullyConvolutional, 5, 5, 8},   {Architecture::kFullyConvolutional, 4, 9, 16},
    {Architecture::kFullyConvolutional, 11, 6, 21}, {Architecture::kFullyConvolutional, 13, 2, 64}};

// Where the processor has no wider vectors, both are the same.
void all_widths_of_vectors_give_the_same_bits(void **) {
    Random random(kSeed + 5);
    for (const Case &c : kWidthCases) {
        NetworkShape shape = shape_of(c.architecture, c.w, c.h, c.channels);
        shape.features = 101;
        shape.hidden = 77;
        const auto parameters = random_parameters<float>(shape, random.next());
        const size_t actions = static_cast<size_t>(c.w * c.h + 1);
        std::vector<std::vector<float>> found;
        const Bin bin = random_bin(random, c.w, c.h);
        const Size size = random_size(random);
        for (const VectorWidth width : {VectorWidth::kUsual, VectorWidth::kAvx}) {
            const Network network(shape, parameters.data(), network_kernels(width));
            Network::Scratch scratch;
            network.prepare(c.w, c.h, scratch);
            std::vector<float> encoding(network.encoding_size(c.w, c.h));
            std::vector<float> outputs(actions + 1);
            network.encode(bin, encoding.data(), scratch);
            network.evaluate(c.w, c.h, encoding.data(), size, outputs.data(), &outputs[actions],
                             scratch);
            found.push_back(std::move(outputs));
        }
        assert_memory_equal(found[0].data(), found[1].data(), found[0].size() * sizeof(float));
    }
}

// All weights 0 but a few, so that every number can be followed by eye.
void a_network_small_enough_is_worked_out_by_hand(void **) {
    NetworkShape shape = shape_of(Architecture::kActorCritic, 3, 3, 1);
    shape.features = 1;
    shape.hidden = 1;
    std::vector<float> p(network_size(shape));
    const auto tensors = network_tensors(shape);
    const auto set = [&](const char *name, size_t index, float value) {
        p[tensor_offset(tensors, name) + index] = value;
    };
    set("conv1.weight", 4, 2.0f);                                         // 2 x the cell itself
    set("conv1.bias", 0, 1.0f);                                           // + 1
    for (size_t tap = 0; tap < 9; ++tap) set("conv2.weight", tap, 1.0f);  // sum of the nine
    set("encoder.weight", 0, 0.5f);
    set("join.weight", 0, 1.0f);
    set("join.size", 0, 10.0f);       // every item is wider than 0
    set("join.size", 1, 20.0f);       // w above 1
    set("join.size", 3 + 2, 100.0f);  // h above 2
    set("join.bias", 0, -1.0f);
    for (size_t i = 0; i < 10; ++i) set("actor.weight", i, static_cast<float>(i));
    set("actor.bias", 9, 7.0f);
    set("critic.weight", 0, -1.0f);
    set("critic.bias", 0, 3.0f);

    Bin bin(3, 3);
    bin.block({0, 0, 2, 2});  // conv1: 3 on four cells, 1 on five; conv2: 17 at the centre
    const Network network(shape, p.data());
    Network::Scratch scratch;
    network.prepare(3, 3, scratch);
    std::vector<float> encoding(network.encoding_size(3, 3));
    float logits[10];
    float value = 0;
    network.encode(bin, encoding.data(), scratch);
    network.evaluate(3, 3, encoding.data(), {2, 1}, logits, &value, scratch);
    const float joined = 0.5f * 17 + 10 + 20 - 1;  // 37.5
    for (int i = 0; i < 9; ++i) assert_float_equal(logits[i], joined * static_cast<float>(i), 1e-4);
    assert_float_equal(logits[9], joined * 9 + 7, 1e-3);
    assert_float_equal(value, 3 - joined, 1e-4);
    network.evaluate(3, 3, encoding.data(), {1, 3}, logits, &value, scratch);
    assert_float_equal(value, 3 - (0.5f * 17 + 10 + 100 - 1), 1e-3);
}

// ---- Gradient ----------------------------------------------------------------------------------

void the_gradient_agrees_with_finite_differences(void **) {
    Random random(kSeed + 2);
    for (const Case &c : kCases) {
        if (c.channels > 5) continue;
        const NetworkShape shape = shape_of(c.architecture, c.w, c.h, c.channels);
        auto parameters = random_parameters<double>(shape, random.next());
        constexpr int kCount = 6;
        std::vector<Row> rows;
        std::vector<Size> sizes;
        for (int k = 0; k < kCount; ++k) {
            const Bin bin = random_bin(random, c.w, c.h);
            for (int y = 0; y < c.h; ++y) rows.push_back(bin.row(y));
            sizes.push_back(random_size(random));
        }
        // A loss with first and second powers of every output.
        using Gradient = NetworkGradient<double>;
        Gradient gradient(shape, c.w, c.h, kCount);
        Gradient::Matrix slope(kCount, c.w * c.h + 1);
        for (Eigen::Index i = 0; i < slope.size(); ++i) slope.data()[i] = random.unit() - 0.5;
        const auto run = [&](int from, int count) {
            gradient.forward(rows.data() + from * c.h, sizes.data() + from, count);
        };
        const auto loss = [&] {
            gradient.begin(parameters.data());
            run(0, kCount);
            return (slope.array() * gradient.logits().array()).sum() +
                   0.5 * gradient.logits().squaredNorm() + gradient.values().sum() +
                   0.5 * gradient.values().squaredNorm();
        };
        // In two parts, which must add up.
        gradient.begin(parameters.data());
        for (const int from : {0, 2}) {
            const int count = from == 0 ? 2 : kCount - 2;
            run(from, count);
            const Gradient::Matrix by_logits = slope.middleRows(from, count) + gradient.logits();
            const Gradient::Vector by_values = gradient.values().array() + 1.0;
            gradient.backward(by_logits, by_values);
        }
        const Gradient::Vector found = gradient.finish();

        // A ReLU that turns within the step makes the difference wrong: where one does, a smaller
        // step tells.
        size_t wrong = 0;
        for (size_t i = 0; i < parameters.size(); ++i) {
            double error = 1;
            for (const double step : {1e-5, 1e-7}) {
                const double before = parameters[i];
                parameters[i] = before + step;
                const double up = loss();
                parameters[i] = before - step;
                const double down = loss();
                parameters[i] = before;
                const double by = (up - down) / (2 * step);
                const double exact = found[static_cast<Eigen::Index>(i)];
                error = std::min(error, std::fabs(by - exact) / (1.0 + std::fabs(exact)));
            }
            wrong += error > 1e-5 ? 1 : 0;
        }
        if (wrong > 0) fail_msg("%dx%d: %zu of %zu wrong", c.w, c.h, wrong, parameters.size());
    }
}

// ---- The policy --------------------------------------------------------------------------------

Weights weights_of(const NetworkShape &shape, uint64_t seed) {
    const auto parameters = random_parameters<float>(shape, seed);
    Weights weights = network_weights(shape, parameters.data());
    weights.name = "net";
    return weights;
}

void the_mask_leaves_feasible_positions_and_else_nowhere(void **) {
    Random random(kSeed + 3);
    for (const Case &c : kCases) {
        const auto policy =
            make_network_policy(weights_of(shape_of(c.architecture, c.w, c.h, c.channels), 5));
        Evaluation e;
        for (int k = 0; k < 40; ++k) {
            const Bin bin = random_bin(random, c.w, c.h);
            const Size size = random_size(random);
            policy->evaluate(bin, size, e);
            const auto cells = static_cast<size_t>(bin.cells());
            assert_int_equal(e.logits.size(), cells + 1);
            assert_int_equal(e.probabilities.size(), cells + 1);
            Positions positions;
            bin.feasible(size, positions);
            float sum = 0;
            for (size_t i = 0; i <= cells; ++i) {
                bool open = !positions.any();
                if (i < cells) {
                    const int x = static_cast<int>(i) % c.w;
                    const int y = static_cast<int>(i) / c.w;
                    open =
                        bin.inside({x, y, size.w, size.h}) && bin.is_free({x, y, size.w, size.h});
                }
                assert_true(open ? e.probabilities[i] > 0 : e.probabilities[i] == 0);
                assert_true(open == (e.logits[i] > kMaskedLogit));
                sum += e.probabilities[i];
            }
            assert_float_equal(sum, 1, 1e-5);
            const auto best = std::max_element(e.probabilities.begin(), e.probabilities.end());
            assert_int_equal(policy->select(bin, size), best - e.probabilities.begin());
        }
    }
}

void a_session_selects_the_same_without_heap_whatever_it_remembers(void **) {
    Random random(kSeed + 4);
    for (const Case &c : kCases) {
        const auto policy =
            make_network_policy(weights_of(shape_of(c.architecture, c.w, c.h, c.channels), 6));
        const auto session = policy->session({true, std::max(c.w, c.h)});
        assert_non_null(session.get());
        assert_string_equal(session->name(), "net");
        std::vector<Bin> bins;
        for (int k = 0; k < 100; ++k) bins.push_back(random_bin(random, c.w, c.h));
        std::vector<int> first;
        for (const int pass : {0, 1}) {
            size_t at = 0;
            for (const Bin &bin : bins) {
                for (const Size size : {Size{1, 2}, Size{2, 1}, Size{3, 2}}) {
                    const size_t before = allocations;
                    const int position = session->select(bin, size);
                    assert_int_equal(allocations, before);
                    if (pass == 0) {
                        first.push_back(position);
                        assert_int_equal(position, policy->select(bin, size));
                    } else {
                        assert_int_equal(position, first[at++]);
                    }
                }
            }
        }
    }
}

struct BatchAnswers {
    std::vector<int32_t> positions;
    std::vector<float> probabilities;
    std::vector<float> values;
};

BatchAnswers answer_together(const Policy &policy, const std::vector<Question> &questions) {
    const auto actions = static_cast<size_t>(questions[0].bin->cells() + 1);
    BatchAnswers a = {std::vector<int32_t>(questions.size()),
                      std::vector<float>(questions.size() * actions),
                      std::vector<float>(questions.size())};
    policy.evaluate_batch(questions.data(), questions.size(),
                          {a.positions.data(), a.probabilities.data(), a.values.data()});
    return a;
}

void assert_answered_as_alone(const Policy &policy, const std::vector<Question> &questions) {
    const BatchAnswers together = answer_together(policy, questions);
    Evaluation alone;
    const float *probabilities = together.probabilities.data();
    for (size_t i = 0; i < questions.size(); ++i) {
        const Question &q = questions[i];
        policy.evaluate(*q.bin, q.size, alone);
        assert_int_equal(together.positions[i], policy.select(*q.bin, q.size));
        assert_memory_equal(&together.values[i], &alone.value, sizeof alone.value);
        assert_memory_equal(probabilities, alone.probabilities.data(),
                            alone.probabilities.size() * sizeof(float));
        probabilities += alone.probabilities.size();
    }
}

// Bins that stand once, that stand several times in a row, and that come back later; more of them
// than are run together, and one alone.
void questions_together_are_answered_bit_for_bit_as_alone(void **) {
    Random random(kSeed + 6);
    const auto run = [&](const Case &c, const Policy &policy) {
        std::vector<Bin> bins;
        for (int k = 0; k < 30; ++k) bins.push_back(random_bin(random, c.w, c.h));
        std::vector<Question> questions;
        for (int k = 0; k < 75; ++k) {
            const Bin *again = k > 0 ? questions.back().bin : nullptr;
            const bool stays = again != nullptr && random.below(3) == 0;
            questions.push_back({stays ? again : &bins[random.below(bins.size())],
                                 k == 0 ? Size{c.w, c.h} : random_size(random)});
        }
        assert_answered_as_alone(policy, questions);
        assert_answered_as_alone(policy, {questions[7]});
    };
    for (const Case &c : kCases) {
        const NetworkShape shape = shape_of(c.architecture, c.w, c.h, c.channels);
        run(c, *make_network_policy(weights_of(shape, 9)));
    }
    // Large enough for one bin at a time.
    const Case large = {Architecture::kFullyConvolutional, 40, 37, 16};
    run(large,
        *make_network_policy(weights_of(shape_of(large.architecture, 40, 37, large.channels), 10)));
}

void equal_logits_give_the_first_position_together_as_alone(void **) {
    const NetworkShape shape = shape_of(Architecture::kActorCritic, 6, 5, 3);
    Weights weights = weights_of(shape, 11);
    for (Tensor &tensor : weights.tensors) std::fill(tensor.data.begin(), tensor.data.end(), 0.0f);
    const auto policy = make_network_policy(std::move(weights));
    Bin bin(6, 5);
    bin.block({0, 0, 2, 1});
    const std::vector<Question> questions = {{&bin, {1, 1}}, {&bin, {6, 5}}, {&bin, {3, 2}}};
    const BatchAnswers together = answer_together(*policy, questions);
    assert_int_equal(together.positions[0], 2);
    assert_int_equal(together.positions[1], 30);
    assert_int_equal(together.positions[2], 2);
    assert_answered_as_alone(*policy, questions);
}

void answers_that_nobody_asks_for_are_left_out(void **) {
    const NetworkShape shape = shape_of(Architecture::kActorCritic, 6, 5, 3);
    const auto policy = make_network_policy(weights_of(shape, 12));
    const Bin bin(6, 5);
    const std::vector<Question> questions = {{&bin, {1, 1}}, {&bin, {2, 4}}};
    const BatchAnswers all = answer_together(*policy, questions);
    int32_t positions[2] = {-1, -1};
    float values[2] = {};
    policy->evaluate_batch(questions.data(), 2, {positions, nullptr, nullptr});
    policy->evaluate_batch(questions.data(), 2, {nullptr, nullptr, values});
    policy->evaluate_batch(questions.data(), 0, {positions, nullptr, values});
    for (size_t i = 0; i < 2; ++i) {
        assert_int_equal(positions[i], all.positions[i]);
        assert_true(values[i] == all.values[i]);
    }
}

void weights_go_through_a_blob_unchanged(void **) {
    for (const Case &c : kCases) {
        const NetworkShape shape = shape_of(c.architecture, c.w, c.h, c.channels);
        const Weights weights = weights_of(shape, 7);
        const std::vector<uint8_t> blob = write_weights(weights);
        const Weights back = read_weights(blob.data(), blob.size());
        const NetworkShape found = network_shape(back);
        assert_int_equal(found.channels, shape.channels);
        assert_int_equal(found.hidden, shape.hidden);
        assert_true(network_parameters(found, back) == network_parameters(shape, weights));
    }
}

void tensors_that_make_no_network_are_refused(void **) {
    const auto refused = [](Weights weights) {
        try {
            make_network_policy(std::move(weights));
        } catch (const Error &e) {
            return e.status() == Status::kFormat;
        }
        return false;
    };
    const Weights good = weights_of(shape_of(Architecture::kActorCritic, 5, 6, 3), 8);
    for (size_t i = 0; i < good.tensors.size(); ++i) {
        Weights missing = good;
        missing.tensors.erase(missing.tensors.begin() + static_cast<std::ptrdiff_t>(i));
        assert_true(refused(std::move(missing)));
        Weights longer = good;
        longer.tensors[i].shape.back() += 1;
        longer.tensors[i].data.resize(longer.tensors[i].data.size() * 2);
        assert_true(refused(std::move(longer)));
    }
    Weights other_bin = good;
    other_bin.bin_w = 6;
    assert_true(refused(std::move(other_bin)));
    Weights tiny = good;
    tiny.bin_w = 2;
    assert_true(refused(std::move(tiny)));
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_outputs_are_those_of_the_layers_read_plainly),
        cmocka_unit_test(many_samples_at_once_give_what_each_gives_alone),
        cmocka_unit_test(all_widths_of_vectors_give_the_same_bits),
        cmocka_unit_test(a_network_small_enough_is_worked_out_by_hand),
        cmocka_unit_test(the_gradient_agrees_with_finite_differences),
        cmocka_unit_test(the_mask_leaves_feasible_positions_and_else_nowhere),
        cmocka_unit_test(a_session_selects_the_same_without_heap_whatever_it_remembers),
        cmocka_unit_test(questions_together_are_answered_bit_for_bit_as_alone),
        cmocka_unit_test(equal_logits_give_the_first_position_together_as_alone),
        cmocka_unit_test(answers_that_nobody_asks_for_are_left_out),
        cmocka_unit_test(weights_go_through_a_blob_unchanged),
        cmocka_unit_test(tensors_that_make_no_network_are_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
