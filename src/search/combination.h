// All subsets of 0..n-1 by growing size, and of one size in lexicographic order: with the items
// numbered last packed first, sets of recently packed items come first.
#pragma once

#include <cstddef>
#include <vector>

namespace packcell {

class Combination {
public:
    explicit Combination(size_t reserve) { indices_.reserve(reserve); }

    void start(int n, int size) {
        n_ = n;
        indices_.clear();
        for (int i = 0; i < size; ++i) indices_.push_back(i);
    }

    const std::vector<int> &indices() const { return indices_; }
    int size() const { return static_cast<int>(indices_.size()); }

    // The next subset of the same size; false after the last.
    bool next() {
        int i = size() - 1;
        while (i >= 0 && indices_[static_cast<size_t>(i)] == n_ - size() + i) --i;
        if (i < 0) return false;
        int v = ++indices_[static_cast<size_t>(i)];
        for (++i; i < size(); ++i) indices_[static_cast<size_t>(i)] = ++v;
        return true;
    }

private:
    int n_ = 0;
    std::vector<int> indices_;
};

}  // namespace packcell
