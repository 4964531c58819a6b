// SPDX-License-Identifier: Apache-2.0
// What `physpring eval` found, and the rows of its tables: one for each level, then one for each
// prediction that needs no twin (twin/baselines.h).
#ifndef PHYSPRING_REPORT_EVALUATION_H_
#define PHYSPRING_REPORT_EVALUATION_H_

#include <optional>
#include <string>
#include <vector>

#include "report/image_rows.h"
#include "twin/dataset.h"
#include "twin/evaluate.h"
#include "twin/recording.h"
#include "twin/twin.h"

namespace physpring {

struct EvaluatedRecording {
  std::string path;
  bool published_l1 = false;  // whether the published measure is meant for it
  Recording recording;
  RecordingResult result;
  std::optional<RecordingResult> anchored;  // of the frames from Evaluation::anchor on
  std::optional<ImageEvaluation> images;    // where pictures are to be compared
};

struct Evaluation {
  std::string twin_path;
  Twin twin;
  bool single_precision = false;
  int anchor = 0;  // the frame in which the predictions begin anew; 0: they do not
  std::vector<EvaluatedRecording> recordings;
};

// Errors over a range of frames of one recording, or of several. For several, they are means over
// the recordings that have data, and numbers of frames are summed.
struct RowErrors {
  MeanError cd, cd_euclidean, track;
  MeanError cd_lifted, cd_euclidean_lifted, track_lifted;
};

struct Row {
  std::string name;         // "level 0", or that of a baseline, "motionless"
  std::string description;  // of a baseline
  int level = -1;           // -1: a baseline, then the numbers up to `frames_per_second` are 0
  int nodes = 0;
  int springs = 0;
  int substeps = 0;  // sub-steps a frame; for several recordings the most
  double frames_per_second = 0;
  std::optional<RowErrors> fit;  // none if the twin was not trained on the recording
  RowErrors prediction;
  std::optional<double> published_l1;  // m
};

std::vector<Row> RowsOf(const EvaluatedRecording& evaluated);

// Mean track errors after the frame of the anchor, m; none where no tracked point is seen.
struct AnchoredRow {
  std::string name;                       // "level 0", "motionless"
  std::optional<double> blind, anchored;  // predicted from frame 0 on, from the anchor on
};

// The rows of a recording that has an anchor: lifted errors of the levels, then the motionless
// object, which is as at the start or as tracked at the anchor.
std::vector<AnchoredRow> AnchoredRowsOf(const EvaluatedRecording& evaluated, int anchor);

// The rows of the whole evaluation: means in which every recording counts once.
std::vector<Row> MeanRows(const Evaluation& evaluation);

}  // namespace physpring

#endif  // PHYSPRING_REPORT_EVALUATION_H_
