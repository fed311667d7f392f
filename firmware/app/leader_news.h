#pragma once

#include <vector>

#include "firmware/app/fleet.h"

namespace armada {

/// How old the newest leader state behind each arm's estimate gets, in s, by the arms' index: a tick a hop,
/// and the time until a topology brings the next. The largest age over a round of the topologies, once the
/// round repeats, on a network without delay or loss; infinite where the topologies together never bring any.
/// @pre a leader.
std::vector<double> OldestLeaderNews(const FleetConfig& fleet);

}  // namespace armada
