// Whole pages: one file each, with its pictures inside.
#include <gtest/gtest.h>

#include "report/actor_report.h"
#include "report/contact_sheet.h"
#include "report/html_report.h"
#include "support/capture_by_hand.h"

namespace livecap {
namespace {

class Pages : public test::CaptureByHand {};

TEST_F(Pages, AnEvaluationIsOneFileWithPictures) {
  const EvalReport report = compare({0, 0.1f, 0, 0}, {"nobody", "ok", "lost", "ok"});
  const EvalOptions options{folder_ / "capture", folder_ / "truth", "", "", {}};
  const std::string html = html_report({options, "", report, nullptr, nullptr, judge_bars(report)});
  EXPECT_EQ(html.rfind("<!DOCTYPE html>", 0), 0u);
  EXPECT_NE(html.find("</html>"), std::string::npos);
  for (const char* outside : {"http:", "https:", "<script", "url(", "nan"}) {
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
  }
  const auto count = [&](const std::string& word) {
    int n = 0;
    for (size_t at = html.find(word); at != std::string::npos; at = html.find(word, at + 1)) ++n;
    return n;
  };
  EXPECT_EQ(count("data:image/png"), 1);       // the error on the mesh
  EXPECT_EQ(count("data:image/jpeg"), 4 * 3);  // three frames: evenly, and worst by vertices, joints and silhouette
  EXPECT_EQ(count("<svg"), 3);                 // IoU, vertices, joints; nothing loose
  EXPECT_EQ(count("class=\"lost\""), 3);       // frame 2 in each
}

TEST_F(Pages, TheHeatMapOfAnotherMeshIsOfItsOwnSurface) {
  compare({0, 0.1f, 0.1f, 0.1f}, {"nobody", "ok", "ok", "ok"});
  // Moved as a whole it has no warm colour in the heat map, the last of three panels (there is no video); any other
  // order of the vertices would give it some.
  const ContactSheet sheet = contact_sheet(with_other_mesh(), "", {1}, 160);
  ASSERT_TRUE(sheet.has_error);
  const ImageRgb& picture = sheet.pictures.at(1);
  int n_warm = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = picture.width * 2 / 3 + 4; x < picture.width; ++x) {
      const uint8_t* rgb = &picture.pixels[size_t(3) * (size_t(y) * picture.width + x)];
      n_warm += rgb[0] > rgb[1] + 60;
    }
  }
  EXPECT_EQ(n_warm, 0);
}

TEST_F(Pages, AnActorIsOneFile) {
  const std::string html = actor_report_html(actor_, {"t", {"a < b"}, {"a note"}});
  EXPECT_NE(html.find("a &lt; b"), std::string::npos);
  EXPECT_NE(html.find("a note"), std::string::npos);
  EXPECT_EQ(html.find("://"), std::string::npos) << "the report must stand alone";
}

}  // namespace
}  // namespace livecap
