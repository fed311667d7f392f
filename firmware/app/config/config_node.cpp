#include "firmware/app/config/config_node.h"

#include <algorithm>
#include <utility>

#include "firmware/app/config/value_text.h"

namespace armada {
namespace {

constexpr size_t kMaxDescription = 60;

std::string Joined(const std::string& key, std::string_view label) {
  return key.empty() ? std::string(label) : key + "." + std::string(label);
}

}  // namespace

const ConfigNode* ConfigNode::Find(std::string_view child_key) const {
  if (kind != Kind::kTable) return nullptr;
  const auto child =
      std::find_if(children.begin(), children.end(), [&](const auto& c) { return c.key == child_key; });
  return child == children.end() ? nullptr : &*child;
}

ConfigNode* ConfigNode::Find(std::string_view child_key) {
  return const_cast<ConfigNode*>(std::as_const(*this).Find(child_key));
}

std::string ConfigNode::Describe() const {
  switch (kind) {
    case Kind::kTable:
      return "a table";
    case Kind::kBool:
      return ValueText(std::get<bool>(value));
    case Kind::kInteger:
      return std::to_string(std::get<int64_t>(value));
    case Kind::kReal:
      return ValueText(std::get<double>(value));
    case Kind::kOther:
      return std::get<std::string>(value);
    case Kind::kText: {
      const std::string& text = std::get<std::string>(value);
      return text.size() <= kMaxDescription ? ValueText(text)
                                            : ValueText(text.substr(0, kMaxDescription)) + "...";
    }
    case Kind::kArray:
      break;
  }
  std::string text = "[";
  for (const ConfigNode& child : children) {
    if (text.size() > 1) text += ", ";
    if (text.size() > kMaxDescription) return text + "...]";
    text += child.Describe();
  }
  return text + "]";
}

std::string ElementLabel(const ConfigNode& element, size_t index) {
  const ConfigNode* id = element.Find("id");
  const bool has_id = id != nullptr && id->kind == ConfigNode::Kind::kInteger;
  return has_id ? std::to_string(std::get<int64_t>(id->value)) : std::to_string(index + 1);
}

ConfigCursor ConfigCursor::At(std::string_view path) const {
  const size_t dot = path.find('.');
  const ConfigCursor child = Child(path.substr(0, dot));
  return dot == std::string_view::npos ? child : child.At(path.substr(dot + 1));
}

ConfigCursor ConfigCursor::Child(std::string_view label) const {
  ConfigCursor child = *this;
  child.key_ = Joined(key_, label);
  child.found_ = false;
  if (!found_) return child;
  const ConfigNode* next = node_->Find(label);
  if (node_->kind == ConfigNode::Kind::kArray) {
    for (size_t i = 0; i < node_->children.size() && next == nullptr; ++i) {
      if (ElementLabel(node_->children[i], i) == label) next = &node_->children[i];
    }
  }
  if (next != nullptr) {
    child.node_ = next;
    child.found_ = true;
  }
  return child;
}

ConfigCursor ConfigCursor::Element(size_t index) const {
  ConfigCursor element = *this;
  const bool exists = found_ && node_->kind == ConfigNode::Kind::kArray && index < node_->children.size();
  if (exists) element.node_ = &node_->children[index];
  element.found_ = exists;
  element.key_ = Joined(key_, exists ? ElementLabel(*element.node_, index) : std::to_string(index + 1));
  return element;
}

void Report(const ConfigCursor& at, std::string message, std::vector<ConfigError>* errors) {
  errors->push_back({at.node().file, at.node().line, at.key(), std::move(message)});
}

bool IsClean(const ConfigCursor& at, const std::vector<ConfigError>& errors) {
  const std::string below = at.key() + ".";
  return std::none_of(errors.begin(), errors.end(), [&](const ConfigError& error) {
    return error.key == at.key() || error.key.starts_with(below);
  });
}

}  // namespace armada
