#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/app/bus_watch.h"
#include "firmware/app/fleet.h"
#include "firmware/app/joint_set.h"
#include "firmware/app/neighbourhood.h"
#include "firmware/app/operator_desk.h"
#include "firmware/core/arm_controller.h"
#include "firmware/link/channels.h"
#include "firmware/link/lcm_message.h"
#include "firmware/link/messages.h"
#include "firmware/link/seal.h"

namespace armada {

/// How a board starts.
struct BoardStart {
  StartMode mode = StartMode::kMonitor;
  int64_t fleet_digest = 0;              ///< of its fleet file, see FleetDigest
  std::optional<LinkIdentity> identity;  ///< with one every message is sealed, and none believed without
};

/// One arm's board without its sockets and its clock: CAN frames and LCM messages in, frames and messages
/// out. The process and the simulation run the same object. It allocates in the constructor only. Times are
/// nanoseconds of the board's monotonic clock; the fleet's time 0 is `epoch_ns`.
class ArmNode {
 public:
  ArmNode(const FleetConfig& fleet, size_t index, const ArmInitialState& initial, int64_t epoch_ns,
          const BoardStart& start);

  /// Emulation only, before the first tick, once a period: brings the drives into torque mode. True once all
  /// are.
  bool BringUp(int64_t now_ns, FrameList* out);
  /// What keeps drives from torque mode, for people; empty when all are.
  std::string ExplainDrives() const { return joints_.Explain(); }

  /// Each tick, in this order:
  /// 1. publish what neighbours use, the estimate valid at this tick;
  std::span<const uint8_t> EncodeEstimate(int64_t tick_ns, MessageBuffer* buffer);
  /// 2. ask the joints for samples, and take the answers until complete or out of time;
  void RequestSamples(int64_t now_ns, FrameList* out);
  Reception OnFrame(const CanFrame& frame) { return joints_.OnFrame(frame); }
  bool SamplesComplete() const { return joints_.SamplesComplete(); }
  /// 3. take what neighbours and operators sent;
  void OnMessage(const LcmMessage& message);
  /// 4. compute and send torques;
  void Step(int64_t tick_ns, FrameList* out);
  /// 5. answer the operator: empty when there is nothing to say.
  std::span<const uint8_t> EncodeReply(int64_t tick_ns, MessageBuffer* buffer);

  /// What the bus said, and how the tick went; for the supervisor of the next tick.
  BusWatch& bus_watch() { return bus_watch_; }

  /// What the tick did, for people; the process adds its own timing.
  void FillTelemetry(telemetry_t* telemetry);
  std::span<const uint8_t> EncodeTelemetry(const telemetry_t& telemetry, MessageBuffer* buffer);

  /// The end of a run: drives go to rest in their own way.
  void Disable(FrameList* out) { joints_.Disable(out); }

  ControllerState state() const { return controller_.state(); }
  Cause cause() const { return controller_.supervisor().cause(); }
  int id() const { return id_; }
  std::string_view estimate_channel() const { return estimate_channel_; }
  std::string_view telemetry_channel() const { return telemetry_channel_; }
  std::string_view reply_channel() const { return reply_channel_; }
  const ArmController& controller() const { return controller_; }
  const RejectedMessages& rejected_messages() const { return neighbourhood_.rejected(); }
  std::vector<HeardSender> heard_senders() const { return neighbourhood_.heard(); }
  /// Messages of a neighbour or of an operator that were dropped.
  int64_t rejected_count() const { return neighbourhood_.rejected().total() + desk_.rejected(); }
  /// Frames of a drive that no drive of its kind would send.
  int64_t malformed_frames() const { return joints_.malformed_frames(); }

 private:
  void HearOthers(int64_t tick_ns);
  void ReadJoints(int64_t tick_ns, FrameList* out);
  void Act(ControllerState before, int64_t tick_ns, FrameList* out);
  void StopDrives(ControllerState before, int64_t tick_ns, FrameList* out);

  int id_;
  ArmChannel estimate_channel_;
  ArmChannel telemetry_channel_;
  ArmChannel reply_channel_;
  int64_t epoch_ns_;
  int64_t fleet_digest_;
  bool hold_with_neighbours_;
  int good_ticks_needed_;
  double quick_stop_s_;
  JointSet joints_;
  Neighbourhood neighbourhood_;
  OperatorDesk desk_;
  BusWatch bus_watch_;
  std::optional<Sealer> sealer_;
  ArmController controller_;
  ArmInput input_;
  int neighbours_good_ticks_ = 0;
  int64_t fault_ns_ = 0;
  bool was_at_rest_ = false;  ///< when the fault came
  int64_t estimate_age_max_ns_;
  bool estimate_counts_;  ///< it may be passed on as news of the leader
  int64_t estimate_sequence_ = 0;
  int64_t telemetry_sequence_ = 0;
};

}  // namespace armada
