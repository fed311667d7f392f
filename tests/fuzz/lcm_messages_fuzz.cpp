#include <algorithm>
#include <cmath>

#include "firmware/core/supervisor.h"
#include "firmware/link/messages.h"
#include "tests/fuzz/require.h"

namespace armada {
namespace {

void RequireMeaning(const auto& message) {
  for (const double value : message.x_m) Require(std::isfinite(value), "positions are finite");
}
void RequireMeaning(const command_t& message) {
  Require(message.request > 0 && message.request < kRequests, "a request that there is");
}
void RequireMeaning(const reply_t& message) {
  Require(message.request > 0 && message.request < kRequests, "a request that there is");
}

template <class Message>
void TestMessage(std::span<const uint8_t> payload) {
  Message message;
  if (!Decode(payload, &message)) return;
  Require(message.stamp_ns >= 0 && message.stamp_ns <= kMaxStampNs, "a stamp in its range");
  Require(message.sequence >= 1, "messages count from 1");
  RequireMeaning(message);
  MessageBuffer buffer;
  const std::span<const uint8_t> again = Encode(message, &buffer);
  Require(std::equal(payload.begin(), payload.end(), again.begin(), again.end()),
          "encoding what was decoded gives the same bytes");
}

}  // namespace
}  // namespace armada

/// Payloads of LCM messages: every type is tried on them all, as the fingerprint tells them apart.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace armada;
  TestMessage<leader_t>({data, size});
  TestMessage<estimate_t>({data, size});
  TestMessage<telemetry_t>({data, size});
  TestMessage<command_t>({data, size});
  TestMessage<reply_t>({data, size});
  return 0;
}
