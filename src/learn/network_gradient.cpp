#include "learn/network_gradient.h"

namespace packcell {

namespace {

// The derivatives by what went into a ReLU, from those by what came out.
template <class Matrix>
void mask_by(const Matrix &out, Matrix &derivatives) {
    using Scalar = typename Matrix::Scalar;
    derivatives.array() *= (out.array() > Scalar(0)).template cast<Scalar>();
}

}  // namespace

template <class Scalar>
NetworkGradient<Scalar>::NetworkGradient(const NetworkShape &shape, int w, int h, int most)
    : shape_(shape),
      w_(w),
      h_(h),
      tensors_(network_tensors(shape)),
      gradient_(static_cast<Eigen::Index>(network_size(shape))),
      by_entries_(kTaps * kPatterns, shape.channels),
      patterns_(static_cast<size_t>(w * h * most)) {}

template <class Scalar>
void NetworkGradient<Scalar>::begin(const Scalar *parameters) {
    parameters_ = parameters;
    gradient_.setZero();
    by_entries_.setZero();
    tables_.build(shape_.channels, parameters + at("conv1.weight"), parameters + at("conv1.bias"),
                  parameters + at("conv2.weight"), parameters + at("conv2.bias"));
}

template <class Scalar>
void NetworkGradient<Scalar>::forward(const Row *rows, const Size *sizes, int count) {
    count_ = count;
    sizes_.resize(count, size_inputs(shape_));
    const bool any = shape_.architecture == Architecture::kFullyConvolutional;
    const int margin = any ? 0 : 1;
    const int cells = (w_ - 2 * margin) * (h_ - 2 * margin);
    if (any) {
        map_.resize(count * cells, shape_.channels);
    } else {
        map_.resize(count, cells * shape_.channels);
    }
    for (int k = 0; k < count; ++k) {
        uint16_t *patterns = patterns_.data() + k * w_ * h_;
        find_patterns(rows + k * h_, w_, h_, patterns);
        tables_.convolve(patterns, w_, h_, margin, map_.data() + k * cells * shape_.channels);
        encode_size(shape_, sizes[k], sizes_.row(k).data());
    }
    if (any) {
        forward_cells(count);
    } else {
        forward_map(count);
    }
}

template <class Scalar>
void NetworkGradient<Scalar>::forward_map(int) {
    const int inputs = static_cast<int>(map_.cols());
    const int features = shape_.features;
    const int hidden = shape_.hidden;
    const int actions = w_ * h_ + 1;
    features_.noalias() = map_ * weight("encoder.weight", inputs, features);
    features_.rowwise() += weight("encoder.bias", 1, features).row(0);
    features_ = features_.cwiseMax(Scalar(0));
    joined_.noalias() = features_ * weight("join.weight", features, hidden);
    joined_.noalias() += sizes_ * weight("join.size", size_inputs(shape_), hidden);
    joined_.rowwise() += weight("join.bias", 1, hidden).row(0);
    joined_ = joined_.cwiseMax(Scalar(0));
    logits_.noalias() = joined_ * weight("actor.weight", hidden, actions);
    logits_.rowwise() += weight("actor.bias", 1, actions).row(0);
    values_.noalias() = joined_ * weight("critic.weight", hidden, 1);
    values_.array() += parameters_[at("critic.bias")];
}

template <class Scalar>
void NetworkGradient<Scalar>::backward_map(const Matrix &by_logits, const Vector &by_values) {
    const int inputs = static_cast<int>(map_.cols());
    const int features = shape_.features;
    const int hidden = shape_.hidden;
    const int actions = w_ * h_ + 1;
    gradient("actor.weight", hidden, actions).noalias() += joined_.transpose() * by_logits;
    gradient("actor.bias", 1, actions) += by_logits.colwise().sum();
    gradient("critic.weight", hidden, 1).noalias() += joined_.transpose() * by_values;
    gradient_[static_cast<Eigen::Index>(at("critic.bias"))] += by_values.sum();

    Matrix by_joined = by_logits * weight("actor.weight", hidden, actions).transpose();
    by_joined.noalias() += by_values * weight("critic.weight", hidden, 1).transpose();
    mask_by(joined_, by_joined);
    gradient("join.weight", features, hidden).noalias() += features_.transpose() * by_joined;
    gradient("join.size", size_inputs(shape_), hidden).noalias() += sizes_.transpose() * by_joined;
    gradient("join.bias", 1, hidden) += by_joined.colwise().sum();

    Matrix by_features = by_joined * weight("join.weight", features, hidden).transpose();
    mask_by(features_, by_features);
    gradient("encoder.weight", inputs, features).noalias() += map_.transpose() * by_features;
    gradient("encoder.bias", 1, features) += by_features.colwise().sum();

    Matrix by_map = by_features * weight("encoder.weight", inputs, features).transpose();
    mask_by(map_, by_map);
    backward_patterns(by_map, count_, 1);
}

// Each cell's window of 3x3 cells two apart, those outside 0.
template <class Scalar>
void NetworkGradient<Scalar>::gather(const Matrix &cells, int count) {
    const int channels = shape_.channels;
    windows_.setZero(count * w_ * h_, kTaps * channels);
    for (int k = 0; k < count; ++k) {
        for (int y = 0; y < h_; ++y) {
            for (int x = 0; x < w_; ++x) {
                const int row = (k * h_ + y) * w_ + x;
                for (int tap = 0; tap < kTaps; ++tap) {
                    const int tx = x + (tap % 3 - 1) * 2;
                    const int ty = y + (tap / 3 - 1) * 2;
                    if (tx < 0 || tx >= w_ || ty < 0 || ty >= h_) continue;
                    windows_.row(row).segment(tap * channels, channels) =
                        cells.row((k * h_ + ty) * w_ + tx);
                }
            }
        }
    }
}

// The transpose of gather(): adds up the derivatives in windows_.
template <class Scalar>
void NetworkGradient<Scalar>::scatter(int count, Matrix &cells) const {
    const int channels = shape_.channels;
    cells.setZero(count * w_ * h_, channels);
    for (int k = 0; k < count; ++k) {
        for (int y = 0; y < h_; ++y) {
            for (int x = 0; x < w_; ++x) {
                const int row = (k * h_ + y) * w_ + x;
                for (int tap = 0; tap < kTaps; ++tap) {
                    const int tx = x + (tap % 3 - 1) * 2;
                    const int ty = y + (tap / 3 - 1) * 2;
                    if (tx < 0 || tx >= w_ || ty < 0 || ty >= h_) continue;
                    cells.row((k * h_ + ty) * w_ + tx) +=
                        windows_.row(row).segment(tap * channels, channels);
                }
            }
        }
    }
}

template <class Scalar>
void NetworkGradient<Scalar>::forward_cells(int count) {
    const int channels = shape_.channels;
    const int hidden = shape_.hidden;
    const int sizes = size_inputs(shape_);
    const int cells = w_ * h_;
    for (const bool last : {false, true}) {
        gather(last ? cells3_ : map_, count);
        Matrix &out = last ? cells4_ : cells3_;
        const char *bias = last ? "conv4.bias" : "conv3.bias";
        out.noalias() =
            windows_ * weight(last ? "conv4.weight" : "conv3.weight", kTaps * channels, channels);
        Matrix added = sizes_ * weight(last ? "conv4.size" : "conv3.size", sizes, channels);
        added.rowwise() += weight(bias, 1, channels).row(0);
        for (int k = 0; k < count; ++k) {
            out.middleRows(k * cells, cells).rowwise() += added.row(k);
        }
        out = out.cwiseMax(Scalar(0));
    }
    means_.resize(count, channels);
    for (int k = 0; k < count; ++k) {
        means_.row(k) = cells4_.middleRows(k * cells, cells).colwise().mean();
    }
    joined_.noalias() = means_ * weight("head.weight", channels, hidden);
    joined_.noalias() += sizes_ * weight("head.size", sizes, hidden);
    joined_.rowwise() += weight("head.bias", 1, hidden).row(0);
    joined_ = joined_.cwiseMax(Scalar(0));
    const Vector actor = cells4_ * weight("actor.weight", channels, 1);
    logits_.resize(count, cells + 1);
    logits_.leftCols(cells) = ConstMap(actor.data(), count, cells);
    logits_.leftCols(cells).array() += parameters_[at("actor.bias")];
    logits_.col(cells) = joined_ * weight("nowhere.weight", hidden, 1);
    logits_.col(cells).array() += parameters_[at("nowhere.bias")];
    values_.noalias() = joined_ * weight("critic.weight", hidden, 1);
    values_.array() += parameters_[at("critic.bias")];
}

template <class Scalar>
void NetworkGradient<Scalar>::backward_cells(const Matrix &by_logits, const Vector &by_values) {
    const int channels = shape_.channels;
    const int hidden = shape_.hidden;
    const int sizes = size_inputs(shape_);
    const int cells = w_ * h_;
    const Vector by_nowhere = by_logits.col(cells);
    const Matrix by_actor = by_logits.leftCols(cells);
    const Eigen::Map<const Vector> by_cell(by_actor.data(), by_actor.size());

    gradient("nowhere.weight", hidden, 1).noalias() += joined_.transpose() * by_nowhere;
    gradient_[static_cast<Eigen::Index>(at("nowhere.bias"))] += by_nowhere.sum();
    gradient("critic.weight", hidden, 1).noalias() += joined_.transpose() * by_values;
    gradient_[static_cast<Eigen::Index>(at("critic.bias"))] += by_values.sum();
    gradient("actor.weight", channels, 1).noalias() += cells4_.transpose() * by_cell;
    gradient_[static_cast<Eigen::Index>(at("actor.bias"))] += by_cell.sum();

    Matrix by_joined = by_nowhere * weight("nowhere.weight", hidden, 1).transpose();
    by_joined.noalias() += by_values * weight("critic.weight", hidden, 1).transpose();
    mask_by(joined_, by_joined);
    gradient("head.weight", channels, hidden).noalias() += means_.transpose() * by_joined;
    gradient("head.size", sizes, hidden).noalias() += sizes_.transpose() * by_joined;
    gradient("head.bias", 1, hidden) += by_joined.colwise().sum();

    const Matrix by_means =
        by_joined * weight("head.weight", channels, hidden).transpose() / Scalar(cells);
    Matrix by_out = by_cell * weight("actor.weight", channels, 1).transpose();
    for (int k = 0; k < count_; ++k) {
        by_out.middleRows(k * cells, cells).rowwise() += by_means.row(k);
    }
    for (const bool last : {true, false}) {
        const char *name = last ? "conv4.weight" : "conv3.weight";
        mask_by(last ? cells4_ : cells3_, by_out);
        gather(last ? cells3_ : map_, count_);
        gradient(name, kTaps * channels, channels).noalias() += windows_.transpose() * by_out;
        Matrix added(count_, channels);
        for (int k = 0; k < count_; ++k) {
            added.row(k) = by_out.middleRows(k * cells, cells).colwise().sum();
        }
        gradient(last ? "conv4.size" : "conv3.size", sizes, channels).noalias() +=
            sizes_.transpose() * added;
        gradient(last ? "conv4.bias" : "conv3.bias", 1, channels) += added.colwise().sum();
        windows_.noalias() = by_out * weight(name, kTaps * channels, channels).transpose();
        scatter(count_, by_out);
    }
    mask_by(map_, by_out);
    backward_patterns(by_out, count_, 0);
}

template <class Scalar>
void NetworkGradient<Scalar>::backward(const Matrix &by_logits, const Vector &by_values) {
    if (shape_.architecture == Architecture::kFullyConvolutional) {
        backward_cells(by_logits, by_values);
    } else {
        backward_map(by_logits, by_values);
    }
}

// Adds each cell's derivatives to the nine entries that its value was summed of.
template <class Scalar>
void NetworkGradient<Scalar>::backward_patterns(const Matrix &by_cells, int count, int margin) {
    using Vectors = Eigen::Map<const Eigen::Matrix<Scalar, 1, Eigen::Dynamic>>;
    const int channels = shape_.channels;
    const Scalar *next = by_cells.data();
    auto bias = gradient("conv2.bias", 1, channels);
    for (int k = 0; k < count; ++k) {
        const uint16_t *patterns = patterns_.data() + k * w_ * h_;
        for (int y = margin; y < h_ - margin; ++y) {
            for (int x = margin; x < w_ - margin; ++x, next += channels) {
                const Vectors by(next, channels);
                bias.row(0) += by;
                for (int tap = 0; tap < kTaps; ++tap) {
                    const int tx = x + tap % 3 - 1;
                    const int ty = y + tap / 3 - 1;
                    if (tx < 0 || tx >= w_ || ty < 0 || ty >= h_) continue;
                    by_entries_.row(tap * kPatterns + patterns[ty * w_ + tx]) += by;
                }
            }
        }
    }
}

template <class Scalar>
const typename NetworkGradient<Scalar>::Vector &NetworkGradient<Scalar>::finish() {
    const int channels = shape_.channels;
    const Matrix &first = tables_.first();
    Matrix by_first = Matrix::Zero(kPatterns, channels);
    for (int tap = 0; tap < kTaps; ++tap) {
        const size_t offset = at("conv2.weight") + static_cast<size_t>(tap * channels * channels);
        const auto by = by_entries_.middleRows(tap * kPatterns, kPatterns);
        Map(gradient_.data() + offset, channels, channels).noalias() += first.transpose() * by;
        by_first.noalias() += by * ConstMap(parameters_ + offset, channels, channels).transpose();
    }
    mask_by(first, by_first);
    auto kernel = gradient("conv1.weight", kTaps, channels);
    for (int p = 0; p < kPatterns; ++p) {
        for (int tap = 0; tap < kTaps; ++tap) {
            if ((p >> tap & 1) != 0) kernel.row(tap) += by_first.row(p);
        }
    }
    gradient("conv1.bias", 1, channels) += by_first.colwise().sum();
    return gradient_;
}

template class NetworkGradient<float>;
template class NetworkGradient<double>;

}  // namespace packcell
