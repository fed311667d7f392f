#pragma once

#include <array>
#include <cstddef>
#include <string>

namespace armada {

/// Colours of arms, the same in every figure and in the table: Okabe and Ito's set without yellow (pale on
/// white) and black (the leader), and a violet chosen to stay apart from them under the three kinds of colour
/// blindness.
inline constexpr std::array kArmColours = {"#0072B2", "#E69F00", "#009E73", "#D55E00",
                                           "#CC79A7", "#56B4E9", "#862DE0"};

/// Colours of joints within one arm's panel, after Tol's high-contrast and bright sets.
inline constexpr std::array kJointColours = {"#3367B0", "#DDAA33", "#BB5566", "#009988",
                                             "#777777", "#AA4499", "#66CCEE"};

/// Colour of the arm at position `index` of the fleet; fleets larger than the palette repeat it with other
/// dashes.
inline std::string ArmColour(size_t index) {
  return kArmColours[index % kArmColours.size()];
}
inline size_t ArmDash(size_t index) {
  return 1 + index / kArmColours.size();
}

/// Colour of joint 1, 2, ...
inline std::string JointColour(int joint) {
  return kJointColours[(static_cast<size_t>(joint) - 1) % kJointColours.size()];
}

}  // namespace armada
