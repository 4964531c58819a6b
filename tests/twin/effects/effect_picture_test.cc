// SPDX-License-Identifier: Apache-2.0
// What effects say of themselves for a page: of each one, at the values where a search starts.
#include <gtest/gtest.h>

#include "tests/support/random_system.h"
#include "twin/effects/registry.h"

namespace physpring {
namespace {

class EffectPictures : public testing::Test {
 protected:
  // Calls visit(effect, values, picture) at each start of each effect.
  template <class Visit>
  void ForEachPicture(Visit visit) const {
    for (const Effect* effect : AllEffects()) {
      for (const Eigen::VectorXd& values : effect->Starts(setting_.system)) {
        visit(*effect, values, effect->Picture(values, setting_));
      }
    }
  }

  Setting setting_{RandomSystem(20, 2, 1), {0, 0, -9.81}};
};

TEST_F(EffectPictures, SayInWordsWhatIsLacking) {
  ForEachPicture([](const Effect& effect, const Eigen::VectorXd&, const EffectPicture& picture) {
    EXPECT_FALSE(picture.lacks.empty()) << effect.name();
    EXPECT_EQ(picture.lacks.find('_'), std::string::npos) << effect.name();
    EXPECT_FALSE(picture.where.empty()) << effect.name();
  });
}

TEST_F(EffectPictures, NameValuesThatThereAre) {
  ForEachPicture(
      [](const Effect& effect, const Eigen::VectorXd& values, const EffectPicture& picture) {
        EXPECT_LT(picture.amount, values.size()) << effect.name();
        for (const EffectPicture::Profile& profile : picture.profiles) {
          EXPECT_GT(profile.count, 1) << effect.name();
          EXPECT_LE(profile.first + profile.count, values.size()) << effect.name();
        }
        for (const EffectPicture::Course& course : picture.courses) {
          EXPECT_LE(course.first + 3 * course.count, values.size()) << effect.name();
        }
      });
}

}  // namespace
}  // namespace physpring
