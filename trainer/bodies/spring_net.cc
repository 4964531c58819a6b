// SPDX-License-Identifier: Apache-2.0
#include "trainer/bodies/spring_net.h"

#include "trainer/bodies/factors.h"

namespace physpring {
namespace {

class SpringNetKind : public BodyKind {
 public:
  std::string Addition() const override { return ""; }
  bool has_single_springs() const override { return true; }
  void Free(const SpringMassSystem& /*base*/, ParameterOptions* /*options*/) const override {}
  int SearchedEffect(const Parameters& /*factors*/) const override { return -1; }
  LevenbergMarquardtOptions FactorOptions(const Recording& recording) const override {
    LevenbergMarquardtOptions options;
    options.difference = FactorDifference(recording);
    return options;
  }
  double handicap() const override { return 1; }
};

}  // namespace

const BodyKind& SpringNet() {
  static const SpringNetKind kind;
  return kind;
}

}  // namespace physpring
