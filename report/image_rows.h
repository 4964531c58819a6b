// SPDX-License-Identifier: Apache-2.0
// What was found by comparing pictures: means over the frames of a fit and of a prediction.
#ifndef PHYSPRING_REPORT_IMAGE_ROWS_H_
#define PHYSPRING_REPORT_IMAGE_ROWS_H_

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pictures/image_errors.h"

namespace physpring {

struct EvaluatedRecording;

// Errors of one prediction: of each frame, of each camera that sees the object then.
struct ImageRow {
  std::string name;  // as in Row
  std::vector<std::vector<ImageErrors>> errors;
};

// For a page: the object as the first camera recorded it, and as level 0 predicts it.
struct ShownPicture {
  int frame = 0;
  Image recorded, predicted;
};

struct ImageEvaluation {
  std::string pictures, splats;      // folder, file
  std::vector<std::string> cameras;  // names
  std::vector<ImageRow> rows;        // frame 0 has no errors
  std::vector<ShownPicture> shown;
};

// Over all pictures of a range of frames in which the object is seen; every picture counts once, as
// in PhysTwin.
struct MeanImageErrors {
  int pictures = 0;
  std::optional<double> iou, psnr, ssim, box_psnr, box_ssim;
};
MeanImageErrors MeanOverFrames(const ImageRow& row, int first, int last);

// A table, which ends with a line break.
std::string FormatImageTable(const EvaluatedRecording& evaluated);

// {"pictures": ..., "cameras": [...], "levels": [{"level": 0, "fit": {...}, ...}], ...}.
nlohmann::ordered_json ImagesAsJson(const EvaluatedRecording& evaluated);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_IMAGE_ROWS_H_
