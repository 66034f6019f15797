// actor.html: what a built actor looks like and what the build had to assume. One file, pictures inside.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "actor/actor.h"

namespace livecap::acquire {

struct ReportText {
  std::string title;
  std::vector<std::string> facts;  // one line each
  std::vector<std::string> notes;  // warnings, one line each
};

std::string actor_report_html(const Actor& actor, const ReportText& text);

// Poses that show what skinning does: arms down, arms up, a step, a squat, a twist of the head, a hug.
std::vector<Eigen::VectorXd> check_poses(const Skeleton& skeleton);

}  // namespace livecap::acquire
