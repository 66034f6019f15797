// Packets to one receiver. Nobody needs to listen: what is lost is lost.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace livecap {

class UdpSender {
 public:
  // address: "host:port" or "[v6]:port". Throws ConfigError for something else or a host that has no address. A name
  // with addresses of both kinds is the v4 one; broadcast addresses are allowed.
  explicit UdpSender(const std::string& address);
  ~UdpSender();
  UdpSender(const UdpSender&) = delete;
  UdpSender& operator=(const UdpSender&) = delete;

  // Never waits. False when the system would not take it (too large, no route).
  bool send(std::span<const uint8_t> packet);

 private:
  int socket_ = -1;
};

}  // namespace livecap
