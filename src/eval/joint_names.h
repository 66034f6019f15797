// Which joint of a truth file is which joint of a capture. Truth files use the names of their rig.
#pragma once

#include <string>
#include <vector>

namespace livecap {

struct JointPair {
  std::string name;   // the capture's
  int captured = -1;  // index into the capture's names
  int truth = -1;     // index into the truth's names
};

// The joints both sides have, of: root, neck, and on each side shoulder, elbow, wrist, hip, knee, ankle. Truth names
// are the capture's own, or Mixamo's or UE/MakeHuman's with or without prefix. A captured root may be called pelvis.
std::vector<JointPair> match_joints(const std::vector<std::string>& captured, const std::vector<std::string>& truth);

// Those that only the truth has, by the capture's names.
std::vector<std::string> joints_not_captured(const std::vector<std::string>& captured,
                                             const std::vector<std::string>& truth);

}  // namespace livecap
