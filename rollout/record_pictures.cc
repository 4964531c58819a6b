// SPDX-License-Identifier: Apache-2.0
#include "rollout/record_pictures.h"

#include <fmt/format.h>

#include "rollout/gl_camera.h"
#include "twin/error.h"
#include "twin/quote.h"

namespace physpring {
namespace {

constexpr double kDepthUnit = 1e-4;  // m: up to 6.5 m

DepthImage DepthOf(const DrawnScene& drawn) {
  DepthImage depth{drawn.width, drawn.height, {}};
  constexpr float kNothing = 1;  // the far end
  for (int y = drawn.height - 1; y >= 0; --y) {
    for (int x = 0; x < drawn.width; ++x) {
      const float value = drawn.depth[static_cast<std::size_t>(y) * drawn.width + x];
      depth.metres.push_back(value < kNothing ? MetricDepth(value, drawn.camera) : 0);
    }
  }
  return depth;
}

// The camera of this name, fixed in the world.
mjvCamera FindFixed(const mjModel& model, const std::string& name, const std::string& scene) {
  const mjvCamera view = FindCamera(model, name, scene);
  const int camera = view.fixedcamid;
  const bool tracks = model.cam_mode[camera] != mjCAMLIGHT_FIXED;
  if (tracks || model.body_weldid[model.cam_bodyid[camera]] != 0) {
    throw Error(fmt::format("{}: camera {} moves; pictures are recorded by fixed ones", scene,
                            Quote(name)));
  }
  if (model.cam_projection[camera] != mjPROJ_PERSPECTIVE) {
    throw Error(fmt::format("{}: camera {} has no perspective", scene, Quote(name)));
  }
  return view;
}

}  // namespace

PictureRecorder::PictureRecorder(const mjModel& model, const SoftPoints& soft,
                                 const PictureOptions& options, const std::string& scene)
    : model_(model),
      soft_(soft),
      options_(options),
      painter_(model, options.quality, options.width, options.height),
      data_(MakeData(model)),
      is_body_(model.nbody) {
  for (const std::string& name : options.cameras) {
    cameras_.push_back(FindFixed(model, name, scene));
    recorded_.push_back({name, {}});
  }
  for (const int element : soft.Particles()) is_body_[BodyOf(model, soft, element)] = true;
  Folder(0, 0).MakeFolders();
}

PictureRecorder::~PictureRecorder() {
  if (!finished_) Folder(0, 0).Remove(begun_);
}

PictureFolder PictureRecorder::Folder(double fps, int frames) const {
  return {options_.folder, fps, frames, kDepthUnit, recorded_};
}

Mask PictureRecorder::MaskOf(const mjvCamera& camera) {
  const auto belongs = [this](const mjvGeom& geom) {
    switch (geom.objtype) {
      case mjOBJ_FLEX:
        return soft_.of_flex;
      case mjOBJ_TENDON:
        return !soft_.of_flex;
      case mjOBJ_GEOM:
        return static_cast<bool>(is_body_[model_.geom_bodyid[geom.objid]]);
      case mjOBJ_SKIN:
        return true;
      default:
        return false;
    }
  };
  const std::vector<bool> seen = painter_.PixelsOf(belongs, false, data_.get(), camera);
  const std::vector<bool> alone = painter_.PixelsOf(belongs, true, data_.get(), camera);
  Mask mask{options_.width, options_.height, {}};
  for (std::size_t i = 0; i < seen.size(); ++i) {
    mask.kind.push_back(seen[i] ? kObject : (alone[i] ? kHidden : kElsewhere));
  }
  return mask;
}

void PictureRecorder::Record(int frame, const mjData& data) {
  mj_copyData(data_.get(), &model_, &data);
  PlaceForDrawing(model_, data_.get());
  begun_ = frame + 1;
  const PictureFolder folder = Folder(0, 0);
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    const int camera = static_cast<int>(i);
    const DrawnScene drawn = painter_.PaintWithDepth(data_.get(), cameras_[i]);
    recorded_[i].view = PinholeOf(drawn.camera, drawn.width, drawn.height);
    folder.Write(camera, frame, FromBottom(drawn));
    folder.Write(camera, frame, MaskOf(cameras_[i]));
    folder.Write(camera, frame, DepthOf(drawn));
  }
}

void PictureRecorder::Finish(double fps, int frames) {
  Folder(fps, frames).WriteCameras();
  finished_ = true;
}

}  // namespace physpring
