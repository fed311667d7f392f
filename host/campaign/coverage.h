#pragma once

#include <array>
#include <cstdint>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "firmware/core/supervisor.h"
#include "host/campaign/trial_result.h"

namespace armada {

/// What the trials of a campaign have tried: each kind of fault, and of the drives' faults each way of each
/// signal, in which states of their arms; and each transition of the supervisor.
class Coverage {
 public:
  Coverage();

  void Add(const ScenarioConfig& trial, const TrialResult& result);

  size_t cells() const { return cells_.size(); }
  size_t cells_tried() const;
  static constexpr size_t transitions() { return kTransitions.size(); }
  size_t transitions_taken() const;

  /// For people: a row a cell, a column a state.
  void Print(std::ostream& out) const;
  void WriteTo(nlohmann::ordered_json* json) const;

 private:
  struct Cell {
    FaultKind kind;
    FaultSignal signal;
    FaultWay way;
    int64_t trials = 0;
    std::array<int64_t, kControllerStates> met{};

    std::string Name() const;
  };

  std::vector<Cell> cells_;
  std::array<int64_t, kTransitions.size()> taken_{};
};

}  // namespace armada
