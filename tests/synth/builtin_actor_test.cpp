// The built-in actors as files: closed, skinned, labelled, textured.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "actor/actor.h"
#include "geometry/mesh.h"
#include "glb_file.h"
#include "livecap/error.h"
#include "support/tolerances.h"
#include "synth/synth.h"

namespace livecap {
namespace {

using Eigen::Vector3d;

const std::string& glb_bytes(const std::string& name) {
  static std::map<std::string, std::string> cache;
  std::string& bytes = cache[name];
  if (bytes.empty()) bytes = make_builtin_actor_glb(name);
  return bytes;
}

class BuiltinActor : public testing::TestWithParam<std::string> {
 protected:
  test::GlbFile file = test::read_glb(glb_bytes(GetParam()));
};

TEST_P(BuiltinActor, IsOneClosedManifold) {
  EXPECT_NEAR(static_cast<double>(file.vertices.size()), 5000, 500);
  std::map<std::pair<int, int>, int> edges;
  std::vector<int> flat;
  std::vector<std::map<int, int>> fans(file.vertices.size());
  for (const auto& t : file.triangles)
    for (int i = 0; i < 3; ++i) {
      ++edges[{t[i], t[(i + 1) % 3]}];
      flat.push_back(t[i]);
      fans[t[i]][t[(i + 1) % 3]] = t[(i + 2) % 3];
    }
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1) << "edge " << edge.first << "-" << edge.second << " runs twice the same way";
    ASSERT_TRUE(edges.count({edge.second, edge.first})) << "open edge " << edge.first << "-" << edge.second;
  }
  EXPECT_EQ(connected_components(static_cast<int>(file.vertices.size()), flat), 1);
  EXPECT_EQ(static_cast<int>(file.vertices.size() + file.triangles.size()) - static_cast<int>(edges.size() / 2), 2)
      << "no handles";
  for (const auto& fan : fans) {  // the triangles around a vertex are one closed ring
    size_t length = 1;
    for (int at = fan.at(fan.begin()->first); at != fan.begin()->first && length <= fan.size(); at = fan.at(at))
      ++length;
    ASSERT_EQ(length, fan.size());
  }
}

TEST_P(BuiltinActor, HasSoundTrianglesTurnedOutwards) {
  double volume = 0;
  for (const auto& t : file.triangles) {
    const Vector3d &a = file.vertices[t[0]], &b = file.vertices[t[1]], &c = file.vertices[t[2]];
    volume += a.dot(b.cross(c)) / 6;
    const double longest = std::max({(a - b).norm(), (b - c).norm(), (c - a).norm()});
    EXPECT_GT((b - a).cross(c - a).norm(), test::kSliver * longest * longest);
    EXPECT_LT(longest, 0.07) << "m; a hole in the sampling of the cloth";
  }
  EXPECT_GT(volume, 0.05) << "m^3";
  EXPECT_LT(volume, 0.2);
}

TEST_P(BuiltinActor, HasTheHeightAskedFor) {
  for (const double height_mm : {1700.0, 1834.0}) {
    const auto tall =
        test::read_glb(height_mm == 1700 ? glb_bytes(GetParam()) : make_builtin_actor_glb(GetParam(), height_mm));
    double low = 9, high = -9;
    for (const Vector3d& p : tall.vertices) low = std::min(low, p.y()), high = std::max(high, p.y());
    EXPECT_NEAR(low, 0, test::kFloatRelative);
    EXPECT_NEAR(high, height_mm / 1000, test::kFloatRelative);
  }
}

TEST_P(BuiltinActor, HasNormalisedSmoothWeights) {
  const auto joints = file.attribute<uint16_t>("JOINTS_0");
  const auto weights = file.attribute<float>("WEIGHTS_0");
  const size_t n_bones = file.model.skins.at(0).joints.size();
  std::vector<std::map<int, double>> rows(file.vertices.size());
  for (size_t i = 0; i < weights.size() / 4; ++i) {
    double sum = 0;
    for (int k = 0; k < 4; ++k) {
      ASSERT_LT(joints[4 * i + k], n_bones);
      ASSERT_GE(weights[4 * i + k], 0);
      if (k > 0) ASSERT_LE(weights[4 * i + k], weights[4 * i + k - 1]);
      sum += weights[4 * i + k];
      if (weights[4 * i + k] > 0) rows[file.welded[i]][joints[4 * i + k]] = weights[4 * i + k];
    }
    ASSERT_NEAR(sum, 1, test::kFloatRelative);
  }
  std::set<int> used;
  for (const auto& row : rows)
    for (const auto& [bone, weight] : row) used.insert(bone);
  EXPECT_EQ(used.size(), n_bones) << "every bone moves something";
  for (const auto& t : file.triangles) {
    double change = 0;
    for (size_t bone = 0; bone < n_bones; ++bone) {
      const auto value = [&](int v) {
        return rows[v].count(static_cast<int>(bone)) ? rows[v].at(static_cast<int>(bone)) : 0;
      };
      change += 0.5 * std::abs(value(t[0]) - value(t[1]));
    }
    EXPECT_LT(change, 0.75) << "weights jump along an edge at " << file.vertices[t[0]].transpose();
  }
}

// A limb bends where its two bones move the surface alike: on average over the ring of these vertices at the joint.
TEST_P(BuiltinActor, BendsAtItsJoints) {
  const auto joints = file.attribute<uint16_t>("JOINTS_0");
  const auto weights = file.attribute<float>("WEIGHTS_0");
  const auto& skin = file.model.skins.at(0);
  const auto inverse_bind = file.values<float>(skin.inverseBindMatrices);
  const auto bone = [&](const std::string& name) {
    for (size_t k = 0; k < skin.joints.size(); ++k)
      if (file.model.nodes[skin.joints[k]].name == name) return k;
    ADD_FAILURE() << "no bone " << name;
    return size_t{0};
  };
  const auto place = [&](size_t k) -> Vector3d {
    return -Vector3d(inverse_bind[16 * k + 12], inverse_bind[16 * k + 13], inverse_bind[16 * k + 14]);
  };
  for (const auto& [upper_name, lower_name] : {std::pair{"LeftArm", "LeftForeArm"},
                                               {"RightArm", "RightForeArm"},
                                               {"LeftUpLeg", "LeftLeg"},
                                               {"RightUpLeg", "RightLeg"},
                                               {"LeftLeg", "LeftFoot"},
                                               {"RightLeg", "RightFoot"},
                                               {"Spine2", "Neck"}}) {
    const size_t upper = bone(upper_name), lower = bone(lower_name);
    const Vector3d along = (place(lower) - place(upper)).normalized();
    std::vector<double> at_mm;
    for (size_t v = 0; v < file.vertices.size(); ++v) {
      double of_upper = 0, of_lower = 0;
      for (size_t k = 4 * file.first[v]; k < 4 * file.first[v] + 4u; ++k)
        if (joints[k] == upper || joints[k] == lower) (joints[k] == upper ? of_upper : of_lower) += weights[k];
      if (of_upper > 0.3 && of_lower > 0.3) at_mm.push_back(1000 * along.dot(file.vertices[v] - place(lower)));
    }
    ASSERT_GE(at_mm.size(), 8u) << lower_name;
    double mean = 0;
    for (const double mm : at_mm) mean += mm / static_cast<double>(at_mm.size());
    const bool is_ankle = std::string(lower_name).ends_with("Foot");
    EXPECT_NEAR(mean, 0, is_ankle ? test::kBendsAtAnkleMm : test::kBendsAtJointMm) << lower_name;
  }
}

TEST_P(BuiltinActor, HasBonesBoundWhereTheyStand) {
  const auto& model = file.model;
  const auto& skin = model.skins.at(0);
  const auto inverse = file.values<float>(skin.inverseBindMatrices);
  std::vector<int> parent(model.nodes.size(), -1);
  for (size_t i = 0; i < model.nodes.size(); ++i)
    for (int child : model.nodes[i].children) parent[child] = static_cast<int>(i);
  std::map<std::string, Vector3d> at;
  for (size_t k = 0; k < skin.joints.size(); ++k) {
    Vector3d position = Vector3d::Zero();
    for (int node = skin.joints[k]; node >= 0; node = parent[node]) {
      const auto& t = model.nodes[node].translation;
      position += Vector3d(t.at(0), t.at(1), t.at(2));
    }
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(inverse[16 * k + 12 + axis], -position[axis], test::kFloatRelative);
    at[model.nodes[skin.joints[k]].name] = position;
  }
  for (const std::string side : {"Left", "Right"}) {
    const double sign = side == "Left" ? 1 : -1;
    for (const char* bone : {"Shoulder", "Arm", "ForeArm", "Hand", "UpLeg", "Leg", "Foot", "ToeBase"}) {
      ASSERT_TRUE(at.count(side + bone)) << side + bone;
      EXPECT_GT(sign * at[side + bone].x(), 0);
    }
    const Vector3d arm = at[side + "Hand"] - at[side + "Arm"];
    const double below_horizontal = std::atan2(-arm.y(), sign * arm.x()) * 180 / M_PI;
    EXPECT_GT(below_horizontal, 0);
    EXPECT_LT(below_horizontal, 40);
  }
  for (const char* bone : {"Hips", "Spine", "Neck", "Head"}) ASSERT_TRUE(at.count(bone)) << bone;
  EXPECT_GT(at["Head"].y(), at["Neck"].y());
  EXPECT_GT(at["LeftToeBase"].z(), at["LeftFoot"].z()) << "+Z is the front";
}

TEST_P(BuiltinActor, HasLabelsAndMarkers) {
  const auto labels = file.attribute<float>("_LABEL");
  std::map<int, int> count;
  for (int file_vertex : file.first) {
    ASSERT_EQ(labels[file_vertex], std::round(labels[file_vertex]));
    ++count[static_cast<int>(labels[file_vertex])];
  }
  std::set<int> expected = {2, 5, 13, 14, 15, 18, 19};
  if (GetParam() == "skirt") expected.insert({12, 16, 17});
  if (GetParam() == "trousers") expected.insert(9);
  std::set<int> found;
  for (const auto& [label, n] : count) {
    found.insert(label);
    EXPECT_GT(n, 20) << "label " << label;
  }
  EXPECT_EQ(found, expected);
  for (size_t i = 0; i < file.vertices.size(); ++i) {  // sides of arms, legs, shoes
    const int label = static_cast<int>(labels[file.first[i]]);
    if (label >= 14) EXPECT_EQ(file.vertices[i].x() > 0, label % 2 == 0) << "label " << label;
  }
  EXPECT_FALSE(file.model.meshes.at(0).extras.Get("livecap").Has("weights")) << "painted";
  const auto& markers = file.model.meshes.at(0).extras.Get("livecap").Get("markers");
  const auto marker = [&](const char* name) { return file.vertices.at(markers.Get(name).GetNumberAsInt()); };
  const Vector3d left = marker("left_eye"), right = marker("right_eye"), nose = marker("nose"), chin = marker("chin");
  EXPECT_NEAR(left.x(), 0.031, 0.015);
  EXPECT_NEAR(right.x(), -0.031, 0.015);
  EXPECT_NEAR(nose.x(), 0, 0.01);
  EXPECT_GT(nose.z(), std::max({left.z(), right.z(), chin.z()}));
  EXPECT_GT(std::min(left.y(), right.y()), nose.y());
  EXPECT_GT(nose.y(), chin.y());
}

TEST_P(BuiltinActor, HasAColourfulTextureWithoutOverlaps) {
  ASSERT_EQ(file.model.images.size(), 1u);
  const auto& image = file.model.images[0];
  ASSERT_EQ(image.width, 1024);
  ASSERT_EQ(image.height, 1024);
  const auto uvs = file.attribute<float>("TEXCOORD_0");
  cv::Mat count = cv::Mat::zeros(1024, 1024, CV_8U);
  std::set<int> colors;
  for (const auto& t : file.file_triangles) {
    Eigen::Vector2d c[3];
    for (int i = 0; i < 3; ++i) {
      c[i] = {uvs[2 * t[i]] * 1024 - 0.5, uvs[2 * t[i] + 1] * 1024 - 0.5};
      ASSERT_TRUE(c[i].minCoeff() > 0 && c[i].maxCoeff() < 1023);
    }
    const double area = (c[1] - c[0]).x() * (c[2] - c[0]).y() - (c[1] - c[0]).y() * (c[2] - c[0]).x();
    for (int y = static_cast<int>(std::min({c[0].y(), c[1].y(), c[2].y()}));
         y <= std::max({c[0].y(), c[1].y(), c[2].y()}); ++y)
      for (int x = static_cast<int>(std::min({c[0].x(), c[1].x(), c[2].x()}));
           x <= std::max({c[0].x(), c[1].x(), c[2].x()}); ++x) {
        bool inside = true;
        for (int i = 0; i < 3; ++i) {
          const Eigen::Vector2d e = c[(i + 1) % 3] - c[i], q = Eigen::Vector2d(x, y) - c[i];
          inside = inside && (e.x() * q.y() - e.y() * q.x()) * area > 0;
        }
        if (!inside) continue;
        ++count.at<uint8_t>(y, x);
        const unsigned char* p = &image.image[(static_cast<size_t>(y) * 1024 + x) * image.component];
        colors.insert((p[0] / 32) * 64 + (p[1] / 32) * 8 + p[2] / 32);
      }
  }
  const double once = cv::countNonZero(count), twice = cv::countNonZero(count > 1);
  EXPECT_GT(once, 0.35 * 1024 * 1024) << "the page is used";
  EXPECT_LT(twice, test::kTextureOverlap * once);
  EXPECT_GT(colors.size(), 60u);
}

TEST_P(BuiltinActor, IsTheSameEveryTime) {
  EXPECT_TRUE(make_builtin_actor_glb(GetParam()) == glb_bytes(GetParam()));
}

TEST_P(BuiltinActor, LoadsAsAnActor) {
  const Actor actor = load_actor_bytes(glb_bytes(GetParam()), GetParam(), 1800);
  EXPECT_EQ(actor.n_vertices(), static_cast<int>(file.vertices.size()));
  for (int keypoint = 0; keypoint < kKeypointCount; ++keypoint)
    EXPECT_GE(actor.keypoints[keypoint].bone, 0) << kKeypointNames[keypoint];
}

INSTANTIATE_TEST_SUITE_P(Actors, BuiltinActor, testing::ValuesIn(builtin_actor_names()),
                         [](const auto& info) { return info.param; });

TEST(BuiltinActor, RefusesWhatItCannotMake) {
  EXPECT_THROW(make_builtin_actor_glb("kilt"), ConfigError);
  EXPECT_THROW(make_builtin_actor_glb("skirt", 12), ConfigError);
  EXPECT_THROW(make_builtin_actor_glb("skirt", NAN), ConfigError);
  EXPECT_THROW(make_builtin_actor_glb("skirt", 1700, 3), ConfigError);
}

}  // namespace
}  // namespace livecap
