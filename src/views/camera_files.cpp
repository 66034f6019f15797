#include "views/camera_files.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <locale>
#include <map>
#include <opencv2/core.hpp>
#include <sstream>

#include "actor/skeletool.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

namespace {

using std::filesystem::path;

[[noreturn]] void fail(const path& file, const std::string& what) {
  throw IoError(file.string() + ": " + what);
}

// COLMAP's models whose distortion a Camera can hold, and which of its parameters fill fx, fy, cx, cy, k1, k2, p1, p2.
struct ColmapModel {
  const char* name;
  int n_parameters;
  std::array<int, 8> slot;  // -1: zero
};
constexpr ColmapModel kModels[] = {
    {"SIMPLE_PINHOLE", 3, {0, 0, 1, 2, -1, -1, -1, -1}},
    {"PINHOLE", 4, {0, 1, 2, 3, -1, -1, -1, -1}},
    {"SIMPLE_RADIAL", 4, {0, 0, 1, 2, 3, -1, -1, -1}},
    {"RADIAL", 5, {0, 0, 1, 2, 3, 4, -1, -1}},
    {"OPENCV", 8, {0, 1, 2, 3, 4, 5, 6, 7}},
};

Camera colmap_camera(const path& file, int line, const std::string& model, int width, int height,
                     const std::vector<double>& p) {
  std::string known;
  for (const ColmapModel& m : kModels) {
    known += (known.empty() ? "" : ", ") + std::string(m.name);
    if (model != m.name) continue;
    if (static_cast<int>(p.size()) != m.n_parameters)
      fail(file, format("line %d: %s has %zu parameters, needs %d", line, m.name, p.size(), m.n_parameters));
    const auto value = [&](int i) { return m.slot[i] < 0 ? 0.0 : p[m.slot[i]]; };
    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.fx = value(0);
    camera.fy = value(1);
    camera.cx = value(2) - 0.5;  // COLMAP's first pixel has its centre at 0.5
    camera.cy = value(3) - 0.5;
    camera.distortion = {value(4), value(5), value(6), value(7), 0};
    try {
      camera.validate();
    } catch (const ConfigError& error) {
      fail(file, format("line %d: %s", line, error.what()));
    }
    return camera;
  }
  fail(file, format("line %d: camera model %s is not supported; undistort the pictures in COLMAP or use one of ", line,
                    model.c_str()) +
                 known);
}

std::map<int, Camera> read_colmap_cameras(const path& file) {
  std::istringstream in(read_file(file));
  std::map<int, Camera> cameras;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.empty() || line[0] == '#' || line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream fields(line);
    fields.imbue(std::locale::classic());  // not with the decimal comma of the program that calls
    int id, width, height;
    std::string model;
    if (!(fields >> id >> model >> width >> height))
      fail(file, format("line %d is not CAMERA_ID MODEL WIDTH HEIGHT PARAMETERS...", number));
    std::vector<double> parameters;
    for (double value; fields >> value;) parameters.push_back(value);
    cameras[id] = colmap_camera(file, number, model, width, height, parameters);
  }
  if (cameras.empty()) fail(file, "holds no camera");
  return cameras;
}

std::vector<ViewPose> read_colmap(const path& folder) {
  const auto cameras = read_colmap_cameras(folder / "cameras.txt");
  const path file = folder / "images.txt";
  std::istringstream in(read_file(file));
  std::vector<ViewPose> views;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.empty() || line[0] == '#' || line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream fields(line);
    fields.imbue(std::locale::classic());  // not with the decimal comma of the program that calls
    int id, camera;
    double w, x, y, z, tx, ty, tz;
    std::string name;
    if (!(fields >> id >> w >> x >> y >> z >> tx >> ty >> tz >> camera) || !std::getline(fields >> std::ws, name))
      fail(file, format("line %d is not IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME", number));
    if (!name.empty() && name.back() == '\r') name.pop_back();
    const auto known = cameras.find(camera);
    if (known == cameras.end()) fail(file, format("line %d: camera %d is not in cameras.txt", number, camera));
    const Eigen::Quaterniond q(w, x, y, z);
    if (!(q.norm() > 0.5 && q.norm() < 2)) fail(file, format("line %d: the quaternion has no direction", number));
    ViewPose view{name, known->second, Eigen::Isometry3d::Identity()};
    view.camera_from_world.linear() = q.normalized().toRotationMatrix();
    view.camera_from_world.translation() = Eigen::Vector3d(tx, ty, tz);
    views.push_back(view);
    std::getline(in, line);  // the picture's points
    ++number;
  }
  if (views.empty()) fail(file, "holds no picture");
  return views;
}

cv::Mat matrix(const path& file, const cv::FileNode& node, const std::string& what, int rows, int cols) {
  cv::Mat m;
  if (!node.empty()) node >> m;
  if (m.empty()) fail(file, what + " is missing");
  m.convertTo(m, CV_64F);
  if (m.rows == cols && m.cols == rows && rows != cols) m = m.t();
  if (m.rows != rows || m.cols != cols)
    fail(file, what + format(" is %d x %d, must be %d x %d", m.rows, m.cols, rows, cols));
  return m;
}

// Nodes of the view itself win over those at the top of the file.
ViewPose opencv_view(const path& file, const cv::FileNode& top, const cv::FileNode& node, int index) {
  const auto pick = [&](const char* name) { return node[name].empty() ? top[name] : node[name]; };
  const std::string what = format("view %d: ", index);
  ViewPose view;
  if (node["image"].isString()) view.picture = static_cast<std::string>(node["image"]);
  if (view.picture.empty()) fail(file, what + "image is missing");
  view.camera.width = pick("image_width").empty() ? 0 : static_cast<int>(pick("image_width"));
  view.camera.height = pick("image_height").empty() ? 0 : static_cast<int>(pick("image_height"));
  if (view.camera.width <= 0 || view.camera.height <= 0) fail(file, what + "image_width or image_height is missing");
  const cv::Mat k = matrix(file, pick("camera_matrix"), what + "camera_matrix", 3, 3);
  view.camera.fx = k.at<double>(0, 0);
  view.camera.fy = k.at<double>(1, 1);
  view.camera.cx = k.at<double>(0, 2);
  view.camera.cy = k.at<double>(1, 2);
  if (cv::Mat d; !pick("distortion_coefficients").empty()) {
    pick("distortion_coefficients") >> d;
    d.convertTo(d, CV_64F);
    d = d.reshape(1, 1);
    for (int i = 0; i < d.cols; ++i) {
      if (i < 5) view.camera.distortion[i] = d.at<double>(i);
      if (i >= 5 && d.at<double>(i) != 0)
        fail(file, what + "distortion_coefficients has more than the five k1 k2 p1 p2 k3; calibrate without the rest");
    }
  }
  try {
    view.camera.validate();
  } catch (const ConfigError& error) {
    fail(file, what + error.what());
  }
  Eigen::Matrix3d rotation;
  if (!node["R"].empty()) {
    const cv::Mat r = matrix(file, node["R"], what + "R", 3, 3);
    for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = r.at<double>(i / 3, i % 3);
    if (!((rotation * rotation.transpose()).isIdentity(1e-3) && rotation.determinant() > 0))
      fail(file, what + "R is no rotation");
  } else {
    const cv::Mat r = matrix(file, node["rvec"], what + "R or rvec", 3, 1);
    const Eigen::Vector3d v(r.at<double>(0), r.at<double>(1), r.at<double>(2));
    rotation = v.norm() > 1e-12 ? Eigen::AngleAxisd(v.norm(), v.normalized()).toRotationMatrix()
                                : Eigen::Matrix3d::Identity().eval();
  }
  const cv::Mat t = matrix(file, node["T"].empty() ? node["tvec"] : node["T"], what + "T or tvec", 3, 1);
  view.camera_from_world.linear() = rotation;
  view.camera_from_world.translation() = Eigen::Vector3d(t.at<double>(0), t.at<double>(1), t.at<double>(2));
  return view;
}

std::vector<ViewPose> read_opencv(const path& file) {
  const std::string text = read_file(file);  // says when there is no such file
  std::vector<ViewPose> views;
  try {
    const cv::FileStorage storage(file.string(), cv::FileStorage::READ);
    if (!storage.isOpened()) fail(file, "is no OpenCV YAML, XML or JSON file");
    const cv::FileNode top = storage.root();
    const cv::FileNode list = top["views"];
    if (!list.isSeq()) fail(file, "holds no list `views`");
    int index = 0;
    for (const cv::FileNode& node : list) views.push_back(opencv_view(file, top, node, index++));
  } catch (const cv::Exception& error) {
    fail(file, "is no OpenCV YAML, XML or JSON file: " + error.err);
  }
  if (views.empty()) fail(file, "`views` is empty");
  return views;
}

// Cameras of an array, one picture each: the picture called as the camera is, or, when none is and there are as many
// pictures as cameras, the one at its place in the order of names.
std::vector<ViewPose> read_skeletool(const path& file, const path& pictures) {
  const std::vector<SkeletoolCamera> cameras = load_skeletool_cameras(file);
  if (!std::filesystem::is_directory(pictures)) throw IoError(pictures.string() + ": is no folder of pictures");
  std::map<std::string, std::string> picture_of;  // by stem
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(pictures)) {
    const path name = entry.path().filename();
    if (name.extension() != ".png" && name.extension() != ".jpg") continue;
    names.push_back(name.string());
    picture_of[name.stem().string()] = name.string();
  }
  std::sort(names.begin(), names.end());
  std::vector<ViewPose> views;
  for (const SkeletoolCamera& camera : cameras)
    if (const auto found = picture_of.find(camera.name); found != picture_of.end())
      views.push_back({found->second, camera.camera, camera.camera_from_world});
  if (views.empty() && names.size() == cameras.size())
    for (size_t i = 0; i < cameras.size(); ++i)
      views.push_back({names[i], cameras[i].camera, cameras[i].camera_from_world});
  if (views.empty())
    fail(file, format("its %zu cameras (\"%s\", ...) have no picture of their name in %s, which has %zu pictures",
                      cameras.size(), cameras[0].name.c_str(), pictures.string().c_str(), names.size()));
  return views;
}

bool is_skeletool(const path& file) {
  return file.extension() == ".calibration" || read_file(file).rfind("Skeletool Camera Calibration", 0) == 0;
}

}  // namespace

bool is_colmap_model(const path& folder) {
  return std::filesystem::exists(folder / "cameras.txt") && std::filesystem::exists(folder / "images.txt");
}

std::vector<ViewPose> read_view_poses(const path& path, const std::filesystem::path& pictures) {
  if (std::filesystem::is_directory(path) && !is_colmap_model(path))
    throw IoError(path.string() + ": holds no cameras.txt and images.txt" +
                  (std::filesystem::exists(path / "cameras.bin")
                       ? "; convert the binary model: colmap model_converter --output_type TXT"
                       : ""));
  auto views = std::filesystem::is_directory(path) ? read_colmap(path)
               : is_skeletool(path)                ? read_skeletool(path, pictures)
                                                   : read_opencv(path);
  std::stable_sort(views.begin(), views.end(),
                   [](const ViewPose& a, const ViewPose& b) { return a.picture < b.picture; });
  return views;
}

path find_view_poses(const path& pictures) {
  const path parent = std::filesystem::absolute(pictures / ".").parent_path().parent_path();
  for (const path& folder : {pictures, parent, parent / "sparse" / "0", parent / "sparse"}) {
    if (is_colmap_model(folder)) return folder;
    for (const char* name : {"cameras.yml", "cameras.yaml", "cameras.json", "cameras.xml", "cameras.calibration"})
      if (std::filesystem::exists(folder / name)) return folder / name;
  }
  throw ConfigError(
      "--cameras: none of " + pictures.string() +
      ", the folder around it, and sparse/0 and sparse there holds cameras.txt and images.txt (COLMAP text "
      "model) or cameras.yml, .yaml, .json, .xml or .calibration; --colmap finds them when COLMAP is "
      "installed");
}

}  // namespace livecap
