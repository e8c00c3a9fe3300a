// Logistic regression.
#pragma once

#include <Eigen/Core>

namespace mapweld::evaluation {

// Weights w that make sum of weight[i] * log-likelihood of (y[i] | 1 / (1 + e^-(x[i] . w))) - ridge / 2 * |scaled w|^2
// greatest, by Newton's method; x: a row an observation, its first column the constant 1, which is not held back.
// Scaled: as if each other column had a standard deviation of 1. y: 0 or 1. Deterministic. std::invalid_argument for
// sizes that do not agree.
Eigen::VectorXd logistic_fit(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, const Eigen::VectorXd& weight,
                             double ridge);

}  // namespace mapweld::evaluation
