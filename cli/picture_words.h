// SPDX-License-Identifier: Apache-2.0
// The words of --quality.
#ifndef PHYSPRING_CLI_PICTURE_WORDS_H_
#define PHYSPRING_CLI_PICTURE_WORDS_H_

#include "cli/option_values.h"
#include "rollout/painter.h"

namespace physpring {

inline constexpr Word<PictureQuality> kQualityWords[] = {{"fast", PictureQuality::kFast},
                                                         {"high", PictureQuality::kHigh}};

}  // namespace physpring

#endif  // PHYSPRING_CLI_PICTURE_WORDS_H_
