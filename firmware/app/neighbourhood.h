#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "firmware/app/fleet.h"
#include "firmware/link/clock_offset.h"
#include "firmware/link/lcm_message.h"
#include "firmware/link/seal.h"
#include "firmware/link/silence_watch.h"

namespace armada {

/// Messages of nodes that this one listens to, and that were dropped.
struct RejectedMessages {
  int64_t malformed = 0;    ///< no message of this type, or of another task
  int64_t forged = 0;       ///< without the sender's seal, in a fleet with a key
  int64_t replayed = 0;     ///< sealed, but not newer than the last one of the sender
  int64_t stale = 0;        ///< sequence or stamp not newer than the last one of the sender
  int64_t late = 0;         ///< older than link.age_max_s when it came
  int64_t implausible = 0;  ///< a state that cannot follow the sender's last one

  int64_t total() const { return malformed + forged + replayed + stale + late + implausible; }
};

/// What has come of a sender that a board listens to.
struct HeardSender {
  int arm_id = 0;        ///< 0: the leader
  int64_t accepted = 0;  ///< messages
  int64_t missed = 0;    ///< gaps between them, by the sender's own count
};

/// What one board hears of the leader and of the arms that it listens to, in any of the topologies. Allocates
/// in the constructor only.
class Neighbourhood {
 public:
  Neighbourhood(const FleetConfig& fleet, int arm_id, int64_t epoch_ns,
                const std::optional<LinkIdentity>& identity, int64_t fleet_digest);

  /// Takes what is a genuine, new and plausible message of one of them, counts what is not, and ignores what
  /// is of others.
  void OnMessage(const LcmMessage& message);

  /// All of them as they are at a tick, for (1.9).
  void ReadAt(int64_t tick_ns, Neighbours* neighbours) const;

  /// Each that is used at the tick is heard, not silent, and has this board's fleet file.
  bool AllGood(int64_t tick_ns) const;

  const RejectedMessages& rejected() const { return rejected_; }
  /// Allocates: for the report of a run.
  std::vector<HeardSender> heard() const;

 private:
  struct Source {
    int arm_id = 0;  ///< 0: the leader
    std::optional<SealCheck> seal;
    ClockOffset clock;
    SilenceWatch silence;
    int64_t stamp_ns = 0;
    int64_t accepted = 0;
    int64_t missed = 0;
    Neighbour neighbour{};
    double leader_age_s = 0.0;  ///< as sent; infinite when the sender knows of no leader
    int64_t fleet_digest = 0;
    std::array<double, TopologySchedule::kMaxCount> weight{};  ///< by topology
  };

  void ListenTo(const FleetConfig& fleet, int arm_id, size_t topology, double weight,
                const std::optional<LinkIdentity>& identity);
  static bool Hears(const Source& source, std::string_view channel);
  /// Without its seal, if it is genuine; counts it otherwise.
  bool Unseal(Source& source, std::string_view channel, std::span<const uint8_t>* message);
  template <class Message>
  bool Take(Source& source, const Message& message, int64_t arrival_ns);
  bool IsPlausible(const Source& source, const Zeta& zeta, int64_t stamp_ns) const;
  bool TakeLeader(Source& source, const LcmMessage& message);
  bool TakeEstimate(Source& source, const LcmMessage& message);
  double AgeOf(const Source& source, int64_t stamp_ns, int64_t now_ns) const;
  size_t TopologyAt(int64_t tick_ns) const;

  LcmLinkConfig link_;
  EstimatorConfig estimator_;
  TopologySchedule schedule_;
  int64_t epoch_ns_;
  int64_t fleet_digest_;
  std::vector<Source> sources_;
  RejectedMessages rejected_;
};

}  // namespace armada
