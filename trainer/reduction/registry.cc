// SPDX-License-Identifier: Apache-2.0
#include "trainer/reduction/registry.h"

#include <fmt/format.h>

#include "twin/error.h"

// One line a reduction: MakeNAME is in the reduction's own file.
#define PHYSPRING_REDUCTIONS(REDUCTION) \
  REDUCTION(Learned)                    \
  REDUCTION(Random)                     \
  REDUCTION(Gramian)                    \
  REDUCTION(KMeans)

namespace physpring {

#define PHYSPRING_DECLARE(NAME) std::unique_ptr<Reduction> Make##NAME();
PHYSPRING_REDUCTIONS(PHYSPRING_DECLARE)
#undef PHYSPRING_DECLARE

const std::vector<std::unique_ptr<Reduction>>& AllReductions() {
  static const std::vector<std::unique_ptr<Reduction>> kReductions = [] {
    std::vector<std::unique_ptr<Reduction>> reductions;
#define PHYSPRING_MAKE(NAME) reductions.push_back(Make##NAME());
    PHYSPRING_REDUCTIONS(PHYSPRING_MAKE)
#undef PHYSPRING_MAKE
    return reductions;
  }();
  return kReductions;
}

const Reduction& GetReduction(const std::string& name) {
  std::string known;
  for (const auto& reduction : AllReductions()) {
    if (reduction->name() == name) return *reduction;
    known += ", " + reduction->name();
  }
  throw Error(fmt::format("there is no reduction '{}', expected one of {}", name, known.substr(2)));
}

}  // namespace physpring
