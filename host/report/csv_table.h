#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace armada {

/// A comma-separated file under one header line; columns of numbers are found by name, all others are
/// ignored.
class CsvTable {
 public:
  /// Reads the whole file. An empty field is NaN. Throws ReportError where the file cannot be read, has no
  /// rows, or a row of another length than the header; the message names the file and the line.
  explicit CsvTable(const std::filesystem::path& path);

  bool Has(const std::string& column) const { return index_.contains(column); }

  /// One value per row. Throws ReportError where the header has no such column or a field of it is not a
  /// number.
  const std::vector<double>& Column(const std::string& column) const;

  size_t rows() const { return columns_.front().values.size(); }

 private:
  struct NamedColumn {
    std::string name;
    std::vector<double> values;
    std::string problem;  ///< the first field that is not a number; empty where all are
  };

  void AppendRow(const std::string& line, const std::string& place);

  std::filesystem::path path_;
  std::vector<NamedColumn> columns_;
  std::map<std::string, size_t> index_;
};

}  // namespace armada
