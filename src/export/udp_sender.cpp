#include "export/udp_sender.h"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <charconv>
#include <memory>

#include "livecap/error.h"

namespace livecap {

UdpSender::UdpSender(const std::string& address) {
  const size_t colon = address.rfind(':');
  std::string host = address.substr(0, colon == std::string::npos ? 0 : colon);
  const std::string port = colon == std::string::npos ? "" : address.substr(colon + 1);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  int number = 0;
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
  if (host.empty() || error != std::errc() || end != port.data() + port.size() || number < 1 || number > 65535)
    throw ConfigError(address + ": must be HOST:PORT, such as 127.0.0.1:39539");

  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (const int code = getaddrinfo(host.c_str(), port.c_str(), &hints, &found); code != 0)
    throw ConfigError(address + ": there is no host " + host + " (" + gai_strerror(code) + ")");
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> all(found, freeaddrinfo);
  for (const bool v4 : {true, false}) {  // most receivers listen to the older one alone
    for (const addrinfo* one = found; one; one = one->ai_next) {
      if ((one->ai_family == AF_INET) != v4) continue;
      socket_ = ::socket(one->ai_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
      if (socket_ < 0) continue;
      const int yes = 1;
      ::setsockopt(socket_, SOL_SOCKET, SO_BROADCAST, &yes, sizeof(yes));
      if (::connect(socket_, one->ai_addr, one->ai_addrlen) == 0) return;
      ::close(socket_);
    }
  }
  throw ConfigError(address + ": no packet can be sent there");
}

UdpSender::~UdpSender() {
  ::close(socket_);
}

bool UdpSender::send(std::span<const uint8_t> packet) {
  // A refusal is of the packet before (nobody listened then): this one may be heard.
  for (int attempt = 0; attempt < 2; ++attempt) {
    if (::send(socket_, packet.data(), packet.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(packet.size())) return true;
  }
  return false;
}

}  // namespace livecap
