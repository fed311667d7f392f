#include "host/sweep/distribution.h"

#include <nlohmann/json.hpp>

namespace armada {

nlohmann::ordered_json ToJson(const Distribution& distribution) {
  if (distribution.count == 0) return nullptr;
  return {{"median", distribution.median},
          {"p95", distribution.p95},
          {"p99", distribution.p99},
          {"p99.9", distribution.p999},
          {"max", distribution.max},
          {"worst_seed", distribution.worst_seed},
          {"histogram", distribution.histogram.ToJson()}};
}

}  // namespace armada
