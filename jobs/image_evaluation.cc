// SPDX-License-Identifier: Apache-2.0
#include "jobs/image_evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "pictures/picture_folder.h"
#include "splats/picture_bytes.h"
#include "splats/placement.h"
#include "splats/rasterise.h"
#include "splats/splat_file.h"
#include "splats/splat_motion.h"
#include "twin/error.h"
#include "twin/parallel.h"
#include "twin/stop_request.h"

namespace physpring {
namespace {

constexpr int kShown = 4;  // frames on a page

void ExpectSameFrames(const PictureFolder& pictures, const EvaluatedRecording& evaluated) {
  const Recording& recording = evaluated.recording;
  constexpr double kSameRate = 1e-3;
  if (pictures.frame_count() == recording.frame_count() &&
      std::abs(pictures.fps() - recording.fps) <= kSameRate * recording.fps) {
    return;
  }
  throw Error(fmt::format("{}: has {} frames at {:g} fps, but {} has {} at {:g}", pictures.path(),
                          pictures.frame_count(), pictures.fps(), evaluated.path,
                          recording.frame_count(), recording.fps));
}

std::vector<int> CamerasOf(const PictureFolder& pictures, const std::vector<std::string>& names) {
  std::vector<int> cameras;
  for (const std::string& name : names) cameras.push_back(pictures.CameraOf(name));
  for (int i = 0; names.empty() && i < static_cast<int>(pictures.cameras().size()); ++i) {
    cameras.push_back(i);
  }
  return cameras;
}

// A prediction of the nodes, and the splats that move with them.
struct Prediction {
  std::string name;
  const std::vector<Points>* nodes;
  SplatMotion motion;

  Prediction(std::string of, const std::vector<Points>& frames, const Splats& splats)
      : name(std::move(of)), nodes(&frames), motion(splats, frames[0]) {}
};

std::vector<Prediction> PredictionsOf(const EvaluatedRecording& evaluated, const Splats& splats) {
  std::vector<Prediction> predictions;
  for (const LevelResult& level : evaluated.result.levels) {
    predictions.emplace_back(fmt::format("level {}", level.level), level.positions, splats);
  }
  for (const BaselineResult& baseline : evaluated.result.baselines) {
    predictions.emplace_back(baseline.name, baseline.positions, splats);
  }
  return predictions;
}

// Evenly apart over the frames that are not frame 0.
std::vector<int> FramesToShow(int frames) {
  std::vector<int> shown;
  for (int i = 1; i <= kShown; ++i) {
    const int frame = i * (frames - 1) / kShown;
    if (frame > 0 && (shown.empty() || frame > shown.back())) shown.push_back(frame);
  }
  return shown;
}

class ImageJudge {
 public:
  ImageJudge(const PictureFolder& pictures, std::vector<int> cameras,
             const std::vector<Prediction>& predictions, ImageEvaluation* evaluation)
      : pictures_(pictures),
        cameras_(std::move(cameras)),
        predictions_(predictions),
        evaluation_(*evaluation) {
    for (const Prediction& prediction : predictions) {
      evaluation_.rows.push_back(
          {prediction.name, std::vector<std::vector<ImageErrors>>(pictures.frame_count())});
    }
    for (const int frame : FramesToShow(pictures.frame_count())) {
      evaluation_.shown.push_back({frame, {}, {}});
    }
  }

  void Judge(int frame) {
    for (const int camera : cameras_) {
      const Image recorded = pictures_.ReadImage(camera, frame);
      const Mask mask = pictures_.ReadObjectMask(camera, frame);
      for (std::size_t i = 0; i < predictions_.size(); ++i) {
        const Prediction& prediction = predictions_[i];
        const SplatPicture picture = Rasterise(prediction.motion.At((*prediction.nodes)[frame], 1),
                                               pictures_.cameras()[camera].view, {}, 1);
        const Image predicted = BytesOf(picture);
        evaluation_.rows[i].errors[frame].push_back(
            CompareImages(predicted, picture.coverage, recorded, mask));
        if (i == 0 && camera == cameras_.front()) Keep(frame, recorded, mask, predicted);
      }
    }
  }

 private:
  // For the page.
  void Keep(int frame, const Image& recorded, const Mask& mask, const Image& predicted) {
    for (ShownPicture& shown : evaluation_.shown) {
      if (shown.frame != frame) continue;
      shown.recorded = ObjectAlone(recorded, mask);
      shown.predicted = WithoutHidden(predicted, mask);
    }
  }

  const PictureFolder& pictures_;
  const std::vector<int> cameras_;
  const std::vector<Prediction>& predictions_;
  ImageEvaluation& evaluation_;
};

}  // namespace

ImageEvaluation EvaluateImages(const ImageOptions& options, EvaluatedRecording* evaluated) {
  const PictureFolder pictures(options.pictures);
  ExpectSameFrames(pictures, *evaluated);
  const Splats splats = ReadSplats(options.splats);
  ImageEvaluation evaluation{options.pictures, options.splats, {}, {}, {}};
  const std::vector<int> cameras = CamerasOf(pictures, options.cameras);
  for (const int camera : cameras) evaluation.cameras.push_back(pictures.cameras()[camera].name);

  const std::vector<Prediction> predictions = PredictionsOf(*evaluated, splats);
  for (const std::string& warning :
       WarningsOf(CheckPlacement(splats, (*predictions[0].nodes)[0]), options.splats)) {
    evaluated->recording.warnings.push_back(warning);
  }
  ImageJudge judge(pictures, cameras, predictions, &evaluation);
  const int last = pictures.frame_count() - 1;
  std::mutex mutex;
  int done = 0;
  ParallelFor(last, options.threads, [&](int i) {
    StopIfRequested();
    judge.Judge(i + 1);
    const std::lock_guard lock(mutex);
    ++done;
    if (options.progress) options.progress(static_cast<double>(done) / last);
  });
  return evaluation;
}

}  // namespace physpring
