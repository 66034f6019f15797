#include "export/udp_sender.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <vector>

#include "livecap/error.h"

namespace livecap {
namespace {

// A socket on this machine that waits at most two seconds.
class Receiver {
 public:
  Receiver() : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&here), sizeof(here)), 0);
    socklen_t size = sizeof(here);
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&here), &size);
    port = ntohs(here.sin_port);
    const timeval two_seconds{2, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &two_seconds, sizeof(two_seconds));
  }
  ~Receiver() { ::close(socket_); }
  std::vector<uint8_t> packet() {
    std::vector<uint8_t> bytes(65536);
    const ssize_t got = ::recv(socket_, bytes.data(), bytes.size(), 0);
    bytes.resize(got < 0 ? 0 : got);
    return bytes;
  }
  int port = 0;

 private:
  int socket_;
};

TEST(UdpSender, WhatIsSentArrives) {
  Receiver receiver;
  UdpSender sender("127.0.0.1:" + std::to_string(receiver.port));
  for (const size_t size : {size_t(1), size_t(1000), size_t(3000)}) {
    std::vector<uint8_t> packet(size);
    for (size_t i = 0; i < size; ++i) packet[i] = static_cast<uint8_t>(7 * i + size);
    EXPECT_TRUE(sender.send(packet));
    EXPECT_EQ(receiver.packet(), packet);
  }
}

// The system tells of a port without listener at the next packet, which may be heard.
TEST(UdpSender, NobodyNeedsToListen) {
  int port = 0;
  {
    Receiver gone;
    port = gone.port;
  }
  UdpSender sender("127.0.0.1:" + std::to_string(port));
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(sender.send(std::vector<uint8_t>{1, 2, 3}));
  EXPECT_FALSE(sender.send(std::vector<uint8_t>(100000))) << "larger than any packet";
}

TEST(UdpSender, AddressesThatAreNone) {
  for (const char* address : {"", "39539", "127.0.0.1", "127.0.0.1:", ":39539", "127.0.0.1:0", "127.0.0.1:65536",
                              "127.0.0.1:12x", "no-such-host.invalid:39539"})
    EXPECT_THROW(UdpSender{address}, ConfigError) << address;
}

}  // namespace
}  // namespace livecap
