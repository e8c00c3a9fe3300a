#include "tests/evaluation/guard/logistic_fit.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mapweld::evaluation {
namespace {

// With one column that is 0 or 1 the answer is known: the log odds of either group.
TEST(LogisticFit, TwoGroupsHaveTheirLogOdds) {
  Eigen::MatrixXd x(10, 2);
  Eigen::VectorXd y(10);
  for (int i = 0; i < 10; ++i) x.row(i) << 1, i < 5 ? 0 : 1;
  y << 1, 0, 0, 0, 0, 1, 1, 1, 0, 0;
  const auto w = logistic_fit(x, y, Eigen::VectorXd::Ones(10), 0);
  EXPECT_NEAR(w[0], std::log(1.0 / 4), 1e-6);
  EXPECT_NEAR(w[0] + w[1], std::log(3.0 / 2), 1e-6);
}

TEST(LogisticFit, AnObservationOfWeightThreeIsThree) {
  Eigen::MatrixXd x(3, 1), thrice(5, 1);
  x.setOnes();
  thrice.setOnes();
  Eigen::VectorXd y(3), y5(5), weight(3);
  y << 1, 0, 0;
  y5 << 1, 1, 1, 0, 0;
  weight << 3, 1, 1;
  EXPECT_NEAR(logistic_fit(x, y, weight, 0)[0], logistic_fit(thrice, y5, Eigen::VectorXd::Ones(5), 0)[0], 1e-9);
}

TEST(LogisticFit, FindsTheWeightsThatAnswersWereDrawnBy) {
  constexpr int kObservations = 40000;
  std::mt19937_64 random(7);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) / 9007199254740992.0; };
  Eigen::MatrixXd x(kObservations, 3);
  Eigen::VectorXd y(kObservations);
  const Eigen::Vector3d truth(-1.5, 2.5, -0.02);
  for (int i = 0; i < kObservations; ++i) {
    x.row(i) << 1, 3 * uniform(), 200 * uniform();
    y[i] = uniform() < 1 / (1 + std::exp(-x.row(i).dot(truth))) ? 1 : 0;
  }
  const auto w = logistic_fit(x, y, Eigen::VectorXd::Ones(kObservations), 0.3);
  EXPECT_NEAR(w[0], truth[0], 0.1);
  EXPECT_NEAR(w[1], truth[1], 0.1);
  EXPECT_NEAR(w[2], truth[2], 0.001);
}

TEST(LogisticFit, ClassesThatDoNotOverlapHaveAnAnswerWhenHeldBack) {
  Eigen::MatrixXd x(6, 2);
  Eigen::VectorXd y(6);
  for (int i = 0; i < 6; ++i) x.row(i) << 1, i;
  y << 0, 0, 0, 1, 1, 1;
  const auto w = logistic_fit(x, y, Eigen::VectorXd::Ones(6), 0.3);
  EXPECT_TRUE(w.allFinite());
  EXPECT_NEAR(-w[0] / w[1], 2.5, 1e-6);  // by symmetry
}

TEST(LogisticFit, RefusesWhatDoesNotAgree) {
  EXPECT_THROW(logistic_fit(Eigen::MatrixXd::Ones(2, 1), Eigen::VectorXd::Ones(3), Eigen::VectorXd::Ones(2), 0),
               std::invalid_argument);
}

}  // namespace
}  // namespace mapweld::evaluation
