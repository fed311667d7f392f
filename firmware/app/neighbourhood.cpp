#include "firmware/app/neighbourhood.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/link/channels.h"
#include "firmware/link/messages.h"

namespace armada {
namespace {

constexpr int kLeader = kLeaderSender;

double Seconds(int64_t duration_ns) {
  return 1e-9 * static_cast<double>(duration_ns);
}

TaskVector ToTask(const double (&from)[3]) {
  TaskVector to(PlanarArm::kTaskDim);
  std::copy(from, from + PlanarArm::kTaskDim, to.data());
  return to;
}

}  // namespace

Neighbourhood::Neighbourhood(const FleetConfig& fleet, int arm_id, int64_t epoch_ns,
                             const std::optional<LinkIdentity>& identity, int64_t fleet_digest)
    : link_(fleet.link),
      estimator_(fleet.estimator),
      schedule_(fleet.Schedule()),
      epoch_ns_(epoch_ns),
      fleet_digest_(fleet_digest) {
  for (size_t topology = 0; topology < fleet.topologies.size(); ++topology) {
    for (const Pin& pin : fleet.topologies[topology].pins) {
      if (pin.arm == arm_id) ListenTo(fleet, kLeader, topology, pin.weight, identity);
    }
    for (const Edge& edge : fleet.topologies[topology].edges) {
      if (edge.to == arm_id) ListenTo(fleet, edge.from, topology, edge.weight, identity);
    }
  }
}

void Neighbourhood::ListenTo(const FleetConfig& fleet, int arm_id, size_t topology, double weight,
                             const std::optional<LinkIdentity>& identity) {
  auto source =
      std::find_if(sources_.begin(), sources_.end(), [&](const Source& s) { return s.arm_id == arm_id; });
  if (source == sources_.end()) {
    sources_.push_back({.arm_id = arm_id,
                        .seal = std::nullopt,
                        .clock = ClockOffset(fleet.link.clock),
                        .silence = SilenceWatch(fleet.link.silence, epoch_ns_)});
    source = sources_.end() - 1;
    if (identity) source->seal.emplace(identity->key, arm_id);
  }
  source->weight[topology] = weight;
}

bool Neighbourhood::Hears(const Source& source, std::string_view channel) {
  return source.arm_id == kLeader ? channel == kLeaderChannel
                                  : ParseArmChannel(kEstimatePrefix, channel) == source.arm_id;
}

void Neighbourhood::OnMessage(const LcmMessage& message) {
  const auto source = std::find_if(sources_.begin(), sources_.end(),
                                   [&](const Source& s) { return Hears(s, message.channel); });
  if (source == sources_.end()) return;
  LcmMessage unsealed = message;
  if (!Unseal(*source, message.channel, &unsealed.payload)) return;
  const bool understood =
      source->arm_id == kLeader ? TakeLeader(*source, unsealed) : TakeEstimate(*source, unsealed);
  if (!understood) ++rejected_.malformed;
}

bool Neighbourhood::Unseal(Source& source, std::string_view channel, std::span<const uint8_t>* message) {
  if (!source.seal) return true;
  const SealVerdict verdict = source.seal->Open(channel, message);
  if (verdict == SealVerdict::kForged) ++rejected_.forged;
  if (verdict == SealVerdict::kReplayed) ++rejected_.replayed;
  return verdict == SealVerdict::kGenuine;
}

// False when it is no message of ours; of those that are, the newest counts.
bool Neighbourhood::TakeLeader(Source& source, const LcmMessage& message) {
  leader_t leader;
  if (!Decode(message.payload, &leader) || leader.task_dim != PlanarArm::kTaskDim) return false;
  if (Take(source, leader, message.arrival_ns)) {
    source.neighbour.agreement = Estimator::kMaxAgreement;
    source.fleet_digest = fleet_digest_;  // the leader has no part in it
  }
  return true;
}

bool Neighbourhood::TakeEstimate(Source& source, const LcmMessage& message) {
  estimate_t estimate;
  if (!Decode(message.payload, &estimate) || estimate.task_dim != PlanarArm::kTaskDim ||
      estimate.arm_id != source.arm_id) {
    return false;
  }
  if (Take(source, estimate, message.arrival_ns)) {
    source.neighbour.agreement = estimate.agreement;
    source.neighbour.stopped = estimate.stopped != 0;
    source.fleet_digest = estimate.fleet_digest;
    source.leader_age_s = estimate.leader_age_s >= 0.0f ? double{estimate.leader_age_s}
                                                        : std::numeric_limits<double>::infinity();
  }
  return true;
}

template <class Message>
bool Neighbourhood::Take(Source& source, const Message& message, int64_t arrival_ns) {
  if (source.clock.Update({message.sequence, message.stamp_ns, arrival_ns}) == Freshness::kStale) {
    ++rejected_.stale;
    return false;
  }
  if (AgeOf(source, message.stamp_ns, arrival_ns) > link_.age_max_s) {
    ++rejected_.late;
    return false;
  }
  const Zeta zeta{ToTask(message.x_m), ToTask(message.v_m_s), ToTask(message.a_m_s2)};
  if (!IsPlausible(source, zeta, message.stamp_ns)) {
    ++rejected_.implausible;
    return false;
  }
  // A sender that starts anew counts from 1 again, and misses nothing by that.
  if (source.accepted > 0)
    source.missed += std::max<int64_t>(0, message.sequence - source.silence.sequence() - 1);
  ++source.accepted;
  source.stamp_ns = message.stamp_ns;
  source.neighbour.zeta = zeta;
  source.neighbour.jerk_m_s3 = ToTask(message.jerk_m_s3);
  source.neighbour.heard = true;
  source.silence.OnMessage(message.sequence, message.stamp_ns, arrival_ns);
  return true;
}

// Whether a state can follow the sender's last one. A leader within (A2), and (1.9) while it is in contact,
// leave a prediction by no more than beta over the time; after a time without news (1.9) makes up for that
// time, too. Once the last state is so old that the sender has been given up, or of a former life, any is
// taken: what goes on being impossible is a leader lost, not one that has moved.
bool Neighbourhood::IsPlausible(const Source& source, const Zeta& zeta, int64_t stamp_ns) const {
  if (estimator_.kind != EstimatorKind::kPredictive || !source.neighbour.heard) return true;
  const double since_s = Seconds(stamp_ns - source.stamp_ns);
  if (since_s <= 0.0 || since_s > estimator_.age_max_s) return true;
  const Zeta expected = Taylor(source.neighbour.zeta, since_s);
  const double allowed_s =
      link_.plausible_step * (since_s + std::min(source.leader_age_s, estimator_.age_max_s));
  const auto near = [&](const TaskVector& given, const TaskVector& predicted, double beta) {
    return (given - predicted).lpNorm<Eigen::Infinity>() <= beta * allowed_s;
  };
  return near(zeta.x_m, expected.x_m, estimator_.beta_1_m_s) &&
         near(zeta.v_m_s, expected.v_m_s, estimator_.beta_2_m_s2) &&
         near(zeta.a_m_s2, expected.a_m_s2, estimator_.beta_3_m_s3);
}

double Neighbourhood::AgeOf(const Source& source, int64_t stamp_ns, int64_t now_ns) const {
  return link_.shared_clock ? Seconds(now_ns - stamp_ns) : source.clock.AgeS(stamp_ns, now_ns);
}

size_t Neighbourhood::TopologyAt(int64_t tick_ns) const {
  return schedule_.At(Seconds(tick_ns - epoch_ns_));
}

void Neighbourhood::ReadAt(int64_t tick_ns, Neighbours* neighbours) const {
  const size_t topology = TopologyAt(tick_ns);
  neighbours->switching = schedule_.count > 1;
  neighbours->count = static_cast<int>(sources_.size());
  for (size_t i = 0; i < sources_.size(); ++i) {
    const Source& source = sources_[i];
    Neighbour& neighbour = neighbours->list[i];
    neighbour = source.neighbour;
    neighbour.weight = source.weight[topology];
    neighbour.silent = source.silence.IsSilent(tick_ns);
    if (!neighbour.heard) continue;
    neighbour.age_s = AgeOf(source, source.stamp_ns, tick_ns);
    neighbour.leader_age_s = source.leader_age_s + neighbour.age_s;
  }
}

std::vector<HeardSender> Neighbourhood::heard() const {
  std::vector<HeardSender> heard;
  for (const Source& source : sources_) heard.push_back({source.arm_id, source.accepted, source.missed});
  return heard;
}

bool Neighbourhood::AllGood(int64_t tick_ns) const {
  const size_t topology = TopologyAt(tick_ns);
  return std::all_of(sources_.begin(), sources_.end(), [&](const Source& source) {
    const bool good =
        source.neighbour.heard && !source.silence.IsSilent(tick_ns) && source.fleet_digest == fleet_digest_;
    return good || source.weight[topology] <= 0.0;
  });
}

}  // namespace armada
