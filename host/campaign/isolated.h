#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace armada {

/// What a piece of work came to in a process of its own.
struct IsolatedResult {
  std::string output;  ///< what the work returned; empty when it crashed
  std::string crash;   ///< how it ended instead, for people; empty when it did not
};

/// Does pieces 0 to count - 1 of a work, each in a process of its own and `jobs` at once (0: one a core), so
/// that one that crashes takes no other along. `done` gets their results, in this process, in any order.
/// Throws std::system_error when there can be no more processes. @pre no other threads
void RunIsolated(size_t count, int jobs, const std::function<std::string(size_t piece)>& work,
                 const std::function<void(size_t piece, const IsolatedResult&)>& done);

}  // namespace armada
