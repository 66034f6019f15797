#include "eval/sequence_files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/json_text.h"
#include "base/log.h"
#include "base/number_text.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

struct Table {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
};

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) {
    while (!cell.empty() && (cell.back() == '\r' || cell.back() == ' ')) cell.pop_back();
    cells.push_back(cell.substr(std::min(cell.size(), cell.find_first_not_of(' '))));
  }
  if (!line.empty() && line.back() == ',') cells.emplace_back();
  return cells;
}

// Plain comma-separated values, the first line names the columns. A last line without a line feed was cut off by a
// crash and is left out, with a warning.
Table read_table(const std::filesystem::path& path) {
  require_no_pipe(path);
  std::string bytes = read_file(path);
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.erase(0, 3);  // byte order mark, as spreadsheets write it
  const size_t n_whole = bytes.rfind('\n') + 1;              // 0 where there is none
  if (n_whole > 0 && n_whole < bytes.size())
    log_warning(path.string() + ": the last line has no line feed: it was cut off, and is left out");
  std::istringstream in(bytes.substr(0, n_whole));
  Table table;
  for (std::string line; std::getline(in, line);) {
    if (table.columns.empty()) {
      table.columns = split(line);
      continue;
    }
    table.rows.push_back(split(line));
    if (table.rows.back().size() != table.columns.size()) {
      throw IoError(path.string() + format(": line %zu has %zu cells, expected %zu", table.rows.size() + 1,
                                           table.rows.back().size(), table.columns.size()));
    }
  }
  if (table.columns.empty()) throw IoError(path.string() + ": is empty, expected a line of column names");
  return table;
}

size_t column(const Table& table, const std::string& name, const std::filesystem::path& path) {
  const auto found = std::find(table.columns.begin(), table.columns.end(), name);
  if (found == table.columns.end()) throw IoError(path.string() + ": there is no column \"" + name + "\"");
  return found - table.columns.begin();
}

bool has_column(const Table& table, const std::string& name) {
  return std::find(table.columns.begin(), table.columns.end(), name) != table.columns.end();
}

// The frame that a row is of.
int64_t frame_index(const Table& table, size_t row, const std::filesystem::path& path) {
  const std::string& cell = table.rows[row][column(table, "index", path)];
  int64_t frame = -1;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), frame);
  if (error != std::errc() || end != cell.data() + cell.size() || frame < 0)
    throw IoError(path.string() +
                  format(": line %zu: index \"%s\" must be a whole number, 0 or more", row + 2, cell.c_str()));
  return frame;
}

// NaN for an empty cell.
float number(const Table& table, size_t row, size_t column, const std::filesystem::path& path) {
  const std::string& cell = table.rows[row][column];
  if (cell.empty()) return std::nanf("");
  const char* end = cell.data() + cell.size();
  double value = 0;
  if (read_number(cell.data(), end, value) != end)
    throw IoError(path.string() + format(": line %zu: %s \"%s\" must be a number, empty or nan", row + 2,
                                         table.columns[column].c_str(), cell.c_str()));
  return static_cast<float>(value);
}

// Of a column that not every file has: NaN without it.
float number(const Table& table, size_t row, const char* name, const std::filesystem::path& path) {
  return has_column(table, name) ? number(table, row, column(table, name, path), path) : std::nanf("");
}

// The columns of a point stand side by side. x: that of its x.
void require_y_and_z(const Table& table, size_t x, const std::string& point, const std::filesystem::path& path) {
  for (size_t axis : {1, 2}) {
    const std::string expected = point + "_" + "xyz"[axis];
    const std::string found =
        x + axis < table.columns.size() ? '"' + table.columns[x + axis] + '"' : "the end of the line";
    if (found != '"' + expected + '"')
      throw IoError(path.string() + ": after column \"" + table.columns[x + axis - 1] + "\" must come \"" + expected +
                    "\", not " + found);
  }
}

std::vector<float> read_joint_frame(const nlohmann::json& frame, size_t n_joints, const std::string& where) {
  if (frame.is_null()) return {};
  if (!frame.is_array() || frame.size() != n_joints) {
    throw IoError(where + format(": expected null or %zu positions", n_joints));
  }
  std::vector<float> positions;
  bool known = true;
  for (const nlohmann::json& point : frame) {
    if (point.is_null()) {
      known = false;
      continue;
    }
    if (!point.is_array() || point.size() != 3) throw IoError(where + ": expected [x,y,z] per joint");
    for (const nlohmann::json& value : point) {
      if (!value.is_number() && !value.is_null())
        throw IoError(where + ": " + one_line(json_text(value), 40) + " must be a number or null");
      known = known && value.is_number();
      positions.push_back(known ? value.get<float>() : 0);
    }
  }
  return known ? positions : std::vector<float>();
}

}  // namespace

int index_of(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

JointTrack read_joints_json(const std::filesystem::path& path) {
  require_no_pipe(path);
  const nlohmann::json json = nlohmann::json::parse(read_file(path), nullptr, false);
  if (!json.is_object()) throw IoError(path.string() + ": is not a JSON object");
  const auto names = json.find("names");
  const auto frames = json.find("frames");
  if (names == json.end() || !names->is_array()) throw IoError(path.string() + ": field \"names\" is not a list");
  if (frames == json.end() || !frames->is_array()) throw IoError(path.string() + ": field \"frames\" is not a list");
  JointTrack track;
  for (const nlohmann::json& name : *names) {
    if (!name.is_string()) throw IoError(path.string() + ": field \"names\" holds something that is not a text");
    track.names.push_back(name.get<std::string>());
  }
  for (size_t i = 0; i < frames->size(); ++i) {
    track.frames.push_back(
        read_joint_frame((*frames)[i], track.names.size(), path.string() + format(": field \"frames\"[%zu]", i)));
  }
  return track;
}

JointTrack read_joints_csv(const std::filesystem::path& path) {
  const Table table = read_table(path);
  JointTrack track;
  std::vector<size_t> columns;  // of x; y and z follow
  const std::string end = "_x";
  for (const std::string prefix : {"joint_", "keypoint_"}) {
    for (size_t c = 0; c < table.columns.size(); ++c) {
      const std::string& title = table.columns[c];
      if (!title.starts_with(prefix) || !title.ends_with(end)) continue;
      const std::string name = title.substr(prefix.size(), title.size() - prefix.size() - end.size());
      if (std::find(track.names.begin(), track.names.end(), name) != track.names.end()) continue;
      require_y_and_z(table, c, prefix + name, path);
      track.names.push_back(name);
      columns.push_back(c);
    }
  }
  if (columns.empty()) throw IoError(path.string() + ": there is no column joint_<name>_x");
  for (size_t row = 0; row < table.rows.size(); ++row) {
    std::vector<float> positions;
    bool any = false;
    for (size_t c : columns) {
      float point[3];
      for (size_t axis = 0; axis < 3; ++axis) point[axis] = number(table, row, c + axis, path);
      const bool known = std::all_of(point, point + 3, [](float value) { return std::isfinite(value); });
      for (float value : point) positions.push_back(known ? value : std::nanf(""));
      any = any || known;
    }
    track.frames.push_back(any ? positions : std::vector<float>());
    if (!has_column(table, "index")) continue;
    const bool tracked = any && number(table, row, "tracked", path) != 0;
    track.rows.push_back(
        {frame_index(table, row, path), tracked ? "ok" : "lost", number(table, row, "pts_ms", path), std::nanf("")});
  }
  return track;
}

AngleTrack read_angles_csv(const std::filesystem::path& path) {
  const Table table = read_table(path);
  const size_t first = column(table, "tracked", path) + 1;
  AngleTrack track;
  track.names.assign(table.columns.begin() + static_cast<std::ptrdiff_t>(first), table.columns.end());
  for (size_t row = 0; row < table.rows.size(); ++row) {
    std::vector<double> angles;
    for (size_t c = first; c < table.columns.size(); ++c) angles.push_back(number(table, row, c, path));
    const bool known = std::all_of(angles.begin(), angles.end(), [](double value) { return std::isfinite(value); });
    track.frames.push_back(known ? angles : std::vector<double>());
  }
  return track;
}

std::vector<FrameRow> read_frames_csv(const std::filesystem::path& path) {
  const Table table = read_table(path);
  column(table, "index", path);  // a file without rows needs it as well
  const size_t status = column(table, "status", path);
  std::vector<FrameRow> rows;
  for (size_t row = 0; row < table.rows.size(); ++row)
    rows.push_back({frame_index(table, row, path), table.rows[row][status], number(table, row, "pts_ms", path),
                    number(table, row, "latency_ms", path)});
  return rows;
}

}  // namespace livecap
