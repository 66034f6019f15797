// The materials of a mesh's vertices from a file (LIP ids).
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace livecap::acquire {

// One id per vertex, in the order of the mesh's file: NumPy .npy (whole numbers or floats, one dimension, little
// endian), or text with a number a line, as DeepCap's templates have (segmentation.txt). mesh: for messages. Throws
// IoError naming the file, and the line or vertex, when it is neither, holds other than n_vertices, or anything but
// 0..19.
std::vector<uint8_t> read_vertex_labels(const std::filesystem::path& path, size_t n_vertices,
                                        const std::filesystem::path& mesh);

}  // namespace livecap::acquire
