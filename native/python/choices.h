// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>

#include "planar/arap.h"

namespace planar::python {

// The choice of that name. Throws std::invalid_argument (ValueError in Python) that lists the names there
// are.
template <typename Choice>
Choice to_choice(const std::string& option, const std::string& name,
                 std::initializer_list<std::pair<const char*, Choice>> choices) {
  std::string text = option + ": '" + name + "' is not available; there are";
  for (const auto& [known, choice] : choices) {
    if (name == known) return choice;
    text += std::string(" '") + known + "'";
  }
  throw std::invalid_argument(text);
}

inline ArapWeights to_arap_weights(const std::string& name) {
  return to_choice<ArapWeights>("weights", name,
                                {{"cotangent", ArapWeights::cotangent}, {"uniform", ArapWeights::uniform}});
}

}  // namespace planar::python
