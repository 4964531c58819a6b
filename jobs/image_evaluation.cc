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

// Whether something of the object, or what hides it, is within `reach` pixels of (x, y).
bool IsNear(const Mask& mask, int x, int y, int reach) {
  for (int row = std::max(0, y - reach); row <= std::min(mask.height - 1, y + reach); ++row) {
    for (int column = std::max(0, x - reach); column <= std::min(mask.width - 1, x + reach);
         ++column) {
      if (mask.kind[static_cast<std::size_t>(row) * mask.width + column] != kElsewhere) return true;
    }
  }
  return false;
}

// A prediction of the nodes, and the splats that move with them.
struct Prediction {
  std::string name;
  const std::vector<Points>* nodes;
  SplatMotion motion;

  // `start`: where the nodes are in the recording's frame 0, as the splats are; a prediction may
  // have them elsewhere then.
  Prediction(std::string of, const std::vector<Points>& frames, const Points& start,
             const Splats& splats)
      : name(std::move(of)), nodes(&frames), motion(splats, start) {}
};

std::vector<Prediction> PredictionsOf(const EvaluatedRecording& evaluated, const Splats& splats) {
  std::vector<Prediction> predictions;
  for (const LevelResult& level : evaluated.result.levels) {
    predictions.emplace_back(fmt::format("level {}", level.level), level.positions,
                             level.positions[0], splats);
  }
  const Recording& recording = evaluated.recording;
  const Points start = recording.start.leftCols(recording.particle_count());
  for (const BaselineResult& baseline : evaluated.result.baselines) {
    predictions.emplace_back(baseline.name, baseline.positions, start, splats);
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
        if (const auto errors = CompareImages(predicted, picture.coverage, recorded, mask)) {
          evaluation_.rows[i].errors[frame].push_back(*errors);
        }
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

// Which of the measured points that a camera should see are where it sees the object, within a few
// pixels: 0 to 1. Points beside the picture do not count; 1 where there are none.
double PartInMasks(const PictureFolder& pictures, const std::vector<int>& cameras,
                   const Recording& recording) {
  constexpr int kLooks = 8;  // frames
  int inside = 0, all = 0;
  for (const int camera : cameras) {
    const PinholeCamera& view = pictures.cameras()[camera].view;
    const int reach = 2 + view.width / 150;  // pixels
    for (int look = 0; look < kLooks; ++look) {
      const int frame = look * (recording.frame_count() - 1) / (kLooks - 1);
      const Mask mask = pictures.ReadObjectMask(camera, frame);
      for (const auto& point : recording.points[frame].colwise()) {
        const Eigen::Vector3d t = view.axes * point + view.shift;
        const double u = view.fx * t.x() / t.z() + view.cx, v = view.fy * t.y() / t.z() + view.cy;
        if (!(t.z() > 0 && u >= 0 && u < view.width && v >= 0 && v < view.height)) continue;
        ++all;
        inside += IsNear(mask, static_cast<int>(u), static_cast<int>(v), reach) ? 1 : 0;
      }
    }
  }
  return all > 0 ? static_cast<double>(inside) / all : 1;
}

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
  constexpr double kFew = 0.5;
  if (const double part = PartInMasks(pictures, cameras, evaluated->recording); part < kFew) {
    evaluated->recording.warnings.push_back(fmt::format(
        "{}: only {:.0f} % of the measured points are where the cameras see the object; are these "
        "the pictures of {}?",
        options.pictures, 100 * part, evaluated->path));
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
