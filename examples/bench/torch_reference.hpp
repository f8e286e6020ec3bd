// A network of a weight blob (docs/blob-format.md) made of libtorch's operators, which ours is held
// against; built only where CMake was given PACKCELL_TORCH, and for the test of the networks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace packcell_programs {

class TorchReference {
public:
    // Of a blob that the library has written or loaded. From here on libtorch runs on one thread.
    // Throws std::runtime_error for one that holds no network.
    explicit TorchReference(const std::vector<uint8_t> &blob);
    ~TorchReference();
    TorchReference(const TorchReference &) = delete;
    TorchReference &operator=(const TorchReference &) = delete;

    // What run() reads, made into tensors of `batch` pairs each: of every pair the bin's w x h
    // cells, row by row, 1 where taken, and the item's two sides. `batch` divides the pairs.
    void set_pairs(int w, int h, const std::vector<uint8_t> &cells,
                   const std::vector<int32_t> &sizes, size_t batch);

    // Logits, not masked, and values of all pairs, one batch after the other.
    void run();

    // What run() found, w * h + 1 logits a pair.
    std::vector<float> logits() const;
    std::vector<float> values() const;

private:
    struct Network;
    std::unique_ptr<Network> network_;
};

}  // namespace packcell_programs
