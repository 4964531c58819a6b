// SPDX-License-Identifier: Apache-2.0
#include "report/image_rows.h"

#include <fmt/format.h>

#include <algorithm>

#include "report/evaluation.h"

namespace physpring {
namespace {

using Json = nlohmann::ordered_json;

class MeanOf {
 public:
  void Add(double value) {
    sum_ += value;
    ++count_;
  }
  std::optional<double> Get() const {
    return count_ > 0 ? std::optional(sum_ / count_) : std::nullopt;
  }

 private:
  double sum_ = 0;
  int count_ = 0;
};

std::string Cell(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

std::string Cells(const MeanImageErrors& mean) {
  return fmt::format(" | {:>5} {:>5} {:>6} {:>5} {:>6}", Cell(mean.iou, 3), Cell(mean.psnr, 2),
                     Cell(mean.ssim, 4), Cell(mean.box_psnr, 2), Cell(mean.box_ssim, 4));
}

Json AsJson(const MeanImageErrors& mean) {
  const auto nullable = [](const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
  };
  return {{"iou", nullable(mean.iou)},           {"psnr", nullable(mean.psnr)},
          {"ssim", nullable(mean.ssim)},         {"box_psnr", nullable(mean.box_psnr)},
          {"box_ssim", nullable(mean.box_ssim)}, {"pictures", mean.pictures}};
}

// The parts that a recording has: name, first and end frame.
struct Part {
  std::string name;
  int first, end;
};

std::vector<Part> PartsOf(const EvaluatedRecording& evaluated) {
  const int split = evaluated.result.first_predicted, end = evaluated.recording.frame_count();
  std::vector<Part> parts;
  if (evaluated.result.trained_on) parts.push_back({"fit", 1, split});
  parts.push_back({"prediction", split, end});
  return parts;
}

}  // namespace

MeanImageErrors MeanOverFrames(const ImageRow& row, int first, int last) {
  MeanImageErrors mean;
  MeanOf iou, psnr, ssim, box_psnr, box_ssim;
  for (int frame = first; frame < last; ++frame) {
    for (const ImageErrors& errors : row.errors[frame]) {
      ++mean.pictures;
      iou.Add(errors.iou);
      psnr.Add(errors.psnr);
      ssim.Add(errors.ssim);
      box_psnr.Add(errors.box_psnr);
      box_ssim.Add(errors.box_ssim);
    }
  }
  mean.iou = iou.Get();
  mean.psnr = psnr.Get();
  mean.ssim = ssim.Get();
  mean.box_psnr = box_psnr.Get();
  mean.box_ssim = box_ssim.Get();
  return mean;
}

std::string FormatImageTable(const EvaluatedRecording& evaluated) {
  const ImageEvaluation& images = *evaluated.images;
  const std::vector<Part> parts = PartsOf(evaluated);
  std::size_t width = 12;  // of names
  for (const ImageRow& row : images.rows) width = std::max(width, row.name.size());
  std::string text = fmt::format("pictures of {} by {}; PSNR in dB; box: around the object\n{:<{}}",
                                 images.pictures, fmt::join(images.cameras, ", "), "", width);
  for (const Part& part : parts) text += fmt::format(" | {:<31}", part.name);
  text += fmt::format("\n{:<{}}", "", width);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    text += fmt::format(" | {:>5} {:>5} {:>6} {:>5} {:>6}", "IoU", "PSNR", "SSIM", "box", "box");
  }
  text += '\n';
  for (const ImageRow& row : images.rows) {
    text += fmt::format("{:<{}}", row.name, width);
    for (const Part& part : parts) text += Cells(MeanOverFrames(row, part.first, part.end));
    text += '\n';
  }
  return text;
}

Json ImagesAsJson(const EvaluatedRecording& evaluated) {
  const ImageEvaluation& images = *evaluated.images;
  Json json = {{"pictures", images.pictures},
               {"splats", images.splats},
               {"cameras", images.cameras},
               {"levels", Json::array()}};
  const std::size_t levels = evaluated.result.levels.size();
  for (std::size_t i = 0; i < images.rows.size(); ++i) {
    Json errors = {{"fit", nullptr}};
    for (const Part& part : PartsOf(evaluated)) {
      errors[part.name] = AsJson(MeanOverFrames(images.rows[i], part.first, part.end));
    }
    if (i < levels) {
      errors["level"] = evaluated.result.levels[i].level;
      json["levels"].push_back(errors);
    } else {
      json[images.rows[i].name] = errors;
    }
  }
  return json;
}

}  // namespace physpring
