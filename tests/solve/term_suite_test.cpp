// What must hold for every row of the term table. The only code per term is kRestatements: each residual written once
// more with Eigen, straight from the paper, and how to draw instances of it.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <functional>
#include <map>
#include <random>
#include <string>

#include "solve/term_check.h"
#include "solve/term_table.h"
#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

struct Instance {
  VectorXd x;
  VectorXd params;
};

struct Restatement {
  std::function<VectorXd(const Instance&)> residual;
  std::function<Instance(std::mt19937&)> sample;                     // generic, away from kinks
  std::function<void(Instance&)> make_true;                          // moves x or params to where the residual is zero
  std::function<Instance(const Instance&, std::mt19937&)> symmetry;  // another instance with the same residual
  std::vector<Instance> kinks;                                       // where the derivative does not exist
  // The Jacobian of a term may carry a sign of its own (b_i of the silhouette); default +1.
  std::function<double(const Instance&)> jacobian_sign = [](const Instance&) { return 1.0; };
};

double uniform(std::mt19937& rng, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(rng);
}

VectorXd concat(std::initializer_list<VectorXd> parts) {
  Eigen::Index size = 0;
  for (const VectorXd& part : parts) size += part.size();
  VectorXd all(size);
  Eigen::Index at = 0;
  for (const VectorXd& part : parts) {
    all.segment(at, part.size()) = part;
    at += part.size();
  }
  return all;
}

VectorXd numbers(std::initializer_list<double> values) {
  VectorXd v(values.size());
  std::copy(values.begin(), values.end(), v.data());
  return v;
}

VectorXd random_vector(std::mt19937& rng, int n, double low, double high) {
  return VectorXd::NullaryExpr(n, [&] { return uniform(rng, low, high); });
}

Vector3d random_point(std::mt19937& rng) {
  return {uniform(rng, -800, 800), uniform(rng, -900, 900), uniform(rng, 1500, 4500)};
}

VectorXd random_camera(std::mt19937& rng) {
  return numbers({uniform(rng, 500, 900), uniform(rng, 500, 900), uniform(rng, 200, 400), uniform(rng, 400, 600)});
}

// pi by homogeneous coordinates.
Vector2d project(const VectorXd& p, const VectorXd& camera) {
  Eigen::Matrix3d K;
  K << camera[0], 0, camera[2], 0, camera[1], camera[3], 0, 0, 1;
  return (K * Vector3d(p)).hnormalized();
}

Instance along_ray(const Instance& instance, std::mt19937& rng) {
  return {instance.x * uniform(rng, 0.5, 2), instance.params};
}

Instance translated(const Instance& instance, std::mt19937& rng, int n_params) {
  const Vector3d shift = random_vector(rng, 3, -100, 100);
  Instance moved = instance;
  for (int i = 0; i < moved.x.size(); ++i) moved.x[i] += shift[i % 3];
  for (int i = 0; i < n_params; ++i) moved.params[i] += shift[i % 3];
  return moved;
}

// E_silhouette with the distance image as a plane: value + gradient . (pi(V) - pixel).
Restatement silhouette() {
  Restatement term;
  term.residual = [](const Instance& i) {
    const Vector2d gradient = i.params.segment<2>(5);
    return numbers({i.params[4] + gradient.dot(project(i.x, i.params.head(4)) - i.params.segment<2>(7))});
  };
  term.sample = [](std::mt19937& rng) {
    Instance i{random_point(rng),
               concat({random_camera(rng), random_vector(rng, 1, -30, 30), random_vector(rng, 2, -1, 1),
                       numbers({0, 0}), numbers({uniform(rng, 0, 1) < 0.5 ? -1.0 : 1.0})})};
    i.params.segment<2>(7) = project(i.x, i.params.head(4)) + random_vector(rng, 2, -3, 3);
    return i;
  };
  term.make_true = [](Instance& i) {
    i.params[4] = -i.params.segment<2>(5).dot(project(i.x, i.params.head(4)) - Vector2d(i.params.segment<2>(7)));
  };
  term.symmetry = along_ray;
  term.kinks = {{numbers({0, 0, 2000}), numbers({600, 600, 300, 300, 0, 0, 0, 300, 300, -1})}};
  term.jacobian_sign = [](const Instance& i) { return i.params[9]; };
  return term;
}

std::map<std::string_view, Restatement> restatements() {
  std::map<std::string_view, Restatement> table;

  table["keypoint_2d"] = {
      .residual = [](const Instance& i) -> VectorXd {
        return project(i.x, i.params.head(4)) - Vector2d(i.params.tail<2>());
      },
      .sample =
          [](std::mt19937& rng) {
            return Instance{random_point(rng), concat({random_camera(rng), random_vector(rng, 2, 0, 900)})};
          },
      .make_true = [](Instance& i) { i.params.tail<2>() = project(i.x, i.params.head(4)); },
      .symmetry = along_ray,
      .kinks = {{numbers({0, 0, 100}), numbers({600, 600, 300, 300, 300, 300})}}};

  table["keypoint_3d"] = {
      .residual = [](const Instance& i) -> VectorXd { return i.x.head(3) - (i.params + i.x.tail(3)); },
      .sample =
          [](std::mt19937& rng) {
            return Instance{concat({random_point(rng), random_point(rng)}), random_vector(rng, 3, -900, 900)};
          },
      .make_true = [](Instance& i) { i.x.head(3) = i.params + i.x.tail(3); },
      .symmetry = [](const Instance& i, std::mt19937& rng) { return translated(i, rng, 0); },
      .kinks = {}};

  table["temporal"] =
      table["velocity"] = {.residual = [](const Instance& i) -> VectorXd { return i.x - i.params; },
                           .sample =
                               [](std::mt19937& rng) {
                                 const Vector3d p = random_point(rng);
                                 return Instance{p, p + random_vector(rng, 3, -40, 40)};
                               },
                           .make_true = [](Instance& i) { i.x = i.params; },
                           .symmetry = [](const Instance& i, std::mt19937& rng) { return translated(i, rng, 3); },
                           .kinks = {}};

  table["depth"] = {.residual = [](const Instance& i) -> VectorXd {
                      // How much farther along the sight of the skinned vertex.
                      return VectorXd::Constant(1, i.x.dot(i.params) / i.params.norm() - i.params.norm());
                    },
                    .sample =
                        [](std::mt19937& rng) {
                          const Vector3d p = random_point(rng);
                          return Instance{p, p + random_vector(rng, 3, -40, 40)};
                        },
                    .make_true = [](Instance& i) { i.x = i.params; },
                    .symmetry =
                        [](const Instance& i, std::mt19937& rng) {
                          // Across the sight nothing holds.
                          Instance moved = i;
                          const Vector3d sight = Vector3d(i.params).normalized();
                          moved.x += sight.cross(Vector3d(random_vector(rng, 3, -40, 40)));
                          return moved;
                        },
                    .kinks = {}};

  table["acceleration"] = {
      .residual = [](const Instance& i) -> VectorXd {
        // Change of the velocity.
        return (i.x - i.params.head(3)) - (i.params.head(3) - i.params.tail(3));
      },
      .sample =
          [](std::mt19937& rng) {
            const Vector3d p = random_point(rng);
            return Instance{p, concat({p + random_vector(rng, 3, -40, 40), p + random_vector(rng, 3, -80, 80)})};
          },
      .make_true = [](Instance& i) { i.x = i.params.head(3) + (i.params.head(3) - i.params.tail(3)); },
      .symmetry = [](const Instance& i, std::mt19937& rng) { return translated(i, rng, 6); },
      .kinks = {}};

  table["anatomic"] = {
      .residual =
          [](const Instance& i) {
            return numbers({std::max(0.0, i.x[0] - i.params[1]) - std::max(0.0, i.params[0] - i.x[0])});
          },
      .sample =
          [](std::mt19937& rng) {
            const double low = uniform(rng, -1, 0);
            const double high = uniform(rng, 0.1, 1);
            const double places[] = {low - 0.3, 0.5 * (low + high), high + 0.3};
            return Instance{numbers({places[rng() % 3]}), numbers({low, high})};
          },
      .make_true = [](Instance& i) { i.x[0] = 0.5 * (i.params[0] + i.params[1]); },
      .symmetry =
          [](const Instance& i, std::mt19937& rng) {
            const double shift = uniform(rng, -1, 1);
            return Instance{i.x.array() + shift, i.params.array() + shift};
          },
      .kinks = {{numbers({0.5}), numbers({-0.5, 0.5})}, {numbers({-0.5}), numbers({-0.5, 0.5})}}};

  table["rest"] = {.residual = [](const Instance& i) { return numbers({i.x[0] - i.params[0]}); },
                   .sample =
                       [](std::mt19937& rng) {
                         return Instance{numbers({uniform(rng, -2, 2)}), numbers({uniform(rng, -1, 1)})};
                       },
                   .make_true = [](Instance& i) { i.x[0] = i.params[0]; },
                   .symmetry =
                       [](const Instance& i, std::mt19937& rng) {
                         const double shift = uniform(rng, -1, 1);
                         return Instance{i.x.array() + shift, i.params.array() + shift};
                       },
                   .kinks = {}};

  // Distance along the normal from the plane's nearest point to the origin.
  const auto above = [](const Instance& i) {
    const Vector3d normal = i.params.head<3>(), foot = -i.params[3] * normal;
    return normal.dot(Vector3d(i.x) - foot);
  };
  table["floor"] = {
      .residual = [=](const Instance& i) { return numbers({above(i) < 0 ? above(i) : i.params[4] * above(i)}); },
      .sample =
          [](std::mt19937& rng) {
            const Vector3d point = random_point(rng), normal = random_vector(rng, 3, -1, 1).normalized();
            const double height = (rng() % 2 ? 1 : -1) * uniform(rng, 1, 60);
            return Instance{point, concat({normal, numbers({height - normal.dot(point), uniform(rng, 0, 1)})})};
          },
      .make_true = [=](Instance& i) { i.params[3] -= above(i); },
      // Along the plane.
      .symmetry =
          [](const Instance& i, std::mt19937& rng) {
            const Vector3d normal = i.params.head<3>();
            Instance moved = i;
            moved.x += normal.cross(Vector3d(random_vector(rng, 3, -100, 100)));
            return moved;
          },
      .kinks = {{numbers({0, 0, 2000}), numbers({0, -1, 0, 0, 0.5})}}};

  table["photo"] = {
      .residual = [](const Instance& i) -> VectorXd {
        const Vector2d offset = project(i.x, i.params.head(4)) - Vector2d(i.params.segment<2>(13));
        const Vector3d color =
            i.params.segment<3>(4) + offset.x() * i.params.segment<3>(7) + offset.y() * i.params.segment<3>(10);
        const Vector3d error = color - Vector3d(i.params.segment<3>(15));
        return error.norm() > i.params[18] ? Vector3d::Zero().eval() : error;
      },
      .sample =
          [](std::mt19937& rng) {
            // Errors of about 0.5, thresholds below or above.
            const VectorXd color = random_vector(rng, 3, 0.6, 1);
            Instance i{random_point(rng),
                       concat({random_camera(rng), color, random_vector(rng, 6, -0.02, 0.02), numbers({0, 0}),
                               color - random_vector(rng, 3, 0.25, 0.35), numbers({rng() % 2 == 0 ? 0.3 : 1.0})})};
            i.params.segment<2>(13) = project(i.x, i.params.head(4)) + random_vector(rng, 2, -0.5, 0.5);
            return i;
          },
      .make_true =
          [](Instance& i) {
            const Vector2d offset = project(i.x, i.params.head(4)) - Vector2d(i.params.segment<2>(13));
            i.params.segment<3>(15) =
                i.params.segment<3>(4) + offset.x() * i.params.segment<3>(7) + offset.y() * i.params.segment<3>(10);
          },
      .symmetry = along_ray,
      .kinks = {{numbers({0, 0, 2000}),
                 numbers({600, 600, 300, 300, 0.5, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 300, 300, 0, 0, 0, 0.5})}}};

  table["match"] = {.residual = [](const Instance& i) -> VectorXd {
                      const Vector2d offset = project(i.x, i.params.head(4)) - Vector2d(i.params.segment<2>(4));
                      Eigen::Matrix2d root;
                      root << i.params[6], i.params[7], 0, i.params[8];
                      return root * offset;
                    },
                    .sample =
                        [](std::mt19937& rng) {
                          const VectorXd x = random_point(rng);
                          const VectorXd camera = random_camera(rng);
                          return Instance{x, concat({camera, project(x, camera) + random_vector(rng, 2, -20, 20),
                                                     random_vector(rng, 3, -1, 1)})};
                        },
                    .make_true = [](Instance& i) { i.params.segment<2>(4) = project(i.x, i.params.head(4)); },
                    .symmetry = along_ray,
                    .kinks = {}};

  table["surface_match"] = table["match"];

  // As a quadratic form: (n, 1)^T M (n, 1) with the light's coefficients in M.
  const auto expected_brightness = [](const Instance& i) {
    const auto& l = i.params;
    Eigen::Matrix4d m;
    m << l[7], l[4] / 2, l[6] / 2, l[1] / 2,  //
        l[4] / 2, -l[7], l[5] / 2, l[2] / 2,  //
        l[6] / 2, l[5] / 2, 3 * l[8], l[3] / 2, l[1] / 2, l[2] / 2, l[3] / 2, l[0] - l[8];
    const Eigen::Vector4d n = Vector3d(i.x).homogeneous();
    return n.dot(m * n);
  };
  table["shading"] = {
      .residual = [=](const Instance& i) -> VectorXd { return numbers({expected_brightness(i) - i.params[9]}); },
      .sample =
          [](std::mt19937& rng) {
            return Instance{Vector3d(random_vector(rng, 3, -1, 1)).normalized(), random_vector(rng, 10, -1, 1)};
          },
      .make_true = [=](Instance& i) { i.params[9] = expected_brightness(i); },
      // Normal and light in a mirror.
      .symmetry =
          [](const Instance& i, std::mt19937&) {
            Instance mirrored = i;
            for (double* odd : {&mirrored.x[0], &mirrored.params[1], &mirrored.params[4], &mirrored.params[6]})
              *odd = -*odd;
            return mirrored;
          },
      .kinks = {}};

  table["pose_silhouette"] = table["surface_silhouette"] = silhouette();

  table["smooth"] = {.residual = [](const Instance& i) -> VectorXd {
                       return (i.x.head(3) - i.params.head(3)) - (i.x.tail(3) - i.params.tail(3));
                     },
                     .sample =
                         [](std::mt19937& rng) {
                           const Vector3d p = random_point(rng);
                           const VectorXd both = concat({p, p + random_vector(rng, 3, -30, 30)});
                           return Instance{both, both + random_vector(rng, 6, -50, 50)};
                         },
                     .make_true = [](Instance& i) { i.x.head(3) = i.x.tail(3) + i.params.head(3) - i.params.tail(3); },
                     .symmetry = [](const Instance& i, std::mt19937& rng) { return translated(i, rng, 0); },
                     .kinks = {}};

  table["edge"] = {
      .residual = [](const Instance& i) { return numbers({(i.x.head<3>() - i.x.tail<3>()).norm() - i.params[0]}); },
      .sample =
          [](std::mt19937& rng) {
            const Vector3d p = random_point(rng);
            return Instance{concat({p, p + random_vector(rng, 3, 5, 30)}), random_vector(rng, 1, 5, 30)};
          },
      .make_true = [](Instance& i) { i.params[0] = (i.x.head<3>() - i.x.tail<3>()).norm(); },
      .symmetry = [](const Instance& i, std::mt19937& rng) { return translated(i, rng, 0); },
      .kinks = {{numbers({100, 200, 3000, 100, 200, 3000}), numbers({20})}}};
  return table;
}

class TermSuite : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    term_ = find_term(GetParam());
    ASSERT_NE(term_, nullptr);
    const auto table = restatements();
    const auto found = table.find(term_->name);
    ASSERT_NE(found, table.end()) << "term \"" << term_->name << "\" has no independent restatement here";
    restatement_ = found->second;
    for (int i = 0; i < kSamples; ++i) samples_.push_back(restatement_.sample(rng_));
    for (const Instance& i : samples_) {
      ASSERT_EQ(i.x.size(), term_->n_unknowns);
      ASSERT_EQ(i.params.size(), term_->n_params);
    }
  }

  struct Row {
    VectorXd r;
    Eigen::MatrixXd J;
  };
  Row evaluate(const Instance& i) const {
    Row row{VectorXd(term_->n_residuals), {}};
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> J(term_->n_residuals, term_->n_unknowns);
    term_->flat(i.x.data(), i.params.data(), row.r.data(), J.data());
    row.J = J;
    return row;
  }

  TermBatch batch(int n) const {
    TermBatch batch;
    batch.n = n;
    for (int i = 0; i < n; ++i) {
      const Instance& instance = samples_[i % samples_.size()];
      batch.x.insert(batch.x.end(), instance.x.begin(), instance.x.end());
      batch.params.insert(batch.params.end(), instance.params.begin(), instance.params.end());
    }
    return batch;
  }

  static constexpr int kSamples = 40;
  const Term* term_ = nullptr;
  Restatement restatement_;
  std::mt19937 rng_{2019};
  std::vector<Instance> samples_;
};

TEST_P(TermSuite, ResidualIsTheRestatement) {
  for (const Instance& i : samples_) {
    const VectorXd expected = restatement_.residual(i);
    EXPECT_LT((evaluate(i).r - expected).norm(), test::kDoubleExact * std::max(1.0, expected.norm()));
  }
}

TEST_P(TermSuite, JacobianIsTheDerivativeOfTheRestatement) {
  double largest = 0;
  for (const Instance& i : samples_) {
    const Row row = evaluate(i);
    for (int k = 0; k < term_->n_unknowns; ++k) {
      const double h = 1e-5 * std::max(1.0, std::abs(i.x[k]));
      Instance plus = i;
      Instance minus = i;
      plus.x[k] += h;
      minus.x[k] -= h;
      const VectorXd numeric = (restatement_.residual(plus) - restatement_.residual(minus)) / (plus.x[k] - minus.x[k]);
      EXPECT_LT((row.J.col(k) - restatement_.jacobian_sign(i) * numeric).norm(),
                test::kFiniteDifference * std::max(1.0, row.J.norm()))
          << "unknown " << k;
      largest = std::max(largest, numeric.norm());
    }
  }
  EXPECT_GT(largest, 0) << "no sample has a derivative: the check is void";
}

TEST_P(TermSuite, DeviceIsTheHostsDouble) {
  test::on_every_device([&](ocl::DeviceContext& device) {
    const TermBatch all = batch(kSamples);
    const TermValues got = evaluate_on_device(device, *term_, all);
    const TermValuesDouble expected = evaluate_on_host(*term_, all);
    double J_scale = 1;
    for (double value : expected.J) J_scale = std::max(J_scale, std::abs(value));
    for (size_t i = 0; i < expected.r.size(); ++i)
      EXPECT_NEAR(got.r[i], expected.r[i], test::kTermResidual) << "r " << i;
    for (size_t i = 0; i < expected.J.size(); ++i)
      EXPECT_NEAR(got.J[i], expected.J[i], test::kFloatRelative * J_scale) << "J " << i;
  });
}

TEST_P(TermSuite, ResidualIsZeroAtTheTrueState) {
  for (Instance i : samples_) {
    const double before = restatement_.residual(i).norm();
    restatement_.make_true(i);
    EXPECT_LT(evaluate(i).r.norm(), test::kDoubleExact * std::max({1.0, before, i.x.norm()}));
  }
}

TEST_P(TermSuite, ResidualKeepsItsInvariance) {
  for (const Instance& i : samples_) {
    const Instance same = restatement_.symmetry(i, rng_);
    ASSERT_GT((same.x - i.x).norm(), 0);
    EXPECT_LT((evaluate(same).r - evaluate(i).r).norm(), test::kDoubleExact * std::max(1.0, i.x.norm()));
  }
}

TEST_P(TermSuite, NormalMatrixIsSymmetricAndNotNegative) {
  test::on_every_device([&](ocl::DeviceContext& device) {
    const TermValues values = evaluate_on_device(device, *term_, batch(kSamples));
    using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const Eigen::MatrixXd J =
        Eigen::Map<const RowMajor>(values.J.data(), kSamples * term_->n_residuals, term_->n_unknowns).cast<double>();
    const Eigen::MatrixXd JtJ = J.transpose() * J;
    EXPECT_LT((JtJ - JtJ.transpose()).norm(), test::kDoubleExact * JtJ.norm());
    const VectorXd eigenvalues = JtJ.selfadjointView<Eigen::Lower>().eigenvalues();
    EXPECT_GE(eigenvalues.minCoeff(), -test::kDoubleExact * eigenvalues.maxCoeff());
    EXPECT_GT(eigenvalues.maxCoeff(), 0);
  });
}

TEST_P(TermSuite, RepeatsBitForBitAtAnySize) {
  test::on_every_device([&](ocl::DeviceContext& device) {
    const TermValues whole = evaluate_on_device(device, *term_, batch(65));
    for (int n : {0, 1, 63, 64, 65}) {
      for (size_t local : {size_t{0}, size_t{1}, size_t{16}}) {
        const TermValues part = evaluate_on_device(device, *term_, batch(n), local);
        EXPECT_TRUE(std::equal(part.r.begin(), part.r.end(), whole.r.begin())) << n << " in groups of " << local;
        EXPECT_TRUE(std::equal(part.J.begin(), part.J.end(), whole.J.begin())) << n << " in groups of " << local;
      }
    }
  });
}

TEST_P(TermSuite, KinksGiveNumbers) {
  for (const Instance& i : restatement_.kinks) {
    ASSERT_EQ(i.x.size(), term_->n_unknowns);
    ASSERT_EQ(i.params.size(), term_->n_params);
    const Row row = evaluate(i);
    EXPECT_TRUE(row.r.allFinite() && row.J.allFinite());
    test::on_every_device([&](ocl::DeviceContext& device) {
      TermBatch one{1, {i.x.begin(), i.x.end()}, {i.params.begin(), i.params.end()}};
      const TermValues values = evaluate_on_device(device, *term_, one);
      for (float value : values.r) EXPECT_TRUE(std::isfinite(value));
      for (float value : values.J) EXPECT_TRUE(std::isfinite(value));
    });
  }
}

std::vector<std::string> term_names() {
  std::vector<std::string> names;
  for (const Term& term : term_table()) names.emplace_back(term.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(EveryTerm, TermSuite, testing::ValuesIn(term_names()),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace livecap
