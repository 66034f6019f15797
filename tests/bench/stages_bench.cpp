// The image stages and both solvers against widely used libraries and plain C++ doing the same, one thread each: what
// the project's bars for single stages are measured with.
//
//   bench_stages --sequence=FOLDER [--device=SELECTOR] [Google Benchmark's options]
//
// FOLDER: of `livecap synth` (5,000 vertices, 540x960).
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <cstdio>
#include <limits>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/background_segm.hpp>
#include <stdexcept>

#include "actor/skinner.h"
#include "base/text.h"
#include "eigen_pose.h"
#include "image/device_distance.h"
#include "image/foreground.h"
#include "image/image_io.h"
#include "image/video.h"
#include "pose/pose_solver.h"
#include "race.h"
#include "raster/visibility.h"
#include "support/pose_scene.h"
#include "support/tolerances.h"
#include "surface/surface_system.h"

namespace livecap {
namespace {

constexpr int kContour = 500;
constexpr int kSteps = 6;
constexpr int kPcg = 4;

// The actor near where the picture shows it.
struct Scene {
  Scene(ocl::DeviceContext& device, const std::filesystem::path& folder)
      : actor(load_actor(folder / "actor.glb")),
        camera(load_camera(folder / "camera.json")),
        truth(test::standing_pose(actor, 0.3)),
        skinner(device, actor),
        raster(device, actor.mesh, camera.width, camera.height),
        visibility(device, actor.mesh),
        zero(device, std::vector<float>(3 * size_t(actor.n_vertices()), 0.0f)),
        skinned(device, zero.size()),
        normals(device, zero.size()),
        frame(device, camera.width, camera.height) {
    // Centred, 80 % of the picture high.
    truth.root_translation_mm = {0, 0, camera.fy * 1750 / (0.8 * camera.height)};
    draw(truth);
    const ImageGray mask = raster.read_mask();
    silhouette = make_silhouette(mask);
    VideoReader video((folder / "video.mp4").string());
    Frame first;
    video.read(first);
    picture = first.image;
    frame.upload(silhouette, picture);
    frame.mask.write(mask.pixels);
    std::mt19937 rng(3);
    start = test::disturbed(truth, rng, 0.03, 10);
    detections = test::exact_detections(actor, camera, truth);
    draw(start);
    visibility.find_contour(raster);
    contour = visibility.read_contour();
    if (contour.size() > kContour) contour.resize(kContour);
  }

  void draw(const Pose& pose) {
    posed = forward_kinematics(actor.skeleton, pose);
    skinner.set_pose(bone_dual_quats(posed));
    skinner.skin(zero, skinned);
    skinner.normals(skinned, normals);
    raster.render(skinned, camera);
    visibility.find_visible(skinned, normals, raster);
    visibility.find_contour(raster);
  }

  Actor actor;
  Camera camera;
  Pose truth, start;
  PosedSkeleton posed;
  Skinner skinner;
  DepthRasterizer raster;
  SurfaceVisibility visibility;
  ocl::Buffer<float> zero, skinned, normals;
  DeviceFrame frame;
  Silhouette silhouette;
  ImageRgb picture;
  Detections detections;
  std::vector<int32_t> contour;
};

// Depth and triangle of every pixel: bounding boxes, edge functions, as one writes it down.
struct PlainRaster {
  std::vector<float> depth, projected;
  std::vector<int32_t> ids;

  void render(const Mesh& mesh, const std::vector<float>& positions, const Camera& camera) {
    depth.assign(size_t(camera.width) * camera.height, std::numeric_limits<float>::infinity());
    ids.assign(depth.size(), -1);
    projected.resize(positions.size());
    for (size_t i = 0; i < positions.size(); i += 3) {
      const float inv_z = 1 / positions[i + 2];
      projected[i] = float(camera.fx) * positions[i] * inv_z + float(camera.cx);
      projected[i + 1] = float(camera.fy) * positions[i + 1] * inv_z + float(camera.cy);
      projected[i + 2] = inv_z;
    }
    for (int t = 0; t < mesh.n_triangles(); ++t) {
      const float* a = &projected[3 * size_t(mesh.triangles[3 * t])];
      const float* b = &projected[3 * size_t(mesh.triangles[3 * t + 1])];
      const float* c = &projected[3 * size_t(mesh.triangles[3 * t + 2])];
      const float area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
      if (!(area < 0)) continue;
      const int x0 = std::max(int(std::ceil(std::min({a[0], b[0], c[0]}))), 0);
      const int x1 = std::min(int(std::max({a[0], b[0], c[0]})), camera.width - 1);
      const int y0 = std::max(int(std::ceil(std::min({a[1], b[1], c[1]}))), 0);
      const int y1 = std::min(int(std::max({a[1], b[1], c[1]})), camera.height - 1);
      for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
          const float wa = (c[0] - b[0]) * (y - b[1]) - (c[1] - b[1]) * (x - b[0]);
          const float wb = (a[0] - c[0]) * (y - c[1]) - (a[1] - c[1]) * (x - c[0]);
          const float wc = (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
          if (wa > 0 || wb > 0 || wc > 0) continue;
          const float z = area / (wa * a[2] + wb * b[2] + wc * c[2]);
          float& nearest = depth[size_t(y) * camera.width + x];
          if (!(z < nearest)) continue;
          nearest = z;
          ids[size_t(y) * camera.width + x] = t;
        }
      }
    }
  }
};

// 3x3 blocks at every vertex and edge: 21 entries a row, as stage II's J^T J.
Eigen::SparseMatrix<float, Eigen::RowMajor> block_system(const Mesh& mesh) {
  std::vector<Eigen::Triplet<float>> entries;
  const auto block = [&](int a, int b, const Eigen::Matrix3f& m) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) entries.emplace_back(3 * a + i, 3 * b + j, m(i, j));
  };
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int a = mesh.triangles[t], b = mesh.triangles[t % 3 == 2 ? t - 2 : t + 1];
    const Eigen::Vector3f e = (Eigen::Map<const Eigen::Vector3f>(&mesh.positions[3 * size_t(a)]) -
                               Eigen::Map<const Eigen::Vector3f>(&mesh.positions[3 * size_t(b)]))
                                  .normalized();
    const Eigen::Matrix3f m = 0.5f * Eigen::Matrix3f::Identity() + 2.0f * e * e.transpose();
    block(a, a, m);
    block(b, b, m);
    block(a, b, -m);
    block(b, a, -m);
  }
  for (int i = 0; i < mesh.n_vertices(); ++i) block(i, i, Eigen::Matrix3f::Identity());
  Eigen::SparseMatrix<float, Eigen::RowMajor> matrix(3 * mesh.n_vertices(), 3 * mesh.n_vertices());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

using EigenCg = Eigen::ConjugateGradient<Eigen::SparseMatrix<float, Eigen::RowMajor>, Eigen::Lower | Eigen::Upper>;

void add_images(ocl::DeviceContext& device, std::shared_ptr<Scene> scene, const std::filesystem::path& folder) {
  auto plain = std::make_shared<PlainRaster>();
  auto positions = std::make_shared<std::vector<float>>(scene->skinned.read_all());
  plain->render(scene->actor.mesh, *positions, scene->camera);
  scene->raster.render(scene->skinned, scene->camera);
  const std::vector<int32_t> ids = scene->raster.triangle_ids().read_all();
  size_t differ = 0, drawn = 0;
  for (size_t i = 0; i < ids.size(); ++i) {
    drawn += ids[i] >= 0;
    differ += (ids[i] >= 0) != (plain->ids[i] >= 0);
  }
  if (!(drawn > 10000 && differ < drawn / 100))
    throw std::runtime_error(format("rasters differ in %zu of %zu pixels", differ, drawn));
  bench::register_contest({"depth raster",
                           [scene, &device] {
                             scene->raster.render(scene->skinned, scene->camera);
                             device.finish();
                           },
                           "plain C++", [=] { plain->render(scene->actor.mesh, *positions, scene->camera); }});

  const cv::Mat mask(scene->camera.height, scene->camera.width, CV_8U);
  const std::vector<uint8_t> bytes = scene->frame.mask.read_all();
  std::copy(bytes.begin(), bytes.end(), mask.data);
  auto field = std::make_shared<DeviceDistanceField>(device, scene->camera.width, scene->camera.height);
  bench::register_contest({"distance field",
                           [=, &device] {
                             field->compute(scene->frame.mask, scene->silhouette.box, scene->silhouette.area_px,
                                            scene->frame.signed_distance);
                             device.finish();
                           },
                           "OpenCV distanceTransform, exact, both sides",
                           [mask] {
                             cv::Mat inside, outside;
                             cv::distanceTransform(mask, inside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
                             cv::distanceTransform(255 - mask, outside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
                           }});

  const ImageRgb plate = read_image_rgb(folder / "background.png");
  BackgroundModel model;
  model.train(plate);
  auto segmenter = std::make_shared<ForegroundSegmenter>(device, model, scene->camera.width, scene->camera.height);
  auto found = std::make_shared<ImageGray>();
  auto frame = std::make_shared<DeviceFrame>(device, scene->camera.width, scene->camera.height);
  auto mog = cv::createBackgroundSubtractorMOG2();
  const auto as_mat = [](const ImageRgb& image) {
    return cv::Mat(image.height, image.width, CV_8UC3, const_cast<uint8_t*>(image.pixels.data())).clone();
  };
  cv::Mat foreground;
  for (int i = 0; i < 20; ++i) mog->apply(as_mat(plate), foreground);
  const cv::Mat picture = as_mat(scene->picture);
  bench::register_contest({"mask from the background: comparison, shadows, light, smoothing, pieces",
                           [=] { segmenter->segment(scene->picture, PersonMask{}, *frame, *found); },
                           "OpenCV MOG2, frozen",
                           [=] {
                             cv::Mat out;
                             mog->apply(picture, out, 0);
                           }});
}

void add_pose(ocl::DeviceContext& device, std::shared_ptr<Scene> scene) {
  PoseOptions options;
  options.steps = kSteps;
  auto solver = std::make_shared<PoseSolver>(device, scene->actor, scene->camera, options);
  auto host = std::make_shared<bench::EigenPose>(scene->actor, scene->camera, options);
  const auto ours = [=] {
    return solver->solve({.detections = scene->detections,
                          .initial = scene->start,
                          .previous = &scene->truth,
                          .frame = &scene->frame,
                          .contour_vertices = scene->contour});
  };
  const auto peer = [=] {
    return host->solve({.detections = scene->detections,
                        .initial = scene->start,
                        .previous = &scene->truth,
                        .contour_vertices = scene->contour},
                       scene->silhouette.signed_distance);
  };
  const PoseResult result = ours();
  const bench::EigenPose::Result expected = peer();
  const double apart_mm = test::keypoint_distance_mm(scene->actor, result.pose, expected.state.pose);
  const double energy = result.energy.total();
  std::printf("pose: keypoints at most %.2g mm from the peer's, energy %.7g and %.7g\n", apart_mm, energy,
              expected.energy);
  if (!(apart_mm < test::kPeerPoseMm && std::abs(energy - expected.energy) < test::kPeerPoseEnergy * energy))
    throw std::runtime_error(
        format("poses differ by %g mm, energies are %g and %g", apart_mm, energy, expected.energy));
  bench::register_contest({format("pose, %d Gauss-Newton steps, %zu contour vertices", kSteps, scene->contour.size()),
                           ours, "Eigen on the host, the same", peer});
}

void add_surface(ocl::DeviceContext& device, std::shared_ptr<Scene> scene) {
  auto surface = std::make_shared<SurfaceSystem>(device, scene->actor, scene->camera, SurfaceOptions{});
  scene->draw(scene->start);
  auto input = std::make_shared<SurfaceInput>(SurfaceInput{.frame = scene->frame,
                                                           .skinned = scene->skinned,
                                                           .start = scene->skinned,
                                                           .previous = &scene->skinned,
                                                           .before_previous = &scene->skinned,
                                                           .visible = scene->visibility.visible(),
                                                           .contour_flag = scene->visibility.contour(),
                                                           .normals = scene->normals});
  auto matrix = std::make_shared<Eigen::SparseMatrix<float, Eigen::RowMajor>>(block_system(scene->actor.mesh));
  const Eigen::VectorXf right = Eigen::VectorXf::LinSpaced(matrix->rows(), -1, 1);
  const auto eigen = [=](int iterations) {
    EigenCg cg(*matrix);
    cg.setTolerance(0);
    cg.setMaxIterations(iterations);
    const Eigen::VectorXf solution = cg.solve(right);
    benchmark::DoNotOptimize(solution.data());
  };
  bench::register_contest({format("surface, 3 x %d iterations with linearisation", kPcg),
                           [=] {
                             surface->begin(*input);
                             for (int kernel : {15, 9, 3}) {
                               surface->linearize(*input, kernel);
                               surface->iterate_pcg(kPcg);
                               surface->move();
                             }
                             surface->status();
                           },
                           "Eigen CG, assembled, without linearisation",
                           [=] {
                             for (int i = 0; i < 3; ++i) eigen(kPcg);
                           }});
  constexpr int kMany = 100;
  bench::register_contest({"one PCG iteration",
                           [=, &device] {
                             surface->iterate_pcg(kMany);
                             device.finish();
                           },
                           "Eigen CG", [=] { eigen(kMany); }, kMany});
}

int run(int argc, char** argv) {
  const std::string selector = bench::take_option(argc, argv, "device", "pocl");
  const std::filesystem::path folder = bench::take_option(argc, argv, "sequence", "");
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  if (folder.empty()) throw std::runtime_error("--sequence=FOLDER of `livecap synth` is missing");
  cv::setNumThreads(1);
  ocl::DeviceContext device(ocl::select_device(selector));
  const auto scene = std::make_shared<Scene>(device, folder);
  std::printf("%s, %d vertices, %dx%d\n", device.info().device_name.c_str(), scene->actor.n_vertices(),
              scene->camera.width, scene->camera.height);
  add_images(device, scene, folder);
  add_pose(device, scene);
  add_surface(device, scene);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace
}  // namespace livecap

int main(int argc, char** argv) {
  try {
    return livecap::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_stages: %s\n", error.what());
    return 1;
  }
}
