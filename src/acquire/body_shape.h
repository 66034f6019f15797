// The body as a solid, of a visual hull or of a scan, and the surface of it that becomes the actor's.
#pragma once

#include <string>
#include <vector>

#include "acquire/keypoints.h"
#include "acquire/person_frame.h"
#include "meshing/isosurface.h"
#include "ocl/context.h"
#include "scan/volume.h"
#include "views/view.h"

namespace livecap::acquire {

struct BodyShape {
  Volume volume;          // what is inside of the body, also under cloth
  Volume open;            // the same with an open skirt; of size 0: there is no skirt
  meshing::Surface fine;  // of a scan
  bool as_is = false;     // `fine` is closed and clean, and thinned without a grid

  bool wears_skirt() const { return open.size() > 0; }
  const Volume& solid() const { return wears_skirt() ? open : volume; }  // what the surface is of
};

// The hull of the views' masks (in the rest frame, mm) around the keypoints, on a grid of grid_mm. n_ignored: how many
// of those that are not exact a point may be outside of, n_ignored_feet of the feet, 0 to 5. Throws ConfigError,
// OclError.
BodyShape carve_body(ocl::DeviceContext& device, const std::vector<View>& views, const SpaceKeypoints& keypoints,
                     double grid_mm, int n_ignored, int n_ignored_feet, std::vector<std::string>& notes);

// Of a scan in one piece, in the rest frame, mm: as it is when it is closed and clean, else as a solid on a grid.
// Throws ConfigError.
BodyShape shape_of_scan(const meshing::Surface& scan, std::vector<std::string>& notes);

// The shape's surface with about so many vertices. facet_offsets_mm: [n_vertices] how far each is to move along its
// normal (acquire/facet_offsets.h); unchanged when the shape is taken as it is. A note says when it has fewer vertices.
// Throws ConfigError when it is none of a person.
meshing::Surface thin_shape(BodyShape& shape, int target_vertices, std::vector<double>& facet_offsets_mm,
                            std::vector<std::string>& notes);

// What puts the soles on the floor, y = 0, and with given_height_mm > 0 scales to that height. height_mm: the height
// then. Throws ConfigError when that is no person's.
PersonFrame stand_on_floor(const meshing::Surface& surface, double given_height_mm, double& height_mm);

}  // namespace livecap::acquire
