#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace armada {

/// A comma-separated file of numbers under one header line; columns are found by name.
class CsvTable {
 public:
  /// Reads the whole file. An empty field is NaN. Throws ReportError with file, line and column where the
  /// file is missing, has no rows, a row of another length than the header, or a field that is not a number.
  explicit CsvTable(const std::filesystem::path& path);

  bool Has(const std::string& column) const { return index_.contains(column); }

  /// One value per row. Throws ReportError where the header has no such column.
  const std::vector<double>& Column(const std::string& column) const;

  size_t rows() const { return columns_.front().size(); }

 private:
  void AppendRow(const std::string& line, size_t line_number);

  std::filesystem::path path_;
  std::vector<std::string> names_;
  std::map<std::string, size_t> index_;
  std::vector<std::vector<double>> columns_;
};

}  // namespace armada
