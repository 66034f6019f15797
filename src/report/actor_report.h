// actor.html: what a built actor looks like and what the build had to assume. One file, pictures inside.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "actor/actor.h"

namespace livecap {

struct ReportText {
  std::string title;
  std::vector<std::string> facts;  // one line each
  std::vector<std::string> notes;  // warnings, one line each
};

std::string actor_report_html(const Actor& actor, const ReportText& text);

// What `livecap actor compare` prints, with the distance to the true surface painted on the actor: white 0, red 20 mm
// and more; blue where hidden. distances_mm: [n_vertices]; hidden: [n_vertices], or empty.
std::string comparison_html(const Actor& actor, const std::string& text, const std::vector<double>& distances_mm,
                            const std::vector<char>& hidden);

}  // namespace livecap
