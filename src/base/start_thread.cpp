#include "base/start_thread.h"

#include <string>
#include <system_error>
#include <utility>

#include "livecap/error.h"

namespace livecap {

std::thread start_thread(std::function<void()> body) {
  try {
    return std::thread(std::move(body));
  } catch (const std::system_error& error) {
    throw Error(std::string("the system allows no further thread (") + error.what() +
                "); let this user have more processes (ulimit -u)");
  }
}

}  // namespace livecap
