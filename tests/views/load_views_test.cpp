#include "views/load_views.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"
#include "support/tolerances.h"
#include "views/picture_orientation.h"

namespace livecap {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kWidth = 96, kHeight = 64;

class LoadViews : public ::testing::Test {
 protected:
  LoadViews() : folder_(std::filesystem::temp_directory_path() / ("livecap_load_views_" + std::to_string(::getpid()))) {
    for (const char* name : {"images/a", "images/b", "masks/a", "masks/b", "flat"})
      std::filesystem::create_directories(folder_ / name);
  }
  ~LoadViews() override { std::filesystem::remove_all(folder_); }

  static ImageRgb dotted(int x, int y) {
    ImageRgb image{kWidth, kHeight, std::vector<uint8_t>(size_t(3) * kWidth * kHeight, 40)};
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx)
        for (int k = 0; k < 3; ++k) image.pixels[3 * (size_t(y + dy) * kWidth + x + dx) + k] = 240;
    return image;
  }

  static ImageGray plain(uint8_t value, int width = kWidth, int height = kHeight) {
    return {width, height, std::vector<uint8_t>(size_t(width) * height, value)};
  }

  // Of what is bright.
  static Vector2d middle_of(const ImageGray& image) {
    Vector2d sum = Vector2d::Zero();
    double weight = 0;
    for (int v = 0; v < image.height; ++v)
      for (int u = 0; u < image.width; ++u)
        if (const int value = image.pixels[size_t(v) * image.width + u]; value > 100)
          sum += value * Vector2d(u, v), weight += value;
    return sum / weight;
  }

  // A COLMAP model of these pictures, all from the same place.
  void write_model(const std::vector<std::string>& names) {
    std::ofstream cameras(folder_ / "cameras.txt"), images(folder_ / "images.txt");
    cameras << "1 OPENCV 96 64 90 88 50 30 -0.1 0.02 0.01 -0.02\n";
    for (size_t i = 0; i < names.size(); ++i)
      images << i + 1 << " 0.96 0.02 -0.27 0.05 0.1 0.2 3 1 " << names[i] << "\n\n";
  }

  ViewFiles files() const {
    ViewFiles files;
    files.images = folder_ / "images";
    files.cameras = folder_;
    return files;
  }

  std::filesystem::path folder_;
};

TEST_F(LoadViews, PicturesOfTheSameNameHaveMasksOfTheirOwn) {
  std::vector<std::string> names;
  for (int i = 0; i < 4; ++i)
    for (const char* camera : {"a", "b"}) {
      names.push_back(std::string(camera) + format("/%d.png", i));
      write_png(dotted(40, 30), folder_ / "images" / names.back());
      write_png(plain(camera[0] == 'a' ? 200 : 160), folder_ / "masks" / names.back());
    }
  names.push_back("a/alone.png");
  write_png(dotted(40, 30), folder_ / "images" / names.back());
  write_png(plain(180), folder_ / "masks" / "alone.png");  // not in a folder of its own
  write_png(plain(10), folder_ / "flat" / "0.png");        // whose?
  write_model(names);
  ViewFiles given = files();
  given.masks = folder_ / "masks";
  std::vector<std::string> notes;
  std::vector<View> views = load_views(given, notes);
  ASSERT_EQ(views.size(), 9u);
  for (const View& view : views) {
    ASSERT_FALSE(view.mask.empty()) << view.name;
    EXPECT_TRUE(view.exact_mask);
    const int expected = view.name == "a/alone.png" ? 180 : view.name[0] == 'a' ? 200 : 160;
    EXPECT_EQ(view.mask.pixels[30 * kWidth + 40], expected) << view.name;
  }
  given.masks = folder_ / "flat";
  try {
    load_views(given, notes);
    ADD_FAILURE() << "a folder that has no picture's mask";
  } catch (const IoError& error) {
    EXPECT_EQ(error.what(), given.masks.string() + ": has a mask of none of the 9 pictures (expected <stem>.png)");
  }
  write_png(plain(180), folder_ / "flat" / "alone.png");
  views = load_views(given, notes);
  EXPECT_TRUE(std::all_of(views.begin(), views.end(), [](const View& view) {
    return view.mask.empty() == (view.name != "a/alone.png") && view.exact_mask == !view.mask.empty();
  }));
}

// As tools write them: cut out with alpha; 1 for the person; nothing at all.
TEST_F(LoadViews, MasksOfOtherConventionsAreReadOrRefused) {
  std::vector<std::string> names, notes;
  ImageGray half = plain(0);
  std::fill_n(half.pixels.begin() + half.pixels.size() / 2, half.pixels.size() / 2, uint8_t{255});
  for (int i = 0; i < 8; ++i) {
    names.push_back(format("a/%d.png", i));
    write_png(dotted(40, 30), folder_ / "images" / names.back());
    write_png(dotted(40, 30), half, folder_ / "masks" / names.back());
  }
  write_model(names);
  ViewFiles given = files();
  given.masks = folder_ / "masks";
  const View view = load_views(given, notes).front();
  EXPECT_EQ(view.mask.pixels[50 * kWidth + 40], 255);
  EXPECT_EQ(view.mask.pixels[10 * kWidth + 40], 0);
  const auto refusal = [&]() -> std::string {
    try {
      load_views(given, notes);
    } catch (const IoError& error) {
      return error.what();
    }
    return {};
  };
  write_png(plain(1), folder_ / "masks/a/5.png");
  EXPECT_EQ(refusal(), (folder_ / "masks/a/5.png").string() + ": its largest value is 1; in a mask 255 means person");
  for (const std::string& name : names) write_png(plain(0), folder_ / "masks" / name);
  EXPECT_EQ(refusal(), given.masks.string() + ": nobody is in any of the 8 masks; 255 means person");
  for (const std::string& name : names) write_png(plain(255), folder_ / "masks" / name);
  EXPECT_EQ(refusal(), given.masks.string() + ": the person fills all of the 8 masks; 255 means person, 0 background");
}

TEST_F(LoadViews, LabelImagesThatAreMissingAreTold) {
  std::vector<std::string> names;
  for (int i = 0; i < 8; ++i) {
    names.push_back(format("a/%d.png", i));
    write_png(dotted(40, 30), folder_ / "images" / names.back());
    if (i > 0) write_png(plain(5), folder_ / "masks" / names.back());
  }
  write_model(names);
  ViewFiles given = files();
  given.labels = folder_ / "masks";
  std::vector<std::string> notes;
  const std::vector<View> views = load_views(given, notes);
  EXPECT_EQ(std::count_if(views.begin(), views.end(), [](const View& view) { return view.labels.empty(); }), 1);
  EXPECT_EQ(notes, std::vector<std::string>{"1 of 8 pictures have no label image in " + given.labels.string() +
                                            " (expected <stem>.png)"});
  given.labels = folder_ / "flat";
  try {
    load_views(given, notes);
    ADD_FAILURE();
  } catch (const IoError& error) {
    EXPECT_EQ(error.what(),
              "none of the 8 pictures has a label image in " + given.labels.string() + " (expected <stem>.png)");
  }
}

// As human parsers write them: a picture of 96 x 64 with two bits a pixel, all 2, which is (0 128 0) in its palette.
TEST_F(LoadViews, LabelsOfAPaletteAreItsIndices) {
  const std::string hex =
      "89504e470d0a1a0a0000000d4948445200000060000000400203000000985a9a9d0000000c504c5445000000800000008000"
      "80800038ec04800000001b4944415478da63588503308c4a8c4a8c4a8c4a8c4a8c4ae0960000410cfc2e27b4f03800000000"
      "49454e44ae426082";
  std::string indexed;
  for (size_t i = 0; i < hex.size(); i += 2) indexed += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  std::vector<std::string> names, notes;
  for (int i = 0; i < 8; ++i) {
    names.push_back(format("a/%d.png", i));
    write_png(dotted(40, 30), folder_ / "images" / names.back());
    write_file_atomically(folder_ / "masks" / names.back(), indexed);
  }
  write_model(names);
  ViewFiles given = files();
  given.labels = folder_ / "masks";
  for (const View& view : load_views(given, notes)) EXPECT_EQ(view.labels.pixels[30 * kWidth + 40], 2);
}

TEST_F(LoadViews, TheCamerasThatAreFoundAreTold) {
  std::vector<std::string> names, notes;
  for (int i = 0; i < 8; ++i) {
    names.push_back(format("a/%d.png", i));
    write_png(dotted(40, 30), folder_ / "images" / names.back());
  }
  write_model(names);
  load_views(files(), notes);
  EXPECT_TRUE(notes.empty());
  ViewFiles given = files();
  given.cameras.clear();
  load_views(given, notes);
  EXPECT_EQ(notes, std::vector<std::string>{"cameras: of " + folder_.string() + " (--cameras says otherwise)"});
}

// One that nobody writes to: opened, it would wait for ever.
TEST_F(LoadViews, APipeIsNoPicture) {
  const std::filesystem::path pipe = folder_ / "images/a/pipe.png";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::vector<std::string> names = {"a/pipe.png"}, notes;
  for (int i = 0; i < 8; ++i) {
    names.push_back(format("a/%d.png", i));
    write_png(dotted(40, 30), folder_ / "images" / names.back());
  }
  write_model(names);
  EXPECT_EQ(load_views(files(), notes).size(), 8u);
  EXPECT_EQ(notes, std::vector<std::string>{pipe.string() + ": is a pipe or a device, expected a file; left out"});
}

// The dot in the stored picture is where the model's camera sees a point; it still is after the picture was turned.
TEST_F(LoadViews, PhonePicturesAreTurnedWithTheirCameras) {
  // The pixel of the dot and, by hand, a point on its viewing ray.
  write_model({"probe"});
  const ViewPose stored = read_view_poses(folder_).front();
  Vector2d ray(-0.2, 0.15);
  const auto& [k1, k2, p1, p2, k3] = stored.camera.distortion;
  const double r2 = ray.squaredNorm(), radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double xd = ray.x() * radial + 2 * p1 * ray.x() * ray.y() + p2 * (r2 + 2 * ray.x() * ray.x());
  const double yd = ray.y() * radial + p1 * (r2 + 2 * ray.y() * ray.y()) + 2 * p2 * ray.x() * ray.y();
  const int x = static_cast<int>(std::lround(stored.camera.fx * xd + stored.camera.cx)),
            y = static_cast<int>(std::lround(stored.camera.fy * yd + stored.camera.cy));
  const Vector3d point = stored.camera_from_world.inverse() * Vector3d(3 * ray.x(), 3 * ray.y(), 3);

  std::vector<std::string> names;
  const std::string plain_jpeg = encode_jpeg(dotted(x, y), 97);
  for (int i = 0; i < 12; ++i) {
    const char orientation[] = {1, 6, 3, 8};
    std::string exif("Exif\0\0MM\0*\0\0\0\10\0\1\1\22\0\3\0\0\0\1\0", 6 + 8 + 2 + 9);
    exif += orientation[i % 4];
    exif += std::string("\0\0\0\0\0\0", 6);
    if (i >= 4 && i < 8) {  // the other byte order
      exif = std::string("Exif\0\0II*\0\10\0\0\0\1\0\22\1\3\0\1\0\0\0", 6 + 8 + 2 + 8);
      exif += orientation[i % 4];
      exif += std::string("\0\0\0\0\0\0\0", 7);
    }
    const size_t size = exif.size() + 2;
    std::string jpeg = plain_jpeg.substr(0, 2) + "\xff\xe1" + static_cast<char>(size >> 8) +
                       static_cast<char>(size & 255) + exif + plain_jpeg.substr(2);
    names.push_back(format("%02d.jpg", i));
    write_file_atomically(folder_ / "images" / names.back(), jpeg);
    ImageGray mask = plain(0);
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx) mask.pixels[size_t(y + dy) * kWidth + x + dx] = 255;
    write_png(mask, folder_ / "masks" / format("%02d.png", i));
  }
  write_model(names);
  ViewFiles given = files();
  given.masks = folder_ / "masks";  // of the stored pictures
  std::vector<std::string> notes;
  const std::vector<View> views = load_views(given, notes);
  ASSERT_EQ(views.size(), 12u);
  for (size_t i = 0; i < views.size(); ++i) {
    const View& view = views[i];
    EXPECT_EQ(view.image.width, i % 2 ? kHeight : kWidth);
    EXPECT_EQ(view.mask.width, view.image.width);
    Vector2d seen = Vector2d::Zero(), pixel;
    double sum = 0;
    for (int v = 0; v < view.image.height; ++v)
      for (int u = 0; u < view.image.width; ++u) {
        const int value = view.image.pixels[3 * (size_t(v) * view.image.width + u)];
        if (value < 140) continue;
        seen += value * Vector2d(u, v), sum += value;
      }
    ASSERT_GT(sum, 0) << view.name;
    ASSERT_TRUE(view.project(point, pixel));
    EXPECT_LT((seen / sum - pixel).norm(), test::kDotPx) << view.name;
    EXPECT_LT((middle_of(view.mask) - pixel).norm(), test::kDotPx) << view.name;
  }
  EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [](const std::string& note) {
    return note.find("9 pictures are turned upright") != std::string::npos;
  }));
}

// Every ray falls on the same spot of the picture before and after both were turned, tangential distortion included.
TEST_F(LoadViews, TurnedCamerasSeeTurnedPictures) {
  ViewPose stored;
  stored.camera = {kWidth, kHeight, 90, 88, 50, 30, {-0.2, 0.1, 0.15, -0.08, 0.05}};
  stored.camera_from_world =
      Eigen::Translation3d(0.1, -0.2, 0.4) * Eigen::AngleAxisd(0.4, Vector3d(1, 2, 3).normalized());
  const auto pixel = [](const ViewPose& view, const Vector3d& world) {
    const Vector3d p = view.camera_from_world * world;
    const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
    const auto& [k1, k2, p1, p2, k3] = view.camera.distortion;
    const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    return Vector2d(view.camera.fx * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + view.camera.cx,
                    view.camera.fy * (y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + view.camera.cy);
  };
  for (const Vector3d& world : {Vector3d(0.3, 0.2, 2), Vector3d(-0.5, 0.6, 3), Vector3d(0.1, -0.7, 2.5)}) {
    const Vector2d before = pixel(stored, world);
    const double w = kWidth - 1, h = kHeight - 1;
    EXPECT_LT((pixel(turned(stored, 1), world) - Vector2d(h - before.y(), before.x())).norm(), test::kDoubleExact);
    EXPECT_LT((pixel(turned(stored, 2), world) - Vector2d(w - before.x(), h - before.y())).norm(), test::kDoubleExact);
    EXPECT_LT((pixel(turned(stored, 3), world) - Vector2d(before.y(), w - before.x())).norm(), test::kDoubleExact);
  }
}

}  // namespace
}  // namespace livecap
