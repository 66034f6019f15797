#include "acquire/build_actor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "acquire/person_frame.h"
#include "acquire/true_actor.h"
#include "base/text.h"
#include "eval/compare_actors.h"
#include "image/image_io.h"
#include "livecap/error.h"
#include "meshing/isosurface.h"
#include "scan/scan.h"
#include "support/data_dir.h"
#include "support/onnx_writer.h"
#include "support/test_device.h"
#include "support/tolerances.h"
#include "synth/rehearsal.h"
#include "synth/synth.h"
#include "texture/surface_views.h"

namespace livecap {
namespace {

using acquire::BuildOptions;
using acquire::BuildResult;

// Views of an actor in a folder of its own, and builds from them on the first test device.
class BuildActor : public testing::Test {
 protected:
  BuildActor() : folder_(std::filesystem::path(testing::TempDir()) / "build_actor_test") {
    std::filesystem::remove_all(folder_);
  }
  ~BuildActor() override { std::filesystem::remove_all(folder_); }

  void photograph(const Actor& actor, int n_views, double unit_mm = 1000, int height = 640) {
    synth::RehearsalOptions options;
    options.n_views = n_views;
    options.width = height * 3 / 4;
    options.height = height;
    options.unit_mm = unit_mm;
    synth::write_rehearsal(actor, options, folder_);
  }
  BuildOptions options() const {
    BuildOptions options;
    options.views.images = folder_ / "images";
    options.views.masks = folder_ / "masks";
    options.views.labels = folder_ / "labels";
    return options;
  }
  BuildResult build(const BuildOptions& options) {
    ocl::DeviceContext device(ocl::select_device(test::device_selectors().front()));
    return acquire::build_actor(device, device, options);
  }
  static Actor loaded(const BuildResult& result) { return load_actor_bytes(meshing::actor_glb(result.actor), "built"); }
  static bool noted(const BuildResult& result, const std::string& what) {
    return std::any_of(result.notes.begin(), result.notes.end(),
                       [&](const std::string& note) { return note.find(what) != std::string::npos; });
  }
  std::string failure(const BuildOptions& options) {
    try {
      build(options);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  std::filesystem::path folder_;
};

// Distance to the true surface of the vertices that a picture shows.
Summary seen_distances(const BuildResult& result, const ActorComparison& c) {
  std::vector<double> distances;
  for (size_t i = 0; i < result.seen.size(); ++i)
    if (result.seen[i]) distances.push_back(c.distances_mm[i]);
  return summarize(distances);
}

void print(const char* name, const ActorComparison& c) {
  std::printf("%s: surface %.1f mm (95 %% %.1f), joints %.1f mm, posed %.1f mm, labels %.1f %%\n", name,
              c.built_to_truth_mm.mean, c.built_to_truth_mm.p95, c.joints_mean_mm, c.posed_mm.mean, 100 * c.labels);
}

TEST_F(BuildActor, FromPicturesMeetsTheBars) {
  const Actor& truth = test::builtin_actor("trousers");
  photograph(truth, 70);
  const BuildResult result = build(options());
  const Actor built = loaded(result);
  EXPECT_TRUE(built.guessed_weights);
  EXPECT_FALSE(built.rough_shape);
  const ActorComparison c = compare_actors(built, truth);
  print("trousers", c);
  EXPECT_NEAR(built.n_vertices(), 5000, 250);
  EXPECT_TRUE(is_closed_manifold(result.actor.surface));
  EXPECT_EQ(connected_components(built.n_vertices(), built.mesh.triangles), 1);
  EXPECT_LT(c.built_to_truth_mm.mean, test::kBuiltSurfaceMm);
  EXPECT_LT(c.built_to_truth_mm.p95, test::kBuiltSurfaceP95Mm);
  std::printf("true to built: %.1f mm (95 %% %.1f)\n", c.truth_to_built_mm.mean, c.truth_to_built_mm.p95);
  EXPECT_LT(c.truth_to_built_mm.p95, test::kTrueToBuiltMm) << "fingers or toes are cut off";
  EXPECT_LT(seen_distances(result, c).p95, test::kBuiltSurfaceP95Mm);
  EXPECT_LT(c.joints_mean_mm, test::kBuiltJointsMm);
  EXPECT_GT(c.labels, test::kVotedLabels);
  // The colours of the template: lit by the rehearsal's lamp, so only their order is compared.
  double agree = 0;
  const auto nearest = [&](int i) {
    int best = 0;
    double best_d = 1e9;
    for (int j = 0; j < truth.n_vertices(); ++j) {
      double d = 0;
      for (int k = 0; k < 3; ++k) d += std::pow(built.mesh.positions[3 * i + k] - truth.mesh.positions[3 * j + k], 2);
      if (d < best_d) best_d = d, best = j;
    }
    return best;
  };
  double sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
  int n = 0;
  for (int i = 0; i < built.n_vertices(); i += 7, ++n) {
    const double x = built.colors[3 * i + 2] - built.colors[3 * i], t = nearest(i);
    const double y = truth.colors[3 * static_cast<int>(t) + 2] - truth.colors[3 * static_cast<int>(t)];
    sx += x, sy += y, sxx += x * x, syy += y * y, sxy += x * y;
  }
  agree = (n * sxy - sx * sy) / std::sqrt((n * sxx - sx * sx) * (n * syy - sy * sy));
  EXPECT_GT(agree, test::kColorCorrelation) << "correlation of blue minus red";
}

TEST_F(BuildActor, WithoutMasksOrLabelsInCentimetres) {
  const Actor& truth = test::builtin_actor("skirt");
  photograph(truth, 40, 10);
  BuildOptions build_options = options();
  build_options.views.masks.clear();
  build_options.views.labels.clear();
  const BuildResult result = build(build_options);
  const Actor built = loaded(result);
  EXPECT_FALSE(built.rough_shape);
  const ActorComparison c = compare_actors(built, truth);
  print("skirt, network masks, guessed labels", c);
  std::printf("what pictures show: %.1f mm (95 %% %.1f); overlap %.3f\n", seen_distances(result, c).mean,
              seen_distances(result, c).p95, result.overlap);
  EXPECT_FALSE(noted(result, "covers the masks")) << result.overlap;
  EXPECT_TRUE(noted(result, "taken as cm"));
  EXPECT_TRUE(noted(result, "masks are the network's"));
  EXPECT_TRUE(noted(result, "no label images"));
  EXPECT_LT(c.built_to_truth_mm.median, test::kNetworkMaskMm);
  EXPECT_LT(c.joints_mean_mm, test::kBuiltJointsMm);
  EXPECT_GT(c.labels, test::kGuessedLabels);
}

// A block 400 mm wide and high with a groove from top to bottom in its front (+x), 120 mm wide and 200 mm deep, and 180
// cameras around it, 20 mm above its floor. By hand: every silhouette is that of the whole block, so the groove is a
// concavity although the cameras in front look into it; nobody sees the bottom although it lies on the outline; the
// other sides are on the outline of those cameras that look along them (2 m away, every 2 degrees: one looks along
// every side 9 mm outside of it).
TEST_F(BuildActor, ConcavitiesOfAGroovedBlock) {
  const meshing::DistanceField field = [](const Eigen::Vector3d& p) {
    const double block = std::max({std::abs(p.x()) - 200, std::abs(p.z()) - 200, -p.y(), p.y() - 400});
    return std::max(block, std::min(p.x(), 60 - std::abs(p.z())));
  };
  const Mesh mesh = mesh_of(meshing::extract_surface(field, {-233, -33, -233}, {233, 433, 233}, 18));
  std::filesystem::create_directories(folder_ / "masks");
  write_file_atomically(folder_ / "cameras.txt", "1 PINHOLE 480 480 1000 1000 240.5 240.5\n");
  std::string poses;
  const auto vertex = [&](int i) {
    return Eigen::Vector3d(Eigen::Map<const Eigen::Vector3f>(&mesh.positions[3 * i]).cast<double>());
  };
  for (int view = 0; view < 180; ++view) {
    const Eigen::Vector3d out(std::cos(view * M_PI / 90), 0, std::sin(view * M_PI / 90)), down(0, -1, 0);
    Eigen::Matrix3d turn;
    turn << down.cross(-out).transpose(), down.transpose(), -out.transpose();
    const Eigen::Vector3d shift = -turn * (2000 * out + Eigen::Vector3d(0, 20, 0));
    const Eigen::Quaterniond q(turn);
    poses += format("%d %.9g %.9g %.9g %.9g %.9g %.9g %.9g 1 %03d.png\n\n", view + 1, q.w(), q.x(), q.y(), q.z(),
                    shift.x(), shift.y(), shift.z(), view);
    cv::Mat mask(480, 480, CV_8UC1, cv::Scalar(0));
    for (size_t t = 0; t < mesh.triangles.size(); t += 3) {
      cv::Point corners[3];
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d p = turn * vertex(mesh.triangles[t + k]) + shift;
        corners[k] = {cvRound(1000 * p.x() / p.z() + 240), cvRound(1000 * p.y() / p.z() + 240)};
      }
      cv::fillConvexPoly(mask, corners, 3, cv::Scalar(255));
    }
    write_png(ImageGray{480, 480, {mask.datastart, mask.dataend}}, folder_ / "masks" / format("%03d.png", view));
  }
  write_file_atomically(folder_ / "images.txt", poses);
  ocl::DeviceContext device(ocl::select_device(test::device_selectors().front()));
  const auto told = visible_hull_vertices(device, mesh, folder_, folder_ / "masks", 1);

  int n_groove = 0, n_bottom = 0, n_outside = 0;
  for (int i = 0; i < mesh.n_vertices(); ++i) {
    const Eigen::Vector3d p = vertex(i);
    const double x = p.x(), z = std::abs(p.z());
    if (p.y() < 1 && std::abs(x) < 120 && z < 120 && !(x > -40 && z < 100)) {  // its edge is seen
      ++n_bottom;
      EXPECT_FALSE(told[i]) << "bottom " << p.transpose();
    }
    if (p.y() < 60 || p.y() > 340) continue;  // near the outline above and below
    if ((std::abs(x) < 3 && z < 45) || (std::abs(z - 60) < 3 && x > 15 && x < 150)) {
      ++n_groove;
      EXPECT_FALSE(told[i]) << "groove " << p.transpose();
    } else if ((x < -197 && z < 150) || (z > 197 && std::abs(x) < 150)) {
      ++n_outside;
      EXPECT_TRUE(told[i]) << "outside " << p.transpose();
    }
  }
  EXPECT_GT(n_groove, 100);
  EXPECT_GT(n_bottom, 100);
  EXPECT_GT(n_outside, 300);
  write_file_atomically(folder_ / "cameras.txt", "1 RADIAL 480 480 1000 240.5 240.5 0.1 0\n");
  EXPECT_THROW(visible_hull_vertices(device, mesh, folder_, folder_ / "masks", 1), ConfigError) << "distorted";
  write_file_atomically(folder_ / "cameras.txt", "1 PINHOLE 480 480 1000 1000 240.5 240.5\n");
  std::filesystem::remove(folder_ / "masks" / "003.png");
  EXPECT_THROW(visible_hull_vertices(device, mesh, folder_, folder_ / "masks", 1), IoError);
}

// A network that knows the mean colours of background, top and trousers in ten of the pictures: 2 m.x - |m|^2 is
// largest for the nearest mean m. (Hair and shoes have the colour of trousers in the shade.)
std::string color_network(const std::filesystem::path& folder) {
  const acquire::ParserOptions input;
  double sums[20][3] = {}, counts[20] = {};
  for (int i = 0; i < 10; ++i) {
    const ImageRgb image = read_image_rgb(folder / "images" / format("%03d.png", i));
    const ImageGray labels = read_image_gray(folder / "labels" / format("%03d.png", i));
    for (size_t p = 0; p < labels.pixels.size(); ++p) {
      for (int c = 0; c < 3; ++c)
        sums[labels.pixels[p]][c] += (image.pixels[3 * p + c] / 255.0 - input.mean[c]) / input.deviation[c];
      ++counts[labels.pixels[p]];
    }
  }
  std::vector<float> weights(60, 0.0f), bias(20, -1e6f);
  for (int k : {0, 5, 9}) {
    bias[k] = 0;
    for (int c = 0; c < 3; ++c) {
      const double mean = sums[k][c] / counts[k];
      weights[3 * k + c] = static_cast<float>(2 * mean);
      bias[k] -= static_cast<float>(mean * mean);
    }
  }
  test::OnnxWriter net;
  net.floats("w", {20, 3, 1, 1}, weights);
  net.floats("b", {20}, bias);
  net.node("Conv", {"x", "w", "b"}, "scores");
  return net.model({1, 3, 320, 200}, {"scores"});
}

TEST_F(BuildActor, LabelsFromAParsingNetwork) {
  const Actor& truth = test::builtin_actor("trousers");
  photograph(truth, 30);
  BuildOptions build_options = options();
  build_options.views.labels.clear();
  build_options.parser.network = folder_ / "color.onnx";
  write_file_atomically(build_options.parser.network, color_network(folder_));
  const BuildResult result = build(build_options);
  EXPECT_FALSE(noted(result, "guessed"));
  // What the network knows, of the vertices that truly are top or trousers.
  const Actor built = loaded(result);
  int n = 0, right = 0;
  for (int i = 0; i < built.n_vertices(); i += 3) {
    int best = 0;
    double best_d = 1e9;
    for (int j = 0; j < truth.n_vertices(); ++j) {
      double d = 0;
      for (int k = 0; k < 3; ++k) d += std::pow(built.mesh.positions[3 * i + k] - truth.mesh.positions[3 * j + k], 2);
      if (d < best_d) best_d = d, best = j;
    }
    if (truth.labels[best] != 5 && truth.labels[best] != 9) continue;
    ++n;
    right += built.labels[i] == truth.labels[best];
  }
  std::printf("labels by a network of colours: %.1f %% of %d right\n", 100.0 * right / n, n);
  EXPECT_GT(right, test::kGuessedLabels * n);
}

TEST_F(BuildActor, FromTheRecordedActor) {
  LIVECAP_DATA_OR_SKIP(path, "skirt_dance/actor.glb");
  const Actor truth = load_actor(path);
  photograph(truth, 70, 1000, 960);
  const BuildResult result = build(options());
  ocl::DeviceContext device(ocl::select_device(test::device_selectors().front()));
  const std::vector<char> told = visible_hull_vertices(device, truth.mesh, folder_, folder_ / "masks", 1000);
  const ActorComparison c = compare_actors(loaded(result), truth, 20, told);
  print("recorded", c);
  const auto n_hidden = std::count(c.hidden.begin(), c.hidden.end(), 1);
  std::printf("recorded, without concavities: %.1f mm (95 %% %.1f), %td vertices left out\n",
              c.seen_built_to_truth_mm.mean, c.seen_built_to_truth_mm.p95, n_hidden);
  EXPECT_LT(c.seen_built_to_truth_mm.p95, test::kBuiltSurfaceP95Mm);
  EXPECT_LT(n_hidden, test::kConcaveShare * c.hidden.size()) << "the exception must not swallow the actor";
  const Summary seen = seen_distances(result, c);
  std::printf("recorded, what pictures show: %.1f mm (95 %% %.1f)\n", seen.mean, seen.p95);
  EXPECT_LT(c.built_to_truth_mm.mean, test::kBuiltSurfaceMm);
  EXPECT_LT(seen.mean, test::kBuiltSurfaceMm);
  EXPECT_LT(c.joints_mean_mm, test::kBuiltJointsMm);
  EXPECT_GT(c.labels, test::kVotedLabels);
}

TEST_F(BuildActor, FromAScanAlone) {
  const Actor& truth = test::builtin_actor("trousers");
  std::filesystem::create_directories(folder_);
  // In inches, standing along Z, with a hole in the crown.
  std::string obj;
  for (int i = 0; i < truth.n_vertices(); ++i) {
    const float* p = &truth.mesh.positions[3 * i];
    obj += format("v %.9g %.9g %.9g %.4g %.4g %.4g\n", p[0] / 25.4, -p[2] / 25.4, p[1] / 25.4, truth.colors[3 * i],
                  truth.colors[3 * i + 1], truth.colors[3 * i + 2]);
  }
  for (size_t t = 0; t < truth.mesh.triangles.size(); t += 3) {
    const int32_t* v = &truth.mesh.triangles[t];
    if (truth.mesh.positions[3 * v[0] + 1] < 1690) obj += format("f %d %d %d\n", v[0] + 1, v[1] + 1, v[2] + 1);
  }
  write_file_atomically(folder_ / "scan.obj", obj);
  BuildOptions build_options;
  build_options.mesh = folder_ / "scan.obj";
  const BuildResult result = build(build_options);
  const Actor built = loaded(result);
  EXPECT_FALSE(built.rough_shape);
  const ActorComparison c = compare_actors(built, truth);
  print("scan", c);
  EXPECT_TRUE(noted(result, "taken as inch"));
  EXPECT_TRUE(noted(result, "not closed"));
  EXPECT_LT(c.built_to_truth_mm.mean, test::kScanSurfaceMm);
  EXPECT_LT(c.joints_mean_mm, test::kBuiltJointsMm);
}

TEST_F(BuildActor, FromAVideoOfATurn) {
  SynthOptions synth;
  synth.actor = "trousers";
  synth.motions = {"turntable"};
  synth.width = 480, synth.height = 640, synth.fps = 15;
  synth.distance_mm = 2900, synth.fov_deg = 46, synth.empty_frames = 3;
  write_sequence(synth, folder_);
  BuildOptions build_options;
  build_options.turntable.video = (folder_ / "video.mp4").string();
  build_options.turntable.camera = (folder_ / "camera.json").string();
  build_options.height_mm = 1700;
  const BuildResult result = build(build_options);
  const Actor built = loaded(result);
  EXPECT_TRUE(built.rough_shape);
  const ActorComparison c = compare_actors(built, test::builtin_actor("trousers"));
  print("turntable", c);
  std::printf("%s; overlap %.3f\n", result.turn.c_str(), result.overlap);
  EXPECT_FALSE(noted(result, "covers the masks")) << result.overlap;
  EXPECT_GT(result.n_views, 50);
  EXPECT_LT(c.built_to_truth_mm.mean, test::kTurntableSurfaceMm);
  EXPECT_LT(c.joints_mean_mm, test::kTurntableJointsMm);
  EXPECT_GT(c.labels, test::kGuessedLabels);

  // What does not go together, and a camera for another size.
  build_options.views.images = folder_;
  EXPECT_NE(failure(build_options).find("--images does not go with --video"), std::string::npos);
  build_options.views.images.clear();
  build_options.turntable.fov_deg = 40;
  EXPECT_NE(failure(build_options).find("either --camera or --fov"), std::string::npos);
  build_options.turntable.fov_deg = 0;
  build_options.turntable.n_views = 3;
  EXPECT_NE(failure(build_options).find("--views 3"), std::string::npos);
  build_options.turntable.n_views = 70;
  write_file_atomically(folder_ / "wide.json",
                        R"({"width":640,"height":480,"fx":500,"fy":500,"cx":320,"cy":240,"distortion":[0,0,0,0,0]})");
  build_options.turntable.camera = (folder_ / "wide.json").string();
  EXPECT_NE(failure(build_options).find("640x480"), std::string::npos) << failure(build_options);
  build_options.turntable.video = "webcam:0";
  EXPECT_NE(failure(build_options).find("record it first"), std::string::npos);
  build_options.turntable.video = (folder_ / "none.mp4").string();
  EXPECT_NE(failure(build_options).find("none.mp4"), std::string::npos);
  build_options.turntable.video.clear();
  EXPECT_NE(failure(build_options).find("belong to --video"), std::string::npos) << failure(build_options);
}

// The same cameras in a world that leans by 5 degrees, as COLMAP leaves it: the actor stands as in the upright one.
TEST_F(BuildActor, TheAxesOfAColmapModelMeanNothing) {
  photograph(test::builtin_actor("trousers"), 12, 1000, 320);
  std::vector<std::string> notes;
  EXPECT_EQ(acquire::vertical_of(load_views(options().views, notes)).cwiseAbs(), Eigen::Vector3d(0, 1, 0));
  const BuildResult upright = build(options());
  const Eigen::Quaterniond lean(Eigen::AngleAxisd(5 * M_PI / 180, Eigen::Vector3d(1, 0, 0.5).normalized()));
  std::string poses;
  const std::vector<ViewPose> views = read_view_poses(folder_);
  for (size_t i = 0; i < views.size(); ++i) {
    const Eigen::Quaterniond q = Eigen::Quaterniond(views[i].camera_from_world.linear()) * lean.inverse();
    const Eigen::Vector3d t = views[i].camera_from_world.translation();
    poses += format("%zu %.12g %.12g %.12g %.12g %.12g %.12g %.12g 1 %s\n\n", i + 1, q.w(), q.x(), q.y(), q.z(), t.x(),
                    t.y(), t.z(), views[i].picture.c_str());
  }
  write_file_atomically(folder_ / "images.txt", poses);
  const BuildResult leaning = build(options());
  const auto spine = [](const BuildResult& result) {
    return Eigen::Vector3d(result.joints[acquire::kNeckBone] - result.joints[acquire::kHipsBone]).normalized();
  };
  const double angle = std::acos(std::min(1.0, spine(upright).dot(spine(leaning))));
  std::printf("spines: %.2f degrees apart\n", angle * 180 / M_PI);
  EXPECT_LT(angle, test::kLeanRad);
  EXPECT_TRUE(noted(leaning, "COLMAP model, whose world has no unit"));
}

TEST_F(BuildActor, PicturesOfTwoPeopleAreTold) {
  photograph(test::builtin_actor("trousers"), 16, 1000, 320);
  const BuildResult one = build(options());
  const auto other = folder_ / "other";
  synth::RehearsalOptions rehearsal;
  rehearsal.n_views = 16;
  rehearsal.width = 240;
  rehearsal.height = 320;
  synth::write_rehearsal(test::builtin_actor("skirt"), rehearsal, other);
  for (int i = 0; i < 16; i += 2)
    for (const char* kind : {"images", "masks", "labels"})
      std::filesystem::copy_file(other / kind / format("%03d.png", i), folder_ / kind / format("%03d.png", i),
                                 std::filesystem::copy_options::overwrite_existing);
  const BuildResult two = build(options());
  std::printf("overlap with the masks: one person %.3f, two people %.3f\n", one.overlap, two.overlap);
  EXPECT_FALSE(noted(one, "covers the masks"));
  EXPECT_TRUE(noted(two, "covers the masks"));
}

TEST_F(BuildActor, BadPicturesAreRefusedOrTold) {
  photograph(test::builtin_actor("trousers"), 12, 1000, 320);
  BuildOptions build_options = options();
  EXPECT_NE(failure({}).find("--images, --video or --mesh"), std::string::npos);
  build_options.unit = "feet";
  EXPECT_NE(failure(build_options).find("--unit feet"), std::string::npos);
  build_options.unit = "cm";  // they are metres
  EXPECT_NE(failure(build_options).find("--unit"), std::string::npos) << failure(build_options);
  build_options = options();
  build_options.views.masks = folder_ / "none";
  EXPECT_NE(failure(build_options).find("none"), std::string::npos);
  build_options = options();
  build_options.model = "none.tflite";
  EXPECT_NE(failure(build_options).find("none.tflite"), std::string::npos);

  // Two blurred pictures, one that is no picture, one mask missing: told, and built without them.
  for (const char* name : {"003.png", "007.png"}) {
    ImageRgb image = read_image_rgb(folder_ / "images" / name);
    cv::Mat pixels(image.height, image.width, CV_8UC3, image.pixels.data());
    cv::blur(pixels, pixels, {21, 21});
    write_png(image, folder_ / "images" / name);
  }
  write_file_atomically(folder_ / "images" / "005.png", "no picture");
  std::filesystem::remove(folder_ / "masks" / "001.png");
  const BuildResult result = build(options());
  EXPECT_EQ(result.n_views, 9);
  EXPECT_TRUE(noted(result, "003.png: blurred"));
  EXPECT_TRUE(noted(result, "007.png: blurred"));
  EXPECT_TRUE(noted(result, "005.png"));
  EXPECT_TRUE(noted(result, "1 pictures have no mask"));

  // Pictures in colour where label images should be.
  for (int i = 0; i < 12; ++i)
    write_png(ImageGray{240, 320, std::vector<uint8_t>(240 * 320, 200)}, folder_ / "labels" / format("%03d.png", i));
  const BuildResult guessed = build(options());
  EXPECT_TRUE(noted(guessed, "must hold LIP ids"));
  EXPECT_TRUE(noted(guessed, "guessed from body parts"));
  EXPECT_NE(*std::max_element(guessed.actor.labels.begin(), guessed.actor.labels.end()), 0);

  for (int i = 3; i < 12; ++i) std::filesystem::remove(folder_ / "images" / format("%03d.png", i));
  EXPECT_NE(failure(options()).find("3 usable pictures"), std::string::npos) << failure(options());
  std::filesystem::remove(folder_ / "cameras.txt");
  EXPECT_NE(failure(options()).find("cameras.txt"), std::string::npos) << failure(options());
}

}  // namespace
}  // namespace livecap
