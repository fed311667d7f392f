#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace armada {

/// "<first><separator><second>" as two numbers; false when it is something else.
bool ParsePair(const std::string& text, char separator, uint64_t* first, uint64_t* second);

/// "A:B", both included and A <= B, as first and last; false when it is something else.
bool ParseSeeds(const std::string& text, uint64_t* first, uint64_t* last);

/// What is done with one seed: the `index`-th of its list. False when it did not go well, for the progress
/// bar.
using SeedJob = std::function<bool(size_t index, uint64_t seed)>;

/// Hands the seeds in turn to `jobs` threads (0: one a core) and waits for the last. A progress bar where
/// standard error is a terminal.
void RunSeedJobs(const std::vector<uint64_t>& seeds, int jobs, const SeedJob& job);

}  // namespace armada
