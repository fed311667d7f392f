#include <fcntl.h>
#include <gtest/gtest.h>
#include <lcm/eventlog.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <lcm/lcm-cpp.hpp>

#include <csignal>
#include <filesystem>

#include "firmware/link/channels.h"
#include "firmware/link/messages.h"
#include "tests/link/endpoint_support.h"
#include "tests/link/golden_messages.h"
#include "tests/link/private_network_fixture.h"

namespace armada {
namespace {

constexpr int kPeerPatience_ms = 20'000;

class LcmInterop : public PrivateNetworkTest {
 protected:
  static std::vector<uint8_t> Bytes(const auto& message) {
    MessageBuffer buffer;
    const auto bytes = Encode(message, &buffer);
    return {bytes.begin(), bytes.end()};
  }

  const std::string url_ = ToString(LcmUrl());
};

using Messages = std::vector<Message>;

TEST_F(LcmInterop, LibLcmReceivesWhatTheEndpointSends) {
  lcm::LCM lcm(url_);
  ASSERT_TRUE(lcm.good());
  Messages heard;
  using Handler = void (*)(const lcm::ReceiveBuffer*, const std::string&, Messages*);
  const Handler keep = [](const lcm::ReceiveBuffer* buffer, const std::string& channel, Messages* messages) {
    const auto* data = static_cast<const uint8_t*>(buffer->data);
    messages->push_back({channel, {data, data + buffer->data_size}});
  };
  lcm.subscribeFunction(".*", keep, &heard);

  const auto endpoint = OpenEndpoint();
  const Messages sent = {{"LEADER", Bytes(GoldenLeader())},
                         {"EST_7", Bytes(GoldenEstimate())},
                         {"TEL_6", Bytes(GoldenTelemetry())},
                         {std::string(63, 'x'), {}}};
  for (const Message& message : sent) ASSERT_TRUE(endpoint->Publish(message.channel, message.payload));
  while (heard.size() < sent.size() && lcm.handleTimeout(kPeerPatience_ms) > 0) {
  }
  EXPECT_EQ(heard, sent);
}

TEST_F(LcmInterop, TheEndpointReceivesWhatLibLcmSends) {
  const auto endpoint = OpenEndpoint();
  lcm::LCM lcm(url_);
  const estimate_t estimate = GoldenEstimate();
  ASSERT_EQ(lcm.publish("EST_7", &estimate), 0);
  const Messages heard = DrainMessages(endpoint.get(), 1);
  EXPECT_EQ(heard, (Messages{{"EST_7", Bytes(estimate)}}));
  estimate_t decoded;
  EXPECT_TRUE(Decode(heard.front().payload, &decoded));
}

TEST_F(LcmInterop, TheEndpointIgnoresLibLcmsLongMessages) {
  const auto endpoint = OpenEndpoint();
  lcm::LCM lcm(url_);
  const std::vector<uint8_t> image(200'000, 1);  // in four fragments, longer than a datagram may be
  ASSERT_EQ(lcm.publish("IMAGE", image.data(), static_cast<unsigned>(image.size())), 0);
  ASSERT_EQ(lcm.publish("A", image.data(), 3), 0);
  EXPECT_EQ(DrainMessages(endpoint.get(), 1), (Messages{{"A", {1, 1, 1}}}));
  EXPECT_GT(endpoint->counters().overflowed + endpoint->counters().malformed, 0U);
  EXPECT_EQ(endpoint->counters().received, 1U);
}

// lcm-logger as a child process that writes to a file of its own.
class Logger {
 public:
  explicit Logger(const std::string& url) {
    std::string folder = ::testing::TempDir() + "armada_lcm_log_XXXXXX";
    folder_ = mkdtemp(folder.data());
    const std::string url_option = "--lcm-url=" + url;
    const std::string file = log();
    const char* arguments[] = {"lcm-logger",       "--quiet",    "--flush-interval=1",
                               url_option.c_str(), file.c_str(), nullptr};
    EXPECT_EQ(
        posix_spawn(&process_, ARMADA_LCM_LOGGER, nullptr, nullptr, const_cast<char**>(arguments), environ),
        0);
  }
  Logger(const Logger&) = delete;
  Logger& operator=(const Logger&) = delete;
  ~Logger() {
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
    std::filesystem::remove_all(folder_);
  }

  // What is in the log file by now.
  Messages Read() const {
    Messages messages;
    lcm_eventlog_t* log_file = lcm_eventlog_create(log().c_str(), "r");
    if (log_file == nullptr) return messages;
    while (lcm_eventlog_event_t* event = lcm_eventlog_read_next_event(log_file)) {
      const auto* data = static_cast<const uint8_t*>(event->data);
      messages.push_back({event->channel, {data, data + event->datalen}});
      lcm_eventlog_free_event(event);
    }
    lcm_eventlog_destroy(log_file);
    return messages;
  }

  // Publishes on `channel` again and again until it is in the log.
  bool HasHeard(const std::string& channel, LcmEndpoint* endpoint) const {
    for (int waited_ms = 0; waited_ms < kPeerPatience_ms; waited_ms += 10) {
      EXPECT_TRUE(endpoint->Publish(channel, {}));
      poll(nullptr, 0, 10);
      for (const Message& message : Read()) {
        if (message.channel == channel) return true;
      }
    }
    return false;
  }

 private:
  std::string log() const { return folder_ + "/lcm.log"; }

  std::string folder_;
  pid_t process_ = -1;
};

TEST_F(LcmInterop, LcmLoggerRecordsWhatTheEndpointSends) {
  const auto endpoint = OpenEndpoint();
  const Logger logger(url_);
  ASSERT_TRUE(logger.HasHeard("BEGIN", endpoint.get()));

  Messages sent;
  for (int8_t id = 1; id <= 7; ++id) {
    estimate_t estimate = GoldenEstimate();
    estimate.arm_id = id;
    sent.push_back({std::string(EstimateChannel(id).view()), Bytes(estimate)});
    ASSERT_TRUE(endpoint->Publish(EstimateChannel(id), sent.back().payload));
  }
  ASSERT_TRUE(logger.HasHeard("END", endpoint.get()));

  Messages recorded = logger.Read();
  std::erase_if(recorded, [](const Message& m) { return m.channel == "BEGIN" || m.channel == "END"; });
  EXPECT_EQ(recorded, sent);
}

}  // namespace
}  // namespace armada
