// Known-answer tests of stage II's kernels: answers worked out by hand on three vertices and flat images.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "geometry/pinhole_arg.h"
#include "match/layout.h"
#include "ocl/lanes.h"
#include "surface/programs.h"
#include "surface/sell.h"
#include "surface/surface_solver.h"

namespace livecap {
namespace {

constexpr double kTolerance = 1e-4;  // relative to the largest answer; the answers are short float sums

using Floats = std::vector<float>;

class Bench {
 public:
  explicit Bench(ocl::DeviceContext& device) : device_(device) {
    Mesh triangle;
    triangle.positions = {0, 0, 1000, 100, 0, 1000, 0, 100, 1000};
    triangle.triangles = {0, 1, 2};
    graph_ = make_sell_graph(triangle);
    rows_ = graph_.n_rows;
    stride_ = graph_.stride;
    const bool cpu = device.is_cpu();
    lane_items_ = ocl::lane_items(rows_, device.lanes());
    sum_items_ = cpu ? 1 : std::min<size_t>(256, device.info().max_work_group_size);
    vertices_ = triangle.positions;
  }

  std::vector<ocl::SelfTestResult> run() {
    packing();
    colors();
    silhouette();
    match();
    system();
    scalars();
    vectors();
    iterations();
    snapping();
    return results_;
  }

 private:
  ocl::Kernel kernel(const char* file, const char* name) { return {device_, file, name}; }
  // Planes of one constant each.
  Floats constant(const Floats& values) const {
    Floats out(values.size() * stride_, 0.0f);
    for (size_t a = 0; a < values.size(); ++a) std::fill_n(out.begin() + a * stride_, rows_, values[a]);
    return out;
  }
  // [width] values of one mesh vertex.
  Floats at(const ocl::Buffer<float>& planes, int vertex, int width) const {
    const Floats values = planes.read_all();
    Floats out;
    for (int a = 0; a < width; ++a) out.push_back(values[size_t(a) * stride_ + graph_.row[vertex]]);
    return out;
  }
  void expect(const std::string& name, const Floats& found, const Floats& expected) {
    double largest = 1, worst = 0;
    bool ok = found.size() == expected.size();
    for (size_t k = 0; ok && k < found.size(); ++k) {
      largest = std::max(largest, std::abs(double(expected[k])));
      worst = std::max(worst, std::abs(double(found[k]) - expected[k]));
      ok = std::isfinite(found[k]);
    }
    ok = ok && worst <= kTolerance * largest;
    std::string detail;
    if (!ok) {
      detail = "expected";
      for (const float x : expected) detail.append(" ").append(std::to_string(x));
      detail += ", found";
      for (const float x : found) detail.append(" ").append(std::to_string(x));
    }
    results_.push_back({"surface/" + name, ok, detail});
  }

  void packing() {
    const ocl::Buffer<float> packed(device_, vertices_);
    const ocl::Buffer<int32_t> order(device_, graph_.order);
    ocl::Buffer<float> planes(device_, constant({7, 7, 7}));
    ocl::Buffer<float> also(device_, constant(Floats(3, -1))), third(device_, constant(Floats(3, -1))),
        none(device_, 1);
    kernel(kSurfaceProgram, "pack_planes")
        .launch(ocl::Range{(size_t(rows_) + 63) / 64 * 64, 3, 64, 1}, graph_.n, rows_, stride_, order, packed, packed,
                packed, packed, planes, also, third, none);
    Floats found = at(planes, 1, 3);
    for (const ocl::Buffer<float>* filled : {&also, &third})
      for (const float x : at(*filled, 1, 3)) found.push_back(x);
    expect("pack_planes", found, {100, 0, 1000, 100, 0, 1000, 100, 0, 1000});
    ocl::Buffer<float> out(device_, 9);
    ocl::Kernel unpack = kernel(kSurfaceProgram, "unpack_planes");
    const ocl::Buffer<float> start(device_, Floats(9, 5.0f));
    unpack.launch(graph_.n, 64, graph_.n, stride_, order, ocl::Buffer<float>(device_, Floats(4, 0.0f)), planes, start,
                  out);
    expect("unpack_planes", out.read_all(), vertices_);
    unpack.launch(graph_.n, 64, graph_.n, stride_, order, ocl::Buffer<float>(device_, Floats{0, 0, 0, 1}), planes,
                  start, out);
    expect("unpack_planes (failed)", out.read_all(), Floats(9, 5.0f));
  }

  void colors() {
    // Red rises by 4 of 255 per column, green is flat, blue falls by 2 per row; kernel 9. A tap more than the 8 columns
    // of half the picture away from the border sees no clamping.
    std::vector<uint8_t> image;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) image.insert(image.end(), {uint8_t(4 * x), 51, uint8_t(200 - 2 * y)});
    const ocl::Buffer<uint8_t> rgb(device_, image);
    const float inv_sigma2 = 1.0f / (1.7f * 1.7f);
    ocl::Buffer<float> out(device_, 9);
    kernel(kSurfaceProgram, "sample_colors")
        .launch(1, 1, 1, kWidth, kHeight, 4, inv_sigma2, rgb, ocl::Buffer<float>(device_, Floats{16, 16}), out);
    const Floats sample = out.read_all();
    expect("sample_colors", {sample[0], sample[1], sample[2], sample[4], sample[6], sample[7]},
           {64 / 255.0f, 0.2f, 168 / 255.0f, 0, 0, 0});

    // All three vertices seen; green alone differs from the template by 0.1 and has no gradient.
    const float inv = 1 / 255.0f;
    ocl::Buffer<float> blocks(device_, constant(Floats(6, 7))), rhs(device_, constant({7, 7, 7})),
        energy(device_, constant({7}));
    kernel(kSurfaceProgram, "photo_system")
        .launch(rows_, device_.is_cpu() ? 1 : 64, graph_.n, rows_, stride_, kWidth, kHeight, 4, inv_sigma2, 100.0f,
                0.5f, PinholeArg{100, 100, 16, 16}, ocl::Buffer<int32_t>(device_, graph_.order),
                ocl::Buffer<int32_t>(device_, std::vector<int32_t>{1, 0, 0}), rgb,
                ocl::Buffer<float>(device_, constant({64 * inv, 0.1f, 168 * inv})),
                ocl::Buffer<float>(device_, graph_.planes(vertices_, 3)), blocks, rhs, energy);
    // At an integer position |du| of the ramp equals sum d^2 w / (sigma^2 sum w) times its slope.
    const Floats block = at(blocks, 0, 6);
    const float xx = 100 * sample[3] * sample[3] * 0.01f, yy = 100 * sample[8] * sample[8] * 0.01f;
    expect("photo_system",
           {at(energy, 0, 1)[0], at(energy, 1, 1)[0], 1e4f * block[0], 1e4f * block[3], at(rhs, 0, 1)[0]},
           {1.0f, 0, 1e4f * xx, 1e4f * yy, 0});
  }

  // Its right-hand side, its energy and that of vertex 0, and the first entry of its block.
  Floats added_to_vertex_1(const ocl::Buffer<float>& blocks, const ocl::Buffer<float>& rhs,
                           const ocl::Buffer<float>& energy) const {
    Floats found = at(rhs, 1, 3);
    found.push_back(at(energy, 1, 1)[0]);
    found.push_back(at(energy, 0, 1)[0]);
    found.push_back(at(blocks, 1, 1)[0]);
    return found;
  }

  void silhouette() {
    ocl::Buffer<float> blocks(device_, constant(Floats(6, 0))), rhs(device_, constant({0, 0, 0})),
        energy(device_, constant({7}));
    // d = x - 19: vertex 1 projects to x = 26 (100 px focal at 1 m, 100 mm), 7 px outside.
    Floats distance;
    for (int k = 0; k < kWidth * kHeight; ++k) distance.push_back(float(k % kWidth) - 19);
    kernel(kSurfaceProgram, "silhouette_system")
        .launch(rows_, 64, graph_.n, rows_, stride_, kWidth, kHeight, 10.0f, 0, PinholeArg{100, 100, 16, 16},
                ocl::Buffer<int32_t>(device_, graph_.order),
                ocl::Buffer<int32_t>(device_, std::vector<int32_t>{0, 1, 0}),
                ocl::Buffer<float>(device_, Floats{1, 0, 0, 1, 0, 0, 1, 0, 0}), ocl::Buffer<float>(device_, distance),
                ocl::Buffer<uint8_t>(device_, 1), ocl::Buffer<int32_t>(device_, 3),
                ocl::Buffer<float>(device_, graph_.planes(vertices_, 3)), blocks, rhs, energy);
    // J = (0.1, 0, -0.01) px per mm; rhs = -10 * 7 * J.
    expect("silhouette_system", added_to_vertex_1(blocks, rhs, energy), {-7, 0, 0.7f, 490, 0, 0.1f});
  }

  void match() {
    ocl::Buffer<float> blocks(device_, constant(Floats(6, 0))), rhs(device_, constant({0, 0, 0})),
        energy(device_, constant({7}));
    // Vertex 1 is found 3 px left of where it is, by patches with a correlation of 0.5.
    Floats matches(LC_MATCH * 3, 0);
    for (const auto& [k, value] : {std::pair{0, 23.0f},
                                   {1, 16.0f},
                                   {2, 1.0f},
                                   {4, 1.0f},
                                   {LC_MATCH_WEIGHT_PX, 1.0f},
                                   {LC_MATCH_CORRELATION, 0.5f}})
      matches[LC_MATCH + k] = value;
    kernel(kSurfaceProgram, "match_system")
        .launch(rows_, 64, graph_.n, rows_, stride_, 10.0f, PinholeArg{100, 100, 16, 16},
                ocl::Buffer<int32_t>(device_, graph_.order), ocl::Buffer<float>(device_, matches),
                ocl::Buffer<float>(device_, graph_.planes(vertices_, 3)), blocks, rhs, energy);
    // J = (0.1, 0, -0.01) px per mm; rhs = -10 * 0.5 * 3 * J.
    expect("match_system", added_to_vertex_1(blocks, rhs, energy), {-1.5f, 0, 0.15f, 45, 0, 0.05f});
  }

  // Triangle with right angle at vertex 0, s = 2 so c = 2 for each edge; edges 0-1 and 0-2 are 1 mm longer than what
  // is a quarter and three quarters of the way from their skinned length (sqrt(10001)) to that at rest; V^S of vertex 0
  // is 1 mm nearer and held there with a weight of 8; everything moved by 2 mm on each axis since the last frame.
  void system() {
    Floats skinned = vertices_, previous = vertices_;
    skinned[2] -= 1;
    for (float& x : previous) x -= 2;
    const auto planes = [&](const Floats& v) { return ocl::Buffer<float>(device_, graph_.planes(v, 3)); };
    const auto zero = [&](int count) { return ocl::Buffer<float>(device_, constant(Floats(count, 0))); };
    const ocl::Buffer<int32_t> offsets(device_, graph_.slice_offsets), neighbors(device_, graph_.neighbors);
    const ocl::Buffer<float> weights(device_, graph_.per_entry([](int, int) { return 2.0; }));
    const auto share = [](int i, int j) { return i == 1 || j == 1 ? 0.25 : 0.75; };
    const ocl::Buffer<float> shares(device_, graph_.per_entry(share));
    const ocl::Buffer<float> lengths(device_, graph_.per_entry([&](int i, int j) {
      const double skinned = std::sqrt(10001.0);
      return i && j ? std::sqrt(20000.0) : skinned + (99.0 - skinned) / share(i, j);
    }));
    const ocl::Buffer<float> depth_weights(device_, graph_.planes(Floats(3, 8.0f), 1));
    const ocl::Buffer<float> velocity_weights(device_, graph_.planes(Floats(3, 0.25f), 1));
    ocl::Buffer<float> blocks = zero(6), rhs = zero(3), inverse = zero(6), z = zero(3), p = zero(7), step = zero(3);
    ocl::Buffer<float> products = zero(1), energies = zero(5), edges(device_, 3 * size_t(graph_.n_entries));
    kernel(kSurfaceSlicesProgram, "regularizer_system")
        .launch(lane_items_, lane_local(), rows_, stride_, 10.0f, 30.0f, 1.0f, 0.0f, 0.5f, offsets, neighbors, weights,
                lengths, shares, depth_weights, velocity_weights, planes(vertices_), planes(skinned), planes(previous),
                planes(previous), blocks, rhs, edges, inverse, z, p, step, products, energies);
    Floats found = at(rhs, 0, 3);
    for (const float x : at(blocks, 0, 6)) found.push_back(x);
    // Energies at vertex 0: half of 2 edges * 20 * 1, half of 2 * 60 * 1, 0.25 * 12, none, 8 * 1.
    for (const float x : at(energies, 0, 5)) found.push_back(x);
    expect("regularizer_system", found, {59.5f, 59.5f, -48.5f, 100.75f, 0, 0, 100.75f, 0, 48.75f, 20, 60, 3, 0, 8});

    Floats direction(9, 0.0f);
    direction[3] = 1;  // x of vertex 1
    direction[2] = 1;  // z of vertex 0
    ocl::Buffer<float> image = zero(3);
    if (device_.is_cpu()) {
      p.fill(0.0f);
      kernel(kSurfaceSlicesProgram, "turn_direction")
          .launch(lane_items_, lane_local(), rows_, stride_, zero(1), planes(direction), p);
      kernel(kSurfaceSlicesProgram, "apply_system")
          .launch(lane_items_, lane_local(), rows_, stride_, 10.0f, offsets, neighbors, weights, edges, blocks, p,
                  image, products);
    } else {
      ocl::Buffer<float> z_in = planes(direction), both = zero(6), scalars = zero(1), parts = zero(2);
      ocl::GroupsTogether one(device_, 1);
      kernel(kSurfaceSlicesProgram, "pcg_phases")
          .launch(256, 256, 0, 1, one.arrived(), 0, rows_, stride_, 10.0f, offsets, neighbors, weights, edges, blocks,
                  inverse, products, both, image, step, rhs, z_in, parts, scalars, one.state());
    }
    found = at(image, 0, 3);
    for (const float x : at(image, 2, 3)) found.push_back(x);
    // Edge 1-2 lies along (1, -1, 0)/sqrt 2: row 2 gets -20 - 60/2 along x and +60/2 along y from it.
    expect("apply_system", found, {-80, 0, 48.75f, -50, 30, -20});
  }

  void scalars() {
    constexpr int kCount = 160;  // more than a pass of the unrolled sum, not a multiple of it
    Floats values(kCount);
    for (int k = 0; k < kCount; ++k) values[k] = float(k % 5);
    const ocl::Buffer<float> products(device_, values);  // sum 320
    ocl::Buffer<float> scalars(device_, Floats{9, 9, 9, 1});
    ocl::Buffer<float> totals(device_, 8);
    totals.fill(0.0f);
    Floats energies;
    for (int k = 0; k < 5 * 80; ++k) energies.push_back(float(k % 5 * (1 + k / 80)));
    kernel(kSurfaceSlicesProgram, "sum_energies")
        .launch(8 * sum_items_, sum_items_, 80, 80, products, ocl::Buffer<float>(device_, Floats(80, 1)),
                ocl::Buffer<float>(device_, Floats(80, 3)), ocl::Buffer<float>(device_, energies), totals);
    expect("sum_energies", totals.read_all(), {160, 80, 240, 160, 320, 480, 640, 800});
    if (!device_.is_cpu()) return;
    kernel(kSurfaceSlicesProgram, "start_scalars").launch(sum_items_, sum_items_, kCount, 1, products, scalars);
    expect("start_scalars", scalars.read_all(), {320, 0, 0, 0});
    scalars.write(Floats{80, 0, 0, 0});
    kernel(kSurfaceSlicesProgram, "alpha_scalar").launch(sum_items_, sum_items_, kCount, products, scalars);
    expect("alpha_scalar", scalars.read_all(), {80, 0.25f, 0, 0});
    kernel(kSurfaceSlicesProgram, "beta_scalar").launch(sum_items_, sum_items_, kCount, products, scalars);
    expect("beta_scalar", scalars.read_all(), {320, 0.25f, 4, 0});
  }

  void vectors() {
    const auto planes = [&](const Floats& values) { return ocl::Buffer<float>(device_, constant(values)); };
    const ocl::Buffer<float> scalars(device_, Floats{0, 2, 3, 0});
    ocl::Buffer<float> step = planes({0, 1, 0}), r = planes({3, 3, 3}), z = planes({0, 0, 0}), products = planes({0});
    ocl::Buffer<float> p = planes({1, 2, 3, 0, 0, 0, 0});
    const ocl::Buffer<float> inverse = planes({0.5f, 0, 0, 0.5f, 0, 0.5f});
    ocl::Buffer<float> q = planes({1, 1, 1});
    // On GPUs: phase 1, whose alpha is 6 / 3, and phase 2, whose beta is 18 / 6. The sum of r.z is of n_rows times 1.5.
    ocl::Buffer<float> parts(device_, Floats{6, 3, 18, 0, 0}), failed(device_, Floats{0, 0, 0, 0});
    ocl::GroupsTogether one(device_, 1);
    const ocl::Buffer<int32_t> offsets(device_, std::vector<int32_t>(graph_.slice_offsets.size(), 0));  // no links
    const auto phase = [&](int first) {
      kernel(kSurfaceSlicesProgram, "pcg_phases")
          .launch(256, 256, first, first + 1, one.arrived(), 0, rows_, stride_, 0.0f, offsets, offsets, inverse,
                  inverse, inverse, inverse, products, p, q, step, r, z, parts, failed, one.state());
    };
    if (device_.is_cpu()) {
      kernel(kSurfaceSlicesProgram, "advance")
          .launch(lane_items_, lane_local(), rows_, stride_, scalars, inverse, p, q, step, r, z, products);
    } else {
      phase(1);
      products.fill(parts.read_all()[2] / float(rows_));
      parts.write(Floats{18}, 2);
    }
    Floats found = at(step, 0, 3);
    for (const float x : at(z, 1, 3)) found.push_back(x);
    found.push_back(at(products, 2, 1)[0]);
    expect("advance", found, {2, 5, 6, 0.5f, 0.5f, 0.5f, 1.5f});
    if (device_.is_cpu()) {
      kernel(kSurfaceSlicesProgram, "turn_direction").launch(lane_items_, lane_local(), rows_, stride_, scalars, z, p);
    } else {
      phase(2);
    }
    found = at(p, 0, 6);
    if (!device_.is_cpu()) found.erase(found.begin(), found.begin() + 3);  // those of the iteration before
    found.resize(3);
    expect("turn_direction", found, {3.5f, 6.5f, 9.5f});
    ocl::Buffer<float> v = planes({10, 20, 30});
    kernel(kSurfaceSlicesProgram, "move_vertices")
        .launch(lane_items_, lane_local(), rows_, stride_, 2.5f, planes({3, 4, 0}), v);
    expect("move_vertices", at(v, 2, 3), {11.5f, 22, 30});
  }

  // A = diag(1, 1, 3) and b = (1, 2, 3) at every vertex, not preconditioned: two eigenvalues are two iterations.
  void iterations() {
    if (!device_.is_cpu()) return;
    const auto planes = [&](const Floats& values) { return ocl::Buffer<float>(device_, constant(values)); };
    const ocl::Buffer<int32_t> no_links(device_, std::vector<int32_t>(graph_.slice_offsets.size(), 0));
    const ocl::Buffer<float> blocks = planes({1, 0, 0, 1, 0, 3}), inverse = planes({1, 0, 0, 1, 0, 1});
    ocl::Buffer<float> p = planes({1, 2, 3, 0, 0, 0, 0}), q = planes({7, 7, 7}), step = planes({0, 0, 0}),
                       r = planes({1, 2, 3}), z = planes({1, 2, 3}), products = planes({7}),
                       scalars(device_, Floats{14.0f * float(rows_), 0, 0, 0});
    kernel(kSurfaceSlicesProgram, "all_iterations")
        .launch(1, 1, 2, rows_, stride_, 0.0f, no_links, no_links, blocks, blocks, blocks, inverse, p, q, step, r, z,
                products, scalars);
    Floats found = at(step, 1, 3);
    for (const float x : at(r, 2, 3)) found.push_back(x);
    found.push_back(scalars.read_all()[3]);
    expect("all_iterations", found, {1, 2, 1, 0, 0, 0, 0});
  }

  void snapping() {
    // d = x - 24: vertex 1 stands at 26, so it moves by -2 px = -20 mm; vertex 2 is rigid, vertex 0 follows.
    Floats distance;
    for (int k = 0; k < kWidth * kHeight; ++k) distance.push_back(float(k % kWidth) - 24);
    const ocl::Buffer<int32_t> order(device_, graph_.order);
    ocl::Buffer<float> moves(device_, constant({7, 7})), rings(device_, constant({7})), vertices(device_, vertices_);
    kernel(kSurfaceProgram, "snap_targets")
        .launch(rows_, 64, graph_.n, rows_, stride_, kWidth, kHeight, 3.0f, 15.0f, 0, PinholeArg{100, 100, 16, 16},
                order, ocl::Buffer<float>(device_, graph_.planes({2, 2, 50}, 1)),
                ocl::Buffer<int32_t>(device_, std::vector<int32_t>{0, 1, 1}),
                ocl::Buffer<float>(device_, Floats{1, 0, 0, 1, 0, 0, 1, 0, 0}), ocl::Buffer<float>(device_, distance),
                ocl::Buffer<uint8_t>(device_, 1), ocl::Buffer<int32_t>(device_, 3), vertices, moves, rings);
    expect("snap_targets",
           {at(moves, 1, 2)[0], at(moves, 1, 2)[1], at(rings, 0, 1)[0], at(rings, 1, 1)[0], at(rings, 2, 1)[0]},
           {-20, 0, 1000, 0, 2000});
    const ocl::Buffer<int32_t> offsets(device_, graph_.slice_offsets), neighbors(device_, graph_.neighbors);
    ocl::Buffer<float> spread_moves(device_, constant({7, 7})), spread_rings(device_, constant({7}));
    ocl::GroupsTogether one(device_, 1);
    const auto round = [&](int number, int n_rings) {
      kernel(kSurfaceSlicesProgram, "snap_rounds")
          .launch(lane_items_, lane_local(), number, number + 1, one.arrived(), rows_, stride_, n_rings, offsets,
                  neighbors, rings, spread_rings, moves, spread_moves, one.state());
    };
    if (device_.is_cpu()) {
      kernel(kSurfaceSlicesProgram, "snap_spread")
          .launch(lane_items_, lane_local(), rows_, stride_, 1.0f, 0.75f, offsets, neighbors, rings, moves,
                  spread_rings, spread_moves);
    } else {
      round(0, 3);
    }
    expect("snap_spread",
           {at(spread_moves, 0, 2)[0], at(spread_rings, 0, 1)[0], at(spread_moves, 2, 2)[0], at(spread_rings, 2, 1)[0]},
           {-15, 1, 0, 2000});
    if (device_.is_cpu()) {
      kernel(kSurfaceSlicesProgram, "snap_relax")
          .launch(lane_items_, lane_local(), rows_, stride_, 1.0f, offsets, neighbors, spread_rings, spread_moves,
                  moves);
    } else {
      round(1, 1);
    }
    expect("snap_relax", {at(moves, 0, 2)[0], at(moves, 1, 2)[0], at(moves, 2, 2)[0]}, {-10, -20, 0});
    kernel(kSurfaceProgram, "snap_apply")
        .launch(graph_.n, 64, graph_.n, stride_, 1.0f, order, spread_rings, moves, vertices);
    expect("snap_apply", vertices.read_all(), {-10, 0, 1000, 80, 0, 1000, 0, 100, 1000});
  }

  size_t lane_local() const { return device_.is_cpu() ? 1 : 64; }

  static constexpr int kWidth = 32, kHeight = 32;
  ocl::DeviceContext& device_;
  SellGraph graph_;
  int rows_ = 0, stride_ = 0;
  size_t lane_items_ = 0, sum_items_ = 0;
  Floats vertices_;
  std::vector<ocl::SelfTestResult> results_;
};

}  // namespace

std::vector<ocl::SelfTestResult> surface_self_test(ocl::DeviceContext& device) {
  return Bench(device).run();
}

}  // namespace livecap
