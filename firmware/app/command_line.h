#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace armada {

// Command lines: CLI11 and its names, without its header, which costs each source that reads it 5 to 10 s.

class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option* required(bool is_required = true);
  Option* capture_default_str();
  Option* take_last();
  Option* take_all();
  Option* allow_extra_args(bool allowed);
  Option* expected(int count);
  Option* needs(Option* other);
  Option* excludes(Option* other);

  /// `Number`: int, int64_t or double.
  template <class Number>
  Option* range(Number min, Number max);
  Option* positive();
  Option* not_negative();
  Option* one_of(const std::vector<std::string>& names);

  /// How often it was given.
  size_t count() const;

 private:
  CLI::Option* option_;
};

/// A program's command line, or a part of it: a subcommand or a group of options. What it returns pointers to
/// lives as long as it does.
class Command {
 public:
  explicit Command(CLI::App* app);
  ~Command();
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;

  Command* add_subcommand(const std::string& name, const std::string& help);
  Command* add_option_group(const std::string& name);
  /// `Value`: int, int64_t, uint64_t, double, string, optional<int>, optional<double>, vector<string> or
  /// vector<int>.
  template <class Value>
  Option* add_option(const std::string& name, Value& value, const std::string& help);
  Option* add_flag(const std::string& name, bool& value, const std::string& help);
  /// Of an option that was added.
  Option* get_option(const std::string& name);

  void require_subcommand(int count);
  void require_option(int count);
  void callback(std::function<void()> callback);
  bool parsed() const;

 protected:
  CLI::App* app_;

 private:
  Option* Own(CLI::Option* option);

  std::vector<std::unique_ptr<Option>> options_;
  std::vector<std::unique_ptr<Command>> commands_;
};

class CommandLine : public Command {
 public:
  CommandLine(const std::string& description, const std::string& program);
  ~CommandLine();

  /// Fills the values and calls the callbacks. The exit code of a program that has nothing more to do: its
  /// help was asked for, or the arguments are wrong; either was printed.
  std::optional<int> parse(int argc, char** argv);

 private:
  std::unique_ptr<CLI::App> owned_;
};

}  // namespace armada
