#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace armada {

class ParameterVisitor;

/// A Config struct, whatever its type; it must outlive this.
class ParameterTable {
 public:
  using Type = void (*)(void* config, ParameterVisitor& visitor);

  template <class Config>
  ParameterTable(Config* config)
      : config_(config), visit_(VisitAs<Config>), visit_defaults_(VisitDefaultsOf<Config>) {}

  void Visit(ParameterVisitor& visitor) const { visit_(config_, visitor); }
  /// Visits a struct of this type with every value at its default.
  void VisitDefaults(ParameterVisitor& visitor) const { visit_defaults_(visitor); }
  /// Structs of one type have the same.
  Type type() const { return visit_; }

 private:
  template <class Config>
  static void VisitAs(void* config, ParameterVisitor& visitor) {
    static_cast<Config*>(config)->Visit(visitor);
  }
  template <class Config>
  static void VisitDefaultsOf(ParameterVisitor& visitor) {
    Config{}.Visit(visitor);
  }

  void* config_;
  Type visit_;
  void (*visit_defaults_)(ParameterVisitor& visitor);
};

/// A list of Config structs, whatever their type.
class ParameterList {
 public:
  virtual size_t size() const = 0;
  /// `count` elements, each as it is where a file says nothing of it.
  virtual void Reset(size_t count) = 0;
  virtual ParameterTable Element(size_t i) = 0;
  /// How element i is called in keys: its id if it has one, else its number from 1.
  virtual int Label(size_t i) const = 0;
  /// What element i, from 0, is where a file says nothing of it. Good until the next call.
  virtual ParameterTable Prototype(size_t i) = 0;

 protected:
  ~ParameterList() = default;
};

/// `make_prototype(i)` gives element i where a file says nothing of it.
template <class Config, class MakePrototype>
class VectorAsList final : public ParameterList {
 public:
  VectorAsList(std::vector<Config>* list, MakePrototype make_prototype)
      : list_(list), make_prototype_(std::move(make_prototype)) {}

  size_t size() const override { return list_->size(); }
  void Reset(size_t count) override {
    list_->clear();
    for (size_t i = 0; i < count; ++i) list_->push_back(make_prototype_(i));
  }
  ParameterTable Element(size_t i) override { return &(*list_)[i]; }
  int Label(size_t i) const override {
    if constexpr (requires(Config config) { config.id; }) return (*list_)[i].id;
    return static_cast<int>(i) + 1;
  }
  ParameterTable Prototype(size_t i) override {
    prototype_ = make_prototype_(i);
    return &prototype_;
  }

 private:
  std::vector<Config>* list_;
  MakePrototype make_prototype_;
  Config prototype_;
};

}  // namespace armada
