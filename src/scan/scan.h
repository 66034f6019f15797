// A given mesh of the person: .obj, .ply or .glb, with colours from a texture or per vertex, or none.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "base/image_rgb.h"
#include "meshing/isosurface.h"
#include "meshing/nearest_surface.h"

namespace livecap {

struct Scan {
  meshing::Surface surface;             // units and axes of the file; equal positions are one vertex
  std::vector<Eigen::Vector3d> colors;  // [n_vertices] sRGB in [0,1]; empty: none
  std::vector<Eigen::Vector2d> uvs;     // [3*n_triangles] v down; empty: no texture
  ImageRgb texture;
  std::vector<int> vertex_of_file;  // [vertices of the file] which vertex each became; empty after keep_largest_piece

  bool has_color() const { return !colors.empty() || !texture.empty(); }
  Eigen::Vector3d color_at(const meshing::SurfacePoint& point) const;
};

// texture: of an .obj, instead of the picture that its material file names. Throws IoError naming the file and what is
// wrong with it. What was ignored is appended to notes.
Scan read_scan(const std::filesystem::path& path, std::vector<std::string>& notes,
               const std::filesystem::path& texture = {});

// Every edge has exactly two triangles that run along it in opposite directions, and every vertex one fan of triangles.
bool is_closed_manifold(const meshing::Surface& surface);

// Leaves only the connected piece with the largest area and its colours; returns the share of the area that was
// dropped.
double keep_largest_piece(Scan& scan);

}  // namespace livecap
