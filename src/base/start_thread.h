// A std::thread whose refusal by the system is an error of ours.
#pragma once

#include <functional>
#include <thread>

namespace livecap {

// Throws Error when the system allows no further thread.
std::thread start_thread(std::function<void()> body);

}  // namespace livecap
