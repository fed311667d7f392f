#pragma once

namespace armada {

/// What a board tells of its state, as on the wire (docs/lcm.md): in the judges' own words.
enum ToldState { kInit, kMonitor, kArming, kRun, kDegraded, kHold, kSafeStop, kFault };

/// It moves its arm after the leader.
inline bool Follows(int told) {
  return told == kRun || told == kDegraded;
}

}  // namespace armada
