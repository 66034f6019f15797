// Bounded hand-over of depth one between two threads of the pipeline.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <utility>

namespace livecap {

// One producer, one consumer. After abort() both sides return at once; after close() the consumer drains what is left.
template <typename T>
class Channel {
 public:
  // Waits for room. False when the channel was aborted: the value is lost and the producer should stop.
  bool push(T value) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !slot_ || aborted_; });
    if (aborted_) return false;
    slot_ = std::move(value);
    changed_.notify_all();
    return true;
  }

  // Never waits: the newest wins. merge(newer, std::move(displaced)) is called when a value was still waiting.
  // False when aborted.
  template <typename Merge>
  bool push_newest(T value, Merge&& merge) {
    std::unique_lock lock(mutex_);
    if (aborted_) return false;
    if (slot_) merge(value, std::move(*slot_));
    slot_ = std::move(value);
    changed_.notify_all();
    return true;
  }

  // Waits for a value. Empty when closed and drained, or aborted.
  std::optional<T> pop() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return slot_ || closed_ || aborted_; });
    if (aborted_) return std::nullopt;
    std::optional<T> value = std::exchange(slot_, std::nullopt);
    changed_.notify_all();
    return value;
  }

  void close() {
    std::unique_lock lock(mutex_);
    closed_ = true;
    changed_.notify_all();
  }

  void abort() {
    std::unique_lock lock(mutex_);
    aborted_ = true;
    changed_.notify_all();
  }

  bool aborted() {
    std::unique_lock lock(mutex_);
    return aborted_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<T> slot_;
  bool closed_ = false;
  bool aborted_ = false;
};

}  // namespace livecap
