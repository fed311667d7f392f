#pragma once

#include <string>
#include <vector>

#include "firmware/core/parameter.h"

namespace armada {

/// Visitor that collects the keys of one table, not of those below it.
struct KeyLister {
  std::vector<std::string> keys;

  template <class T>
  void operator()(const ParameterInfo& info, T&) {
    keys.emplace_back(info.key);
  }
  template <class Config>
  void Table(const char* name, Config&) {
    keys.emplace_back(name);
  }
  template <class Config, class... Prototype>
  void List(const ListInfo& info, std::vector<Config>&, Prototype...) {
    keys.emplace_back(info.key);
  }
};

template <class Config>
std::vector<std::string> KeysOf() {
  Config config;
  KeyLister lister;
  config.Visit(lister);
  return lister.keys;
}

}  // namespace armada
