// The network run forward over many samples at once, and the gradient of a loss of its outputs.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "policy/network_patterns.h"
#include "policy/network_shape.h"

namespace packcell {

// In double it is what the finite differences of the tests are taken of.
template <class Scalar>
class NetworkGradient {
public:
    using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

    // For up to `most` samples at a time, of bins of w x h cells.
    NetworkGradient(const NetworkShape &shape, int w, int h, int most);

    // Sets the gradient to 0. The parameters must stay until finish().
    void begin(const Scalar *parameters);

    // Runs `count` samples, h rows and one size each. Afterwards logits() has a row of W * H + 1,
    // not masked, for each of them.
    void forward(const Row *rows, const Size *sizes, int count);
    const Matrix &logits() const { return logits_; }
    const Vector &values() const { return values_; }

    // Adds the gradient of a loss whose derivatives by the outputs of the last forward() are these.
    void backward(const Matrix &by_logits, const Vector &by_values);

    // The gradient, once all samples are in: network_size() numbers.
    const Vector &finish();

private:
    using Map = Eigen::Map<Matrix>;
    using ConstMap = Eigen::Map<const Matrix>;

    size_t at(const char *name) const { return tensor_offset(tensors_, name); }
    ConstMap weight(const char *name, int inputs, int outputs) const {
        return ConstMap(parameters_ + at(name), inputs, outputs);
    }
    Map gradient(const char *name, int inputs, int outputs) {
        return Map(gradient_.data() + at(name), inputs, outputs);
    }

    void forward_map(int count);
    void forward_cells(int count);
    void backward_map(const Matrix &by_logits, const Vector &by_values);
    void backward_cells(const Matrix &by_logits, const Vector &by_values);
    void gather(const Matrix &cells, int count);
    void scatter(int count, Matrix &cells) const;
    void backward_patterns(const Matrix &by_cells, int count, int margin);

    NetworkShape shape_;
    int w_;
    int h_;
    std::vector<NetworkTensor> tensors_;
    const Scalar *parameters_ = nullptr;
    Vector gradient_;
    PatternTables<Scalar> tables_;
    Matrix by_entries_;  // of the second convolution's table

    int count_ = 0;
    std::vector<uint16_t> patterns_;
    Matrix sizes_;
    Matrix map_;       // after the second convolution
    Matrix features_;  // kActorCritic: the encoded map
    Matrix cells3_;    // kFullyConvolutional: after the third and the fourth one, a cell a row
    Matrix cells4_;
    Matrix windows_;  // of cells two apart, 9 * channels a row
    Matrix means_;
    Matrix joined_;
    Matrix logits_;
    Vector values_;
};

extern template class NetworkGradient<float>;
extern template class NetworkGradient<double>;

}  // namespace packcell
