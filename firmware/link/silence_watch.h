#pragma once

#include <cstdint>

#include "firmware/core/parameter.h"

namespace armada {

/// Tells a sender that has died from one whose messages get lost now and then: silence counts once it is
/// longer than the losses of this very link make likely.
class SilenceWatch {
 public:
  struct Config {
    int messages = 7;
    double chance = 1e-9;
    double memory = 50.0;
    double loss_max = 0.9;
    double first_s = 1.0;

    void Visit(ParameterVisitor& parameter) {
      parameter({"messages", "", 2, 1000,
                 "messages of a sender that have to be missing before it counts as silent, on a link without "
                 "losses"},
                messages);
      parameter({"chance", "", 1e-15, 0.1,
                 "and as many more as it takes for its losses to explain that with less than this chance"},
                chance);
      parameter({"memory", "messages", 1, 1e6, "number over which the losses of a link are averaged"},
                memory);
      parameter({"loss_max", "", 0, 0.99, "largest share of losses that is believed; above it is no link"},
                loss_max);
      parameter(
          {"first_s", "s", 0.01, 1e6,
           "time for which a board waits for a neighbour's first message, and then for its second, before it "
           "holds it silent"},
          first_s);
    }
  };

  /// The board listens from `start_ns` on.
  SilenceWatch(const Config& config, int64_t start_ns)
      : config_(config), arrival_ns_(start_ns), allowed_(config.messages) {}

  /// A message that was taken as new. Its sequence and stamp are the sender's, of which the differences tell
  /// what was lost and how often it sends.
  void OnMessage(int64_t sequence, int64_t stamp_ns, int64_t arrival_ns);

  bool IsSilent(int64_t now_ns) const {
    const double silent_s = 1e-9 * static_cast<double>(now_ns - arrival_ns_);
    return silent_s > (period_s_ > 0.0 ? allowed_ * period_s_ : config_.first_s);
  }

  /// Of the last message; 0 before the first.
  int64_t sequence() const { return sequence_; }

 private:
  Config config_;
  bool heard_ = false;
  int64_t sequence_ = 0;
  int64_t stamp_ns_ = 0;
  int64_t arrival_ns_;     ///< of the last message; before the first, the start
  double period_s_ = 0.0;  ///< of the sender; 0 until two messages have come
  double loss_ = 0.0;      ///< share of messages lost, of late
  double allowed_;         ///< missing messages that are not yet silence
};

}  // namespace armada
