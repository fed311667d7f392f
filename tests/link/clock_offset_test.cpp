#include "firmware/link/clock_offset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/numbers.h"

namespace armada {
namespace {

constexpr int64_t kS = 1'000'000'000;
constexpr double kWire_s = 80e-6;

// A sender at 100 Hz whose clock is `offset_s` off ours and `drift` fast, behind a wire that takes kWire_s
// and a random delay more (exponential). Time is ours; starts well above zero so that both clocks stay
// positive.
class Sender {
 public:
  struct Config {
    double offset_s = 0.0;
    double drift = 0.0;
    double jitter_s = 0.0;
  };

  Sender(const Config& config, uint64_t seed) : config_(config), random_(seed) {}

  // The next message; `*true_age_s` is its age at arrival.
  MessageTime Send(double* true_age_s) {
    sent_s_ += 0.01;
    ++sequence_;
    const double uniform = static_cast<double>(random_() >> 11) * 0x1p-53;
    *true_age_s = kWire_s - config_.jitter_s * std::log1p(-uniform);
    const double stamp_s = kStart_s + config_.offset_s + sent_s_ * (1.0 + config_.drift);
    return {sequence_, Ns(stamp_s), Ns(kStart_s + sent_s_ + *true_age_s)};
  }

 private:
  static constexpr double kStart_s = 100'000.0;
  static int64_t Ns(double seconds) { return std::llround(seconds * 1e9); }

  Config config_;
  std::mt19937_64 random_;
  int64_t sequence_ = 0;
  double sent_s_ = 0.0;
};

struct AgeError {
  double min_s = 1e9;
  double max_s = -1e9;
};

// Errors of the age at arrival over two minutes, the first two windows left out.
AgeError RunSender(const Sender::Config& config, uint64_t seed) {
  ClockOffset::Config clock_config;
  clock_config.wire_time_s = kWire_s;
  ClockOffset clock(clock_config);
  Sender sender(config, seed);
  AgeError error;
  for (int i = 0; i < 12'000; ++i) {
    double true_age_s = 0.0;
    const MessageTime message = sender.Send(&true_age_s);
    EXPECT_NE(clock.Update(message), Freshness::kStale);
    if (i < 400) continue;
    const double error_s = clock.AgeS(message.stamp_ns, message.arrival_ns) - true_age_s;
    error.min_s = std::min(error.min_s, error_s);
    error.max_s = std::max(error.max_s, error_s);
  }
  return error;
}

TEST(ClockOffset, GivesExactAgesWithoutJitterWhateverTheOffset) {
  for (const double offset_s : {-99'000.0, -1e-3, 0.0, 0.5, 1e6}) {
    const AgeError error = RunSender({offset_s, 0.0, 0.0}, 1);
    EXPECT_NEAR(error.min_s, 0.0, 1e-6) << offset_s;
    EXPECT_NEAR(error.max_s, 0.0, 1e-6) << offset_s;
  }
}

TEST(ClockOffset, SeesThroughJitter) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const AgeError error = RunSender({123.4, 0.0, 500e-6}, seed);
    EXPECT_GT(error.min_s, -50e-6) << seed;
    EXPECT_LT(error.max_s, 1e-6) << seed;
  }
}

TEST(ClockOffset, FollowsClocksThatDriftApartEitherWay) {
  const double lag_s = 2.0 * 50e-6 * ClockOffset::Config().window_s;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    for (const double drift : {-50e-6, 50e-6}) {
      for (const double jitter_s : {0.0, 500e-6}) {
        const AgeError error = RunSender({-7.0, drift, jitter_s}, seed);
        EXPECT_GT(error.min_s, -80e-6) << seed << ' ' << drift << ' ' << jitter_s;
        EXPECT_LT(error.max_s, lag_s + 1e-6) << seed << ' ' << drift << ' ' << jitter_s;
      }
    }
  }
}

TEST(ClockOffset, LetsAgeGrowWhileNothingComes) {
  ClockOffset clock{ClockOffset::Config{.wire_time_s = 0.0}};
  EXPECT_EQ(clock.AgeS(0, kS), std::numeric_limits<double>::infinity());
  clock.Update({1, 5 * kS, 100 * kS});
  EXPECT_DOUBLE_EQ(clock.AgeS(5 * kS, 100 * kS), 0.0);
  EXPECT_DOUBLE_EQ(clock.AgeS(5 * kS, 107 * kS), 7.0);
}

TEST(ClockOffset, AddsTheWireTimeEvenWhenStampsAreAhead) {
  for (const double wire_time_s : {-0.007, 0.0, 0.003}) {
    ClockOffset clock{ClockOffset::Config{.wire_time_s = wire_time_s}};
    clock.Update({1, 5 * kS, 100 * kS});
    EXPECT_DOUBLE_EQ(clock.AgeS(5 * kS, 100 * kS), wire_time_s);
  }
}

TEST(ClockOffset, ForgetsAnEarlyArrivalAfterTwoWindows) {
  ClockOffset clock{ClockOffset::Config{.window_s = 1.0, .wire_time_s = 0.0}};
  clock.Update({1, 0, kS});  // 30 ms earlier than all that follow
  double age_s = 0.0;
  for (int64_t i = 1; i <= 210; ++i) {
    const int64_t stamp_ns = 10 * i * kMs;
    const int64_t arrival_ns = stamp_ns + kS + 30 * kMs;
    ASSERT_EQ(clock.Update({i + 1, stamp_ns, arrival_ns}), Freshness::kNew);
    age_s = clock.AgeS(stamp_ns, arrival_ns);
    if (i < 90) {
      EXPECT_DOUBLE_EQ(age_s, 0.03) << i;
    }
  }
  EXPECT_DOUBLE_EQ(age_s, 0.0);
}

TEST(ClockOffset, DoesNotUseAWindowFromBeforeALongSilence) {
  ClockOffset clock{ClockOffset::Config{.window_s = 1.0, .wire_time_s = 0.0}};
  clock.Update({1, 0, kS});
  ASSERT_EQ(clock.Update({2, 10 * kS, 11 * kS + 5 * kMs}), Freshness::kNew);
  EXPECT_DOUBLE_EQ(clock.AgeS(10 * kS, 11 * kS + 5 * kMs), 0.0);
}

// A clock that has heard messages 1 to 100 at 100 Hz, stamped 1 s behind ours.
ClockOffset HeardHundred() {
  ClockOffset clock{ClockOffset::Config{}};
  for (int64_t i = 1; i <= 100; ++i) clock.Update({i, 10 * i * kMs, 10 * i * kMs + kS});
  return clock;
}
constexpr int64_t kLastArrival = 2 * kS;

TEST(ClockOffset, DropsLateRepeatedAndReplayedMessages) {
  for (const int64_t sequence : {1, 50, 99, 100}) {
    ClockOffset clock = HeardHundred();
    const double age_s = clock.AgeS(kS, kLastArrival);
    EXPECT_EQ(clock.Update({sequence, 10 * sequence * kMs, kLastArrival + 5 * kMs}), Freshness::kStale);
    EXPECT_EQ(clock.AgeS(kS, kLastArrival), age_s);
  }
}

TEST(ClockOffset, DropsMessagesThatAreNewerInOnlyOneRespect) {
  ClockOffset clock = HeardHundred();
  EXPECT_EQ(clock.Update({101, kS, kLastArrival + kMs}), Freshness::kStale);
  EXPECT_EQ(clock.Update({100, kS + 10 * kMs, kLastArrival + kMs}), Freshness::kStale);
}

TEST(ClockOffset, IsNotRestartedByReplayWhileTheSenderLives) {
  ClockOffset clock = HeardHundred();
  for (int64_t i = 101; i <= 1000; ++i) {
    const int64_t arrival_ns = 10 * i * kMs + kS;
    ASSERT_EQ(clock.Update({i, 10 * i * kMs, arrival_ns}), Freshness::kNew);
    ASSERT_EQ(clock.Update({i - 90, 10 * (i - 90) * kMs, arrival_ns + kMs}), Freshness::kStale);
  }
}

TEST(ClockOffset, StartsAfreshWhenASilentSenderCountsAnew) {
  ClockOffset clock{ClockOffset::Config{.wire_time_s = 0.0}};
  clock.Update({100, 900 * kS, 100 * kS});
  // Rebooted: its clock begins at zero.
  EXPECT_EQ(clock.Update({1, 2 * kS, 130 * kS}), Freshness::kRestarted);
  EXPECT_DOUBLE_EQ(clock.AgeS(2 * kS, 130 * kS), 0.0);
  // The process was started again: its clock runs on, its count does not.
  EXPECT_EQ(clock.Update({5, 3 * kS, 131 * kS}), Freshness::kNew);
  EXPECT_EQ(clock.Update({1, 4 * kS, 132 * kS}), Freshness::kRestarted);
  EXPECT_EQ(clock.Update({2, 4 * kS + 10 * kMs, 132 * kS + 10 * kMs}), Freshness::kNew);
}

TEST(ClockOffset, RecoversFromAClockSetBackWithinTheSilenceTime) {
  ClockOffset clock = HeardHundred();
  Freshness freshness = Freshness::kStale;
  int64_t arrival_ns = kLastArrival;
  for (int64_t i = 101; i <= 105; ++i) {  // 50 ms
    EXPECT_EQ(freshness, Freshness::kStale);
    arrival_ns += 10 * kMs;
    freshness = clock.Update({i, 10 * i * kMs - kS, arrival_ns});
  }
  EXPECT_EQ(freshness, Freshness::kRestarted);
  EXPECT_DOUBLE_EQ(clock.AgeS(50 * kMs, arrival_ns), ClockOffset::Config().wire_time_s);
}

}  // namespace
}  // namespace armada
