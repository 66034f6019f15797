#include "capture/pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <optional>
#include <thread>
#include <utility>

#include "capture/channel.h"
#include "livecap/error.h"

namespace livecap {
namespace {

// Stages that count to n_frames and write down what was published.
struct Recorder {
  int n_frames = 0;
  int next = 0;
  std::vector<int64_t> published;
  std::vector<int64_t> dropped;

  PipelineStages stages() {
    PipelineStages s;
    s.read = [this](WorkItem& item) {
      if (next >= n_frames) return false;
      item.report.index = next++;
      return true;
    };
    s.detect = [](WorkItem& item) { item.detections.frame_index = item.report.index; };
    s.gate = [](WorkItem& item) { item.gate.has_network = true; };
    s.segment = [](WorkItem& item) {
      EXPECT_TRUE(item.gate.has_network) << "gate comes before";
      item.silhouette.area_px = static_cast<int>(item.detections.frame_index);
    };
    s.solve = [](WorkItem&& item) {
      item.report.score = static_cast<double>(item.silhouette.area_px);
      return std::optional<WorkItem>(std::move(item));
    };
    s.flush = [] { return std::nullopt; };
    s.surface = [](WorkItem& item) { item.report.iou = item.report.score; };
    s.publish = [this](WorkItem& item) {
      EXPECT_EQ(item.report.iou, static_cast<double>(item.report.index));
      for (const auto& report : item.dropped_before) {
        EXPECT_EQ(report.status, TrackStatus::kDropped);
        dropped.push_back(report.index);
      }
      published.push_back(item.report.index);
      return true;
    };
    return s;
  }
};

TEST(Pipeline, EveryFrameOnceInOrder) {
  for (int n : {0, 1, 2, 50}) {
    Recorder sequential{n}, pipelined{n};
    run_sequential(sequential.stages());
    run_pipelined(pipelined.stages(), false);
    EXPECT_EQ(sequential.published, pipelined.published);
    EXPECT_EQ(pipelined.published.size(), static_cast<size_t>(n));
    EXPECT_TRUE(pipelined.dropped.empty());
  }
}

TEST(Pipeline, NewestWinsAndDropsAreCounted) {
  Recorder recorder{40};
  PipelineStages stages = recorder.stages();
  stages.detect = [](WorkItem& item) {
    item.detections.frame_index = item.report.index;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  };
  run_pipelined(stages, true);
  EXPECT_EQ(recorder.published.size() + recorder.dropped.size(), 40u);
  EXPECT_FALSE(recorder.dropped.empty());
  EXPECT_EQ(recorder.published.back(), 39);
}

// Pictures that come faster than they are read: one that displaces another may have displaced some before.
TEST(Pipeline, WhatIsDroppedStaysInOrder) {
  const auto item = [](int64_t index, std::vector<int64_t> dropped_before) {
    WorkItem made;
    made.report.index = index;
    for (const int64_t i : dropped_before) {
      made.dropped_before.emplace_back();
      made.dropped_before.back().index = i;
      made.dropped_before.back().status = TrackStatus::kDropped;
    }
    return made;
  };
  WorkItem newer = item(5, {3, 4});
  inherit_dropped(newer, item(2, {0, 1}));
  ASSERT_EQ(newer.dropped_before.size(), 5u);
  for (int64_t i = 0; i < 5; ++i) {
    EXPECT_EQ(newer.dropped_before[i].index, i);
    EXPECT_EQ(newer.dropped_before[i].status, TrackStatus::kDropped);
  }
}

// A read that waits is told when another stage ends the run.
TEST(Pipeline, AnEarlyEndWakesTheReader) {
  Recorder recorder{3};
  PipelineStages stages = recorder.stages();
  Channel<int> never;
  stages.read = [&, read = stages.read](WorkItem& item) { return read(item) || never.pop(); };
  stages.stop_reading = [&] { never.abort(); };
  stages.publish = [](WorkItem& item) { return item.report.index < 2; };
  run_pipelined(stages, false);
  EXPECT_TRUE(never.aborted());
}

TEST(Pipeline, AnErrorInAnyStageEndsTheRunWithItsMessage) {
  for (int failing = 0; failing < 7; ++failing) {
    Recorder recorder{1000};
    PipelineStages stages = recorder.stages();
    auto fail_at_ten = [](WorkItem& item) {
      if (item.report.index == 10) throw IoError("frame ten");
    };
    if (failing == 0) {
      stages.read = [&, read = stages.read](WorkItem& item) {
        const bool more = read(item);
        fail_at_ten(item);
        return more;
      };
    }
    if (failing == 1) stages.detect = fail_at_ten;
    if (failing == 2) stages.segment = fail_at_ten;
    if (failing == 3) {
      stages.solve = [&](WorkItem&& item) {
        fail_at_ten(item);
        return std::optional<WorkItem>(std::move(item));
      };
    }
    if (failing == 4) stages.surface = fail_at_ten;
    if (failing == 6) {
      stages.gate = [&, gate = stages.gate](WorkItem& item) {
        gate(item);
        fail_at_ten(item);
      };
    }
    if (failing == 5) {
      stages.publish = [&](WorkItem& item) {
        fail_at_ten(item);
        return true;
      };
    } else {
      stages.publish = [](WorkItem&) { return true; };
    }
    EXPECT_THROW(run_pipelined(stages, false), IoError) << failing;
  }
}

TEST(Pipeline, ASolverMayKeepAFrameUntilTheNext) {
  for (const bool pipelined : {false, true}) {
    Recorder recorder{7};
    PipelineStages stages = recorder.stages();
    std::optional<WorkItem> kept;
    stages.solve = [&](WorkItem&& item) {
      item.report.score = static_cast<double>(item.report.index);
      return std::exchange(kept, std::move(item));
    };
    stages.flush = [&] { return std::exchange(kept, std::nullopt); };
    pipelined ? run_pipelined(stages, false) : run_sequential(stages);
    EXPECT_EQ(recorder.published, (std::vector<int64_t>{0, 1, 2, 3, 4, 5, 6})) << pipelined;
  }
}

// Two kept for later ones, three at work: never more between network and publishing, and none lost.
TEST(Pipeline, NoMoreThanThereMayBeAreUnderWay) {
  constexpr int kMost = 5;
  for (const bool newest_wins : {false, true}) {
    Recorder recorder{60};
    PipelineStages stages = recorder.stages();
    std::atomic<int> under_way = 0, most = 0;
    stages.read = [&, read = stages.read](WorkItem& item) {
      if (newest_wins) std::this_thread::sleep_for(std::chrono::microseconds(400));  // a camera
      return read(item);
    };
    stages.detect = [&](WorkItem& item) {
      most = std::max<int>(most, ++under_way);
      item.detections.frame_index = item.report.index;
    };
    std::deque<WorkItem> kept;
    const auto oldest = [&] {
      std::optional<WorkItem> item = std::move(kept.front());
      kept.pop_front();
      return item;
    };
    stages.solve = [&](WorkItem&& item) {
      item.report.score = static_cast<double>(item.report.index);
      kept.push_back(std::move(item));
      return kept.size() > 2 ? oldest() : std::nullopt;
    };
    stages.flush = [&] { return kept.empty() ? std::nullopt : oldest(); };
    stages.surface = [](WorkItem& item) {
      item.report.iou = item.report.score;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));  // the slowest
    };
    stages.publish = [&, publish = stages.publish](WorkItem& item) {
      --under_way;
      return publish(item);
    };
    run_pipelined(stages, newest_wins, kMost);
    EXPECT_LE(most, kMost);
    EXPECT_GE(most, kMost - 1) << "there is room for so many";
    EXPECT_EQ(recorder.published.size() + recorder.dropped.size(), 60u);
    EXPECT_EQ(recorder.published.back(), 59);
    EXPECT_EQ(newest_wins, !recorder.dropped.empty());
  }
}

TEST(Pipeline, PublishCanStopEarly) {
  Recorder recorder{1000};
  PipelineStages stages = recorder.stages();
  stages.publish = [&](WorkItem& item) {
    recorder.published.push_back(item.report.index);
    return item.report.index < 5;
  };
  run_pipelined(stages, false);
  EXPECT_EQ(recorder.published.size(), 6u);
}

}  // namespace
}  // namespace livecap
