// Materials of what no picture shows: those of what it goes on from.
#pragma once

#include <cstdint>
#include <vector>

#include "meshing/isosurface.h"

namespace livecap::acquire {

// Vertices that are not `known` take the label of the nearest known one, along the surface, where a crease is a long
// way: inside of a skirt nothing is seen, legs go on in it and its lining does not go down on them. Legs end where the
// skirt closes: what looks down there is one only when nothing else is near. known, labels: [n_vertices], LIP ids.
void spread_labels(const meshing::Surface& surface, std::vector<char> known, std::vector<uint8_t>& labels);

}  // namespace livecap::acquire
