#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/json.h"
#include "host/report/csv_table.h"

namespace armada {

/// What one arm left behind: its entry in metrics.json and its trace, one row per control tick.
struct ArmRecord {
  int id = 0;
  int joints = 0;       ///< counted from the columns q<k>_rad
  std::string subtask;  ///< "posture", "manipulability" or "none"
  bool diverged = false;
  std::optional<double> settled_s;
  Json metrics;  ///< the arm's object of metrics.json
  CsvTable trace;
  std::optional<CsvTable> without_subtask;  ///< the same arm in the twin run with all subtasks off
};

/// One recorded run of `armada sim --trace DIR` or `armada run --out DIR`.
struct RecordedRun {
  Json metrics;          ///< metrics.json as written
  double start_s = 0.0;  ///< the leader's first and last stamp
  double end_s = 0.0;
  double window_start_s = 0.0;  ///< the window over which the metrics are taken
  double window_end_s = 0.0;
  CsvTable leader;
  std::vector<ArmRecord> arms;
  std::optional<CsvTable> timing;  ///< per tick and arm, of real-time runs
};

/// Reads everything a report needs and checks that the columns it draws exist.
/// Throws ReportError that names the file (and the line, column or key) that is missing or wrong.
RecordedRun LoadRecordedRun(const std::filesystem::path& dir);

/// True of an arm's object of metrics.json when a subtask, limits or obstacles have a use for its spare
/// joints: it has a twin that has not.
bool UsesSpareJoints(const Json& arm);

/// Value of `key` in a part of metrics.json; throws ReportError that names the key and the part where it is
/// absent.
const Json& RequireKey(const Json& object, const std::string& key, const std::string& part);

}  // namespace armada
