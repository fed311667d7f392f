#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "firmware/link/lcm_endpoint.h"

namespace armada {

/// A message that was sent or has come, kept.
struct Message {
  std::string channel;
  std::vector<uint8_t> payload;
  bool operator==(const Message&) const = default;
};

/// An endpoint of the default network; fails the test when there is none.
std::unique_ptr<LcmEndpoint> OpenEndpoint();

/// Waits until a datagram is there to be read; fails the test after a time that only a broken link needs.
void WaitForInput(const LcmEndpoint& endpoint);

/// The next `count` messages; fewer, and a failed test, when they do not come.
std::vector<Message> DrainMessages(LcmEndpoint* endpoint, size_t count);

/// Sends any bytes to the default network's group.
class RawSender {
 public:
  RawSender();
  RawSender(const RawSender&) = delete;
  RawSender& operator=(const RawSender&) = delete;
  ~RawSender();
  void Send(std::span<const uint8_t> datagram) const;

 private:
  int socket_;
};

/// Takes the loopback interface of this thread's network down, and with it the route for multicast.
void TakeLoopbackDown();

}  // namespace armada
