#pragma once

#include <string>
#include <vector>

#include "firmware/can/can_bus_config.h"
#include "firmware/can/joint_drive_config.h"
#include "firmware/core/arm_controller.h"
#include "firmware/core/graph.h"
#include "firmware/core/parameter.h"
#include "firmware/link/clock_offset.h"
#include "firmware/link/silence_watch.h"

namespace armada {

struct LcmLinkConfig {
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::string key_file = "none";
  bool shared_clock = false;
  double age_max_s = 0.05;
  double plausible_step = 1.5;
  double command_age_max_s = 1.0;
  ClockOffset::Config clock;
  SilenceWatch::Config silence;

  bool has_key() const { return key_file != LcmLinkConfig().key_file; }

  void Visit(ParameterVisitor& parameter) {
    parameter({"lcm_url", "", 0, 0, "LCM multicast group, port and ttl: 0 on one machine, 1 between boards"},
              lcm_url);
    parameter({"key_file", "", 0, 0,
               "file of the fleet's key, relative to this file, or none; with it every message is sealed, "
               "and none is "
               "believed without its seal; needed where ttl is above 0"},
              key_file);
    parameter({"shared_clock", "", 0, 1,
               "all boards read one monotonic clock (one machine, or disciplined): ages need no estimate of "
               "offsets"},
              shared_clock);
    parameter({"age_max_s", "s", 1e-3, 10, "older messages are dropped when they come"}, age_max_s);
    parameter(
        {"plausible_step", "", 1, 1e9,
         "a state is dropped when it is further from what the sender's last one predicts than this many "
         "times what (A2) and (1.9) allow; predictive estimator only, the others chatter by more"},
        plausible_step);
    parameter({"command_age_max_s", "s", 0.05, 10,
               "an operator's command counts while what it quotes of the board is younger"},
              command_age_max_s);
    parameter.Table("clock", clock);
    parameter.Table("silence", silence);
  }
};

/// One arm of the fleet and its board.
struct ArmEntry {
  int id = 0;
  PlanarArmConfig arm;
  std::string bus;  ///< "udp:<group>:<port>" or "socketcan:<interface>"
  CanBusConfig can;
  std::vector<JointDriveConfig> joints;  ///< one a joint, in order
  ControlConfig control;                 ///< the fleet's, with this arm's own values on top; gains expanded
};

/// What the arm's board wants of its bus: CAN FD if one of its drives speaks it, and the frames of its drives
/// only.
BusOptions BusOptionsOf(const ArmEntry& arm);

/// One topology: arms by id.
struct Topology {
  std::vector<Edge> edges;
  std::vector<Pin> pins;
};

/// Which of the topologies is in use when: each in turn, for the same time.
struct TopologySchedule {
  static constexpr size_t kMaxCount = 16;

  size_t count = 1;
  double period_s = 0.0;  ///< 0 with a single topology

  /// Index of the topology in use at time t since the fleet's start.
  size_t At(double t_s) const;
};

/// What every board reads: arms, gains, graph, buses, timing, limits.
struct FleetConfig {
  std::string name;
  std::string file;  ///< where it was read from
  TimingConfig timing;
  EstimatorConfig estimator;
  LcmLinkConfig link;
  std::vector<ArmEntry> arms;
  std::vector<Topology> topologies;  ///< at least one; used in turn
  double topology_period_s = 0.0;    ///< time each topology is used; 0 with a single one

  /// Index in `arms` of an id, or -1.
  int IndexOf(int id) const;
  /// The digraph of one topology, nodes numbered by index in `arms`.
  Digraph Graph(size_t topology) const;
  TopologySchedule Schedule() const { return {topologies.size(), topology_period_s}; }
  ArmControllerConfig ControllerConfig(size_t index) const;
};

}  // namespace armada
