#include "tests/evaluation/guard/logistic_fit.h"

#include <cmath>
#include <stdexcept>

#include <Eigen/Cholesky>

namespace mapweld::evaluation {
namespace {

constexpr int kMostSteps = 100;
constexpr double kStill = 1e-10;
constexpr double kLongestStep = 5;  // of a scaled weight: Newton overshoots where classes hardly overlap

}  // namespace

Eigen::VectorXd logistic_fit(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, const Eigen::VectorXd& weight,
                             double ridge) {
  if (x.rows() != y.size() || x.rows() != weight.size() || x.rows() == 0) {
    throw std::invalid_argument("observations, answers and weights differ in number");
  }
  const Eigen::Index n = x.cols();
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(n), held = Eigen::VectorXd::Constant(n, ridge);
  held[0] = 0;
  for (Eigen::Index k = 1; k < n; ++k) {
    const double mean = x.col(k).mean();
    const double deviation = std::sqrt((x.col(k).array() - mean).square().mean());
    if (deviation > 0) scale[k] = deviation;
  }
  const Eigen::MatrixXd z = x * scale.cwiseInverse().asDiagonal();
  Eigen::VectorXd w = Eigen::VectorXd::Zero(n);
  for (int step = 0; step < kMostSteps; ++step) {
    const Eigen::ArrayXd p = 1 / (1 + (-(z * w).array()).exp());
    const Eigen::VectorXd gradient = z.transpose() * (weight.array() * (p - y.array())).matrix() + held.cwiseProduct(w);
    Eigen::MatrixXd hessian = z.transpose() * (weight.array() * p * (1 - p)).matrix().asDiagonal() * z;
    hessian.diagonal() += held;
    hessian.diagonal().array() += 1e-9;
    Eigen::VectorXd move = hessian.ldlt().solve(gradient);
    const double longest = move.cwiseAbs().maxCoeff();
    if (longest > kLongestStep) move *= kLongestStep / longest;
    w -= move;
    if (longest < kStill) break;
  }
  return w.cwiseQuotient(scale);
}

}  // namespace mapweld::evaluation
