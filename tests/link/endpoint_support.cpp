#include "tests/link/endpoint_support.h"

#include <arpa/inet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>

#include "firmware/clock/machine_clock.h"

namespace armada {
namespace {

constexpr int kPatience_ms = 10'000;

bool HasInput(const LcmEndpoint& endpoint, int timeout_ms) {
  pollfd waiting{endpoint.descriptor(), POLLIN, 0};
  return poll(&waiting, 1, timeout_ms) == 1;
}

}  // namespace

std::unique_ptr<LcmEndpoint> OpenEndpoint() {
  std::string error;
  auto endpoint = LcmEndpoint::Open(LcmUrl(), MachineClock::Get(), &error);
  EXPECT_NE(endpoint, nullptr) << error;
  return endpoint;
}

void WaitForInput(const LcmEndpoint& endpoint) {
  EXPECT_TRUE(HasInput(endpoint, kPatience_ms)) << "no message came";
}

std::vector<Message> DrainMessages(LcmEndpoint* endpoint, size_t count) {
  std::vector<Message> messages;
  while (messages.size() < count && HasInput(*endpoint, kPatience_ms)) {
    endpoint->Drain([&](const LcmMessage& message) {
      messages.push_back({std::string(message.channel), {message.payload.begin(), message.payload.end()}});
    });
  }
  EXPECT_EQ(messages.size(), count) << "messages are missing";
  return messages;
}

RawSender::RawSender() : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
  const int ttl = 0;
  EXPECT_EQ(setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof(ttl)), 0);
}

RawSender::~RawSender() {
  close(socket_);
}

void RawSender::Send(std::span<const uint8_t> datagram) const {
  const LcmUrl url;
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(url.port);
  inet_pton(AF_INET, url.group.c_str(), &group.sin_addr);
  EXPECT_EQ(sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<sockaddr*>(&group),
                   sizeof(group)),
            static_cast<ssize_t>(datagram.size()));
}

void TakeLoopbackDown() {
  const int control = socket(AF_INET, SOCK_DGRAM, 0);
  ifreq interface {};
  std::memcpy(interface.ifr_name, "lo", sizeof("lo"));
  EXPECT_EQ(ioctl(control, SIOCSIFFLAGS, &interface), 0);
  close(control);
}

}  // namespace armada
