// SPDX-License-Identifier: Apache-2.0
// physpring rollout SCENE.xml --controllers REC: an exported twin in MuJoCo, moved as in a
// recording and compared with it.
#ifndef PHYSPRING_CLI_ROLLOUT_RECORDING_H_
#define PHYSPRING_CLI_ROLLOUT_RECORDING_H_

#include <string>
#include <vector>

#include "rollout/painter.h"

namespace physpring {

struct RecordingRollout {
  std::string scene, recording;
  std::string twin;                  // file; empty: none
  std::string video, json;           // files to write; empty: none
  std::vector<std::string> cameras;  // in the video
  PictureQuality quality = PictureQuality::kFast;
};

void RolloutRecording(const RecordingRollout& rollout);

}  // namespace physpring

#endif  // PHYSPRING_CLI_ROLLOUT_RECORDING_H_
