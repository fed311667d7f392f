#include "host/report/csv_table.h"

#include <charconv>
#include <fstream>
#include <limits>
#include <string_view>

#include "host/report/report_error.h"

namespace armada {
namespace {

std::vector<std::string_view> Split(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string_view> fields;
  for (size_t comma; (comma = line.find(',')) != std::string_view::npos; line.remove_prefix(comma + 1)) {
    fields.push_back(line.substr(0, comma));
  }
  fields.push_back(line);
  return fields;
}

bool ParseNumber(std::string_view field, double* value) {
  *value = std::numeric_limits<double>::quiet_NaN();
  if (field.empty()) return true;
  const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), *value);
  return status == std::errc() && end == field.data() + field.size();
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& path) : path_(path) {
  std::ifstream file(path);
  if (!file) throw ReportError(path.string() + ": cannot be read");
  std::string line;
  if (!std::getline(file, line)) throw ReportError(path.string() + ": is empty, a header line is expected");
  for (const std::string_view name : Split(line)) {
    index_.emplace(name, columns_.size());
    columns_.push_back({.name = std::string(name), .values = {}, .problem = {}});
  }
  for (int line_number = 2; std::getline(file, line); ++line_number) {
    AppendRow(line, path.string() + ":" + std::to_string(line_number) + ": ");
  }
  if (rows() == 0) throw ReportError(path.string() + ": has a header but no rows");
}

void CsvTable::AppendRow(const std::string& line, const std::string& place) {
  const std::vector<std::string_view> fields = Split(line);
  if (fields.size() != columns_.size()) {
    throw ReportError(place + std::to_string(fields.size()) + " fields, the header has " +
                      std::to_string(columns_.size()));
  }
  for (size_t i = 0; i < fields.size(); ++i) {
    NamedColumn& column = columns_[i];
    double value;
    if (!ParseNumber(fields[i], &value) && column.problem.empty()) {
      column.problem = place + "column " + column.name + ": '" + std::string(fields[i]) + "' is not a number";
    }
    column.values.push_back(value);
  }
}

const std::vector<double>& CsvTable::Column(const std::string& column) const {
  const auto found = index_.find(column);
  if (found == index_.end()) throw ReportError(path_.string() + ": has no column " + column);
  const NamedColumn& named = columns_[found->second];
  if (!named.problem.empty()) throw ReportError(named.problem);
  return named.values;
}

}  // namespace armada
