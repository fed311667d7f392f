#pragma once

#include <cstdint>
#include <functional>

#include "host/sweep/seed_range.h"

namespace armada {

/// What is done with one seed: the `index`-th of its range. False when it did not go well, for the progress
/// bar.
using SeedJob = std::function<bool(size_t index, uint64_t seed)>;

/// Hands the seeds in turn to `jobs` threads (0: one a core) and waits for the last. A progress bar where
/// standard error is a terminal.
void RunSeedJobs(const SeedRange& seeds, int jobs, const SeedJob& job);

}  // namespace armada
