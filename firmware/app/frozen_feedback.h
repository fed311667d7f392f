#pragma once

#include <cmath>

namespace armada {

/// Notices a joint whose drive goes on answering with what it knew last: its position repeats to the bit
/// while its speed says that it moves, or while it is pushed with all the torque there is (which a blocked
/// joint is, too). A joint at rest may repeat for ever.
class FrozenFeedback {
 public:
  struct Limits {
    double speed_noise_rad_s;  ///< no more than this is motion
    double travel_max_rad;     ///< by speed without any by position; above the position's resolution
    double torque_limit_Nm;    ///< all the torque there is
    double pushed_max_s;       ///< with it and without any motion
  };

  explicit FrozenFeedback(const Limits& limits) : limits_(limits) {}

  /// Takes the sample that comes `elapsed_s` after the last one, and the torque in between. True when it
  /// counts as frozen. Speeds to and fro cancel: a joint may tremble within the resolution of its position.
  bool Update(double position_rad, double velocity_rad_s, double torque_Nm, double elapsed_s) {
    const bool repeats = position_rad == position_rad_;
    position_rad_ = position_rad;
    repeated_s_ = repeats ? repeated_s_ + elapsed_s : 0.0;
    travel_rad_ = repeats ? travel_rad_ + velocity_rad_s * elapsed_s : 0.0;
    pushed_s_ = repeats && std::abs(torque_Nm) >= limits_.torque_limit_Nm ? pushed_s_ + elapsed_s : 0.0;
    return std::abs(travel_rad_) - limits_.speed_noise_rad_s * repeated_s_ > limits_.travel_max_rad ||
           pushed_s_ > limits_.pushed_max_s;
  }

 private:
  Limits limits_;
  double position_rad_ = std::nan("");
  double repeated_s_ = 0.0;  ///< for how long the position has been the same
  double travel_rad_ = 0.0;  ///< by speed in that time
  double pushed_s_ = 0.0;    ///< for how long of it, to its end, the torque was at its limit
};

}  // namespace armada
