#pragma once

#include <algorithm>
#include <cmath>

namespace armada {

/// Notices a joint whose drive goes on answering with what it knew last: its position repeats to the bit
/// while its speed says that it moves. A joint at rest may repeat for ever.
class FrozenFeedback {
 public:
  /// `speed_noise_rad_s`: no more than this is motion; `travel_max_rad`: travel by speed without one by
  /// position that no working drive shows, its resolution included.
  FrozenFeedback(double speed_noise_rad_s, double travel_max_rad)
      : speed_noise_rad_s_(speed_noise_rad_s), travel_max_rad_(travel_max_rad) {}

  /// Takes the sample that comes `elapsed_s` after the last one. True when it counts as frozen.
  bool Update(double position_rad, double velocity_rad_s, double elapsed_s) {
    const bool repeats = position_rad == position_rad_;
    position_rad_ = position_rad;
    const double speed_rad_s = std::max(0.0, std::abs(velocity_rad_s) - speed_noise_rad_s_);
    travel_rad_ = repeats ? travel_rad_ + speed_rad_s * elapsed_s : 0.0;
    return travel_rad_ > travel_max_rad_;
  }

 private:
  double speed_noise_rad_s_;
  double travel_max_rad_;
  double position_rad_ = std::nan("");
  double travel_rad_ = 0.0;
};

}  // namespace armada
