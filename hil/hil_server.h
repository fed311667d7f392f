#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/app/duration_histogram.h"
#include "firmware/can/bus.h"
#include "hil/can_log.h"
#include "hil/emulated_arm.h"
#include "hil/hil_clock.h"
#include "hil/leader_path.h"
#include "hil/live_faults.h"
#include "hil/tracking_record.h"

namespace armada {

/// How a run ended.
enum class HilEnd { kDone, kStopped, kBusDown };

/// What one arm did.
struct HilArmResult {
  int id = 0;
  std::string bus;
  bool bus_down = false;
  bool diverged = false;
  std::optional<double> released_s;  ///< when the brakes opened; never without every drive in torque mode
  std::vector<DrivePower> drives;    ///< in the order of the joints
  /// None in a leaderless scenario: there is nothing to measure against.
  std::optional<TrackingRecord> record;
  BusCounters counters;
  double bus_load = 0.0;  ///< share of the time since the epoch that its frames take on the wire at worst
};

/// The fleet's arms and drives in real time, on their buses, in one thread. An arm's time goes on with the
/// frames that come in, each taken at its time of reception, and with the milliseconds of the fleet's clock,
/// in each of which its error is sampled. A server that wakes late therefore computes the motion it would
/// have computed in time, sample for sample; only its answers are late, and pacing() tells by how much.
/// Allocates in the constructor only, and for a fault that comes while it runs.
class HilServer {
 public:
  /// Switches the benches on, now. `buses`, one an arm in the fleet's order, and `logs`, as many or none,
  /// outlive the object. The fleet's time 0 is `epoch_ns`. @pre now <= epoch_ns
  HilServer(const ScenarioConfig& scenario, uint64_t seed, int64_t epoch_ns,
            const std::vector<std::unique_ptr<CanBus>>& buses, const std::vector<CanLog*>& logs,
            HilClock* clock);
  HilServer(const HilServer&) = delete;
  HilServer& operator=(const HilServer&) = delete;

  /// Takes faults while it runs from `live`, which outlives the object.
  void TakeFaultsFrom(LiveFaults* live) { live_ = live; }

  /// Runs until `seconds` after the epoch, or until the clock says that the run is to end.
  HilEnd Run(double seconds);

  std::vector<HilArmResult> Results() const;
  /// Fleet time up to which every arm has come, s.
  double time_s() const;
  /// How late each millisecond of the fleet's clock was served.
  const DurationHistogram& pacing() const { return pacing_; }
  /// Fleet time of the millisecond that was served the latest, s.
  double latest_at_s() const { return FleetTime(latest_ns_); }
  /// Faults that came while it ran.
  const std::vector<FaultConfig>& faults_taken() const { return faults_taken_; }

 private:
  struct Arm {
    int id;
    std::string bus_name;
    CanBus* bus;
    CanLog* log;  ///< may be null
    EmulatedArm bench;
    TrackingRecord record;
    CanBusConfig can;
    int64_t time_ns;  ///< of the bench
    int64_t next_tick_ns;
    std::optional<double> released_s;
    bool bus_down = false;
    double on_wire_s = 0.0;  ///< of all frames since the epoch
  };

  double FleetTime(int64_t t_ns) const { return static_cast<double>(t_ns - epoch_ns_) / 1e9; }
  void TakeLiveFaults(int64_t now_ns);
  void Pace(int64_t now_ns, int64_t until_ns);
  void TakeFrames(Arm& arm, int64_t end_ns);
  /// Goes through every millisecond on the way.
  void AdvanceTo(Arm& arm, int64_t t_ns);
  void MoveBench(Arm& arm, int64_t t_ns);
  void Sample(Arm& arm);
  /// A frame was on the arm's bus.
  void Note(Arm& arm, int64_t t_ns, const CanFrame& frame) const;

  int64_t epoch_ns_;
  HilClock* clock_;
  LiveFaults* live_ = nullptr;
  std::optional<LeaderPath> leader_;
  std::vector<Arm> arms_;
  int64_t next_tick_ns_;
  DurationHistogram pacing_;
  int64_t latest_ns_ = 0;
  std::vector<FaultConfig> faults_taken_;
  FrameList out_;
};

}  // namespace armada
