#include "firmware/app/command_line.h"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <utility>

#include "firmware/app/exit_codes.h"

namespace armada {

Option* Option::required(bool is_required) {
  option_->required(is_required);
  return this;
}

Option* Option::capture_default_str() {
  option_->capture_default_str();
  return this;
}

Option* Option::take_last() {
  option_->take_last();
  return this;
}

Option* Option::take_all() {
  option_->take_all();
  return this;
}

Option* Option::allow_extra_args(bool allowed) {
  option_->allow_extra_args(allowed);
  return this;
}

Option* Option::expected(int count) {
  option_->expected(count);
  return this;
}

Option* Option::needs(Option* other) {
  option_->needs(other->option_);
  return this;
}

Option* Option::excludes(Option* other) {
  option_->excludes(other->option_);
  return this;
}

template <class Number>
Option* Option::range(Number min, Number max) {
  option_->check(CLI::Range(min, max));
  return this;
}

template Option* Option::range(int min, int max);
template Option* Option::range(int64_t min, int64_t max);
template Option* Option::range(double min, double max);

Option* Option::positive() {
  option_->check(CLI::PositiveNumber);
  return this;
}

Option* Option::not_negative() {
  option_->check(CLI::NonNegativeNumber);
  return this;
}

Option* Option::one_of(const std::vector<std::string>& names) {
  option_->check(CLI::IsMember(names));
  return this;
}

size_t Option::count() const {
  return option_->count();
}

Command::Command(CLI::App* app) : app_(app) {}

Command::~Command() = default;

Command* Command::add_subcommand(const std::string& name, const std::string& help) {
  return commands_.emplace_back(std::make_unique<Command>(app_->add_subcommand(name, help))).get();
}

Command* Command::add_option_group(const std::string& name) {
  return commands_.emplace_back(std::make_unique<Command>(app_->add_option_group(name))).get();
}

template <class Value>
Option* Command::add_option(const std::string& name, Value& value, const std::string& help) {
  return Own(app_->add_option(name, value, help));
}

template Option* Command::add_option(const std::string&, int&, const std::string&);
template Option* Command::add_option(const std::string&, int64_t&, const std::string&);
template Option* Command::add_option(const std::string&, uint64_t&, const std::string&);
template Option* Command::add_option(const std::string&, double&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<int>&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option* Command::add_option(const std::string&, std::string&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<int>&, const std::string&);

Option* Command::add_flag(const std::string& name, bool& value, const std::string& help) {
  return Own(app_->add_flag(name, value, help));
}

Option* Command::get_option(const std::string& name) {
  return Own(app_->get_option(name));
}

void Command::require_subcommand(int count) {
  app_->require_subcommand(count);
}

void Command::require_option(int count) {
  app_->require_option(count);
}

void Command::callback(std::function<void()> callback) {
  app_->callback(std::move(callback));
}

bool Command::parsed() const {
  return app_->parsed();
}

Option* Command::Own(CLI::Option* option) {
  return options_.emplace_back(std::make_unique<Option>(option)).get();
}

CommandLine::CommandLine(const std::string& description, const std::string& program)
    : Command(nullptr), owned_(std::make_unique<CLI::App>(description, program)) {
  app_ = owned_.get();
}

CommandLine::~CommandLine() = default;

std::optional<int> CommandLine::parse(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app_->exit(error) == 0 ? kExitOk : kExitUsage;
  }
  return std::nullopt;
}

}  // namespace armada
