#pragma once

#include "hil/leader_path.h"
#include "hil/scenario.h"

namespace armada {

/// What the leader's path leaves of one arm's posture: shares of the path, 0 to 1, on which the tip can be at
/// the leader with the posture's joint
///   - at its goal,
///   - in line with the link before it (for the first joint: pointing away from the leader), and
///   - folded back onto it (pointing at the leader).
/// An arm bent to the other side comes to its goal through one of the latter two (docs/subtasks.md).
struct PostureCheck {
  int joint = 0;  ///< from 1
  double goal_rad = 0.0;
  bool any_turn = false;  ///< a goal whole turns away is one, too
  double at_goal = 0.0;
  double stretched = 0.0;
  double folded = 0.0;

  bool attainable() const { return at_goal >= 1.0; }
  /// Some way is open all the time, or there is but one goal to go to.
  bool from_every_start() const { return !any_turn || stretched >= 1.0 || folded >= 1.0; }
};

/// @pre the arm has a posture, and the scenario a leader.
PostureCheck CheckPosture(const ScenarioConfig& scenario, const ArmEntry& entry, const LeaderPath& leader);

}  // namespace armada
