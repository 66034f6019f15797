#include "export/bvh.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <sstream>

#include "base/text.h"
#include "export/motion_fixture.h"
#include "livecap/error.h"
#include "support/comma_locale.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

// A reader of its own: any hierarchy, any channel order.
struct BvhNode {
  std::string name;
  int parent;
  Eigen::Vector3d offset;
  std::vector<std::string> channels;
};
struct BvhFile {
  std::vector<BvhNode> nodes;
  double frame_time = 0;
  std::vector<std::vector<double>> frames;
};

BvhFile parse_bvh(const std::string& text) {
  BvhFile file;
  std::istringstream in(text);
  std::vector<int> open;
  std::string word;
  int n_frames = 0;
  while (in >> word && word != "MOTION") {
    if (word == "ROOT" || word == "JOINT" || word == "End") {
      BvhNode node;
      in >> node.name;
      node.parent = open.empty() ? -1 : open.back();
      file.nodes.push_back(node);
    } else if (word == "{") {
      open.push_back(static_cast<int>(file.nodes.size()) - 1);
    } else if (word == "}") {
      open.pop_back();
    } else if (word == "OFFSET") {
      auto& o = file.nodes.back().offset;
      in >> o[0] >> o[1] >> o[2];
    } else if (word == "CHANNELS") {
      int n;
      in >> n;
      file.nodes.back().channels.resize(n);
      for (auto& c : file.nodes.back().channels) in >> c;
    }
  }
  in >> word >> n_frames >> word >> word >> file.frame_time;
  size_t n_channels = 0;
  for (const auto& node : file.nodes) n_channels += node.channels.size();
  for (int f = 0; f < n_frames; ++f) {
    file.frames.emplace_back(n_channels);
    for (double& x : file.frames.back()) in >> x;
  }
  EXPECT_TRUE(in) << "fewer numbers than frames";
  EXPECT_FALSE(in >> word) << "more numbers than frames";
  return file;
}

std::map<std::string, Eigen::Vector3d> evaluate(const BvhFile& file, int frame) {
  std::vector<Eigen::Isometry3d> world(file.nodes.size());
  std::map<std::string, Eigen::Vector3d> positions;
  size_t at = 0;
  for (size_t i = 0; i < file.nodes.size(); ++i) {
    const BvhNode& node = file.nodes[i];
    world[i] = node.parent < 0 ? Eigen::Isometry3d::Identity() : world[node.parent];
    world[i].translate(node.offset);
    for (const std::string& channel : node.channels) {
      const double value = file.frames[frame][at++];
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(channel[0] - 'X');
      if (channel.substr(1) == "position")
        world[i].translate(value * axis);
      else
        world[i].rotate(Eigen::AngleAxisd(value * std::numbers::pi / 180, axis));
    }
    positions[node.name] = world[i].translation();
  }
  return positions;
}

TEST(Bvh, EvaluatesToTheSamePositionsAsForwardKinematics) {
  const Actor actor = test::small_actor();
  const std::vector<Pose> poses = test::smooth_motion(actor.skeleton, 40);
  const auto path = std::filesystem::path(testing::TempDir()) / "motion.bvh";
  for (double unit_m : {0.01, 1.0}) {
    write_bvh(path, actor, poses, 25, unit_m);
    const BvhFile file = parse_bvh(read_file(path));
    ASSERT_EQ(file.frames.size(), poses.size());
    EXPECT_NEAR(file.frame_time, 0.04, test::kDoubleExact);
    for (size_t f = 0; f < poses.size(); ++f) {
      const auto positions = evaluate(file, static_cast<int>(f));
      const PosedSkeleton posed = forward_kinematics(actor.skeleton, poses[f]);
      for (int b = 0; b < actor.skeleton.n_bones(); ++b) {
        const Eigen::Vector3d mm = posed.camera_from_bone[b].translation();
        const Eigen::Vector3d expected = Eigen::Vector3d(mm.x(), -mm.y(), -mm.z()) / 1000;
        EXPECT_LT((positions.at(actor.skeleton.bones[b].name) * unit_m - expected).norm(), test::kBvhMetres)
            << b << " " << f;
      }
    }
  }
}

TEST(Bvh, IsCompleteAfterEveryFrameAndHoldsTheLastPose) {
  const Actor actor = test::small_actor();
  const std::vector<Pose> poses = test::smooth_motion(actor.skeleton, 3);
  const auto path = std::filesystem::path(testing::TempDir()) / "growing.bvh";
  BvhWriter writer(path, actor, 30);
  EXPECT_EQ(parse_bvh(read_file(path)).frames.size(), 0u);
  writer.append_held();
  EXPECT_EQ(parse_bvh(read_file(path)).frames.size(), 1u);
  writer.append(poses[0]);
  writer.append_held();
  writer.append(poses[1]);
  const BvhFile file = parse_bvh(read_file(path));
  ASSERT_EQ(file.frames.size(), 4u);
  EXPECT_EQ(file.frames[1], file.frames[2]);
  EXPECT_NE(file.frames[2], file.frames[3]);
  EXPECT_THROW(BvhWriter(path, actor, 0), ConfigError);
  EXPECT_THROW(BvhWriter("/nonexistent/x.bvh", actor, 30), IoError);
}

TEST(Bvh, NumbersHaveAPointInEveryLocale) {
  LIVECAP_COMMA_LOCALE_OR_SKIP(commas);
  const Actor actor = test::small_actor();
  const auto path = std::filesystem::path(testing::TempDir()) / "locale.bvh";
  write_bvh(path, actor, test::smooth_motion(actor.skeleton, 2), 29.97);
  const std::string text = read_file(path);
  EXPECT_EQ(text.find(','), std::string::npos);
  EXPECT_NE(text.find("Frame Time: 0.033366700\n"), std::string::npos);
}

TEST(Bvh, AnglesDoNotJumpAndSurviveTheSingularity) {
  auto rebuild = [](const Eigen::Vector3d& zxy) {
    const Eigen::Vector3d r = zxy * std::numbers::pi / 180;
    return Eigen::Matrix3d(Eigen::AngleAxisd(r[0], Eigen::Vector3d::UnitZ()) *
                           Eigen::AngleAxisd(r[1], Eigen::Vector3d::UnitX()) *
                           Eigen::AngleAxisd(r[2], Eigen::Vector3d::UnitY()));
  };
  Eigen::Vector3d previous = Eigen::Vector3d::Zero();
  for (int i = 0; i < 400; ++i) {
    const Eigen::Matrix3d rotation = rebuild({3.0 * i, 60 * std::sin(0.05 * i), -2.0 * i});
    const Eigen::Vector3d zxy = zxy_from_rotation(rotation, previous);
    EXPECT_LT((rebuild(zxy) - rotation).norm(), test::kDoubleExact);
    EXPECT_LT((zxy - previous).cwiseAbs().maxCoeff(), 10) << i;
    previous = zxy;
  }
  for (double x : {90.0, -90.0}) {
    const Eigen::Matrix3d rotation = rebuild({25, x, 10});
    EXPECT_LT((rebuild(zxy_from_rotation(rotation, {0, 80, 7})) - rotation).norm(), test::kDirectionFloat);
  }
}

}  // namespace
}  // namespace livecap
