// SPDX-License-Identifier: Apache-2.0
#include "rollout/painter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rollout/mujoco_log.h"
#include "twin/error.h"
#include "twin/quote.h"

namespace physpring {

void PreparePictures(PictureQuality quality, int width, int height, mjModel* model) {
  model->vis.global.offwidth = std::max(model->vis.global.offwidth, width);
  model->vis.global.offheight = std::max(model->vis.global.offheight, height);
  if (quality == PictureQuality::kHigh) return;
  model->vis.quality.offsamples = 0;
  model->vis.quality.shadowsize = 0;
  model->vis.quality.numslices = 8;
  model->vis.quality.numstacks = 4;
  model->vis.quality.numquads = 1;
}

mjvCamera FindCamera(const mjModel& model, const std::string& name, const std::string& scene) {
  mjvCamera view;
  mjv_defaultCamera(&view);
  view.type = mjCAMERA_FIXED;
  view.fixedcamid = mj_name2id(&model, mjOBJ_CAMERA, name.c_str());
  if (view.fixedcamid < 0) throw Error(fmt::format("{}: has no camera {}", scene, Quote(name)));
  return view;
}

mjvCamera OverviewOf(const mjModel& model, const Eigen::Vector3d& low,
                     const Eigen::Vector3d& high) {
  mjvCamera view;
  mjv_defaultCamera(&view);
  const Eigen::Vector3d centre = (low + high) / 2;
  mju_copy3(view.lookat, centre.data());
  const double angle = static_cast<double>(model.vis.global.fovy) * EIGEN_PI / 180;
  view.distance = 0.5 * (high - low).norm() / std::sin(angle / 2);
  view.azimuth = 110;
  view.elevation = -20;
  return view;
}

void PlaceForDrawing(const mjModel& model, mjData* data) {
  mj_kinematics(&model, data);
  mj_comPos(&model, data);
  mj_camlight(&model, data);
  mj_flex(&model, data);
  mj_tendon(&model, data);
}

Image FromBottom(const DrawnScene& drawn) {
  Image image{drawn.width, drawn.height, {}};
  const std::ptrdiff_t row = 3 * static_cast<std::ptrdiff_t>(drawn.width);
  image.rgb.reserve(drawn.rgb.size());
  for (int y = drawn.height - 1; y >= 0; --y) {
    const auto from = drawn.rgb.begin() + row * y;
    image.rgb.insert(image.rgb.end(), from, from + row);
  }
  return image;
}

Painter::Painter(const mjModel& model, PictureQuality quality, int width, int height,
                 const SplatLayer* splats)
    : model_(model), splats_(splats), width_(width), height_(height), off_screen_(width, height) {
  constexpr int kSpare = 1000;  // geoms besides the model's own
  mjv_defaultOption(&option_);
  if (splats_ != nullptr && splats_->has_object()) option_.flags[mjVIS_SKIN] = 0;
  mjv_defaultScene(&scene_);
  mjr_defaultContext(&context_);
  mjv_makeScene(&model_, &scene_, model_.ngeom + 2 * model_.ntendon + model_.nsite + kSpare);
  if (quality == PictureQuality::kFast) {
    scene_.flags[mjRND_SHADOW] = 0;
    scene_.flags[mjRND_REFLECTION] = 0;
    scene_.flags[mjRND_HAZE] = 0;
  }
  CatchMujoco([&] {
    mjr_makeContext(&model_, &context_, mjFONTSCALE_100);
    mjr_setBuffer(mjFB_OFFSCREEN, &context_);
  });
}

Painter::~Painter() {
  mjr_freeContext(&context_);
  mjv_freeScene(&scene_);
}

void Painter::Mark(const Points& marks) {
  constexpr float kColour[4] = {1.0F, 0.35F, 0.1F, 1.0F};
  constexpr double kSize = 0.003;  // as a part of the model's extent
  for (const auto& mark : marks.colwise()) {
    if (std::isnan(mark[0]) || scene_.ngeom == scene_.maxgeom) continue;
    const double radius[3] = {kSize * model_.stat.extent, 0, 0};
    const double place[3] = {mark[0], mark[1], mark[2]};
    mjv_initGeom(&scene_.geoms[scene_.ngeom++], mjGEOM_SPHERE, radius, place, nullptr, kColour);
  }
}

void Painter::Update(mjData* data, const mjvCamera& camera) {
  mjvCamera view = camera;
  mjv_updateScene(&model_, data, &option_, nullptr, &view, mjCAT_ALL, &scene_);
}

DrawnScene Painter::Draw(mjData* data, const mjvCamera& camera, const Points& marks,
                         bool with_depth) {
  const mjrRect area{0, 0, width_, height_};
  const std::size_t pixels = static_cast<std::size_t>(width_) * height_;
  DrawnScene drawn{width_, height_, std::vector<unsigned char>(3 * pixels), {}, {}};
  if (with_depth) drawn.depth.resize(pixels);
  CatchMujoco([&] {
    Update(data, camera);
    Mark(marks);
    mjr_render(area, &scene_, &context_);
    mjr_readPixels(drawn.rgb.data(), with_depth ? drawn.depth.data() : nullptr, area, &context_);
    drawn.camera = mjv_averageCamera(&scene_.camera[0], &scene_.camera[1]);
  });
  return drawn;
}

Image Painter::Paint(mjData* data, const mjvCamera& camera, const Points& marks) {
  const DrawnScene drawn = Draw(data, camera, marks, splats_ != nullptr);
  return splats_ != nullptr ? splats_->Compose(drawn, *data) : FromBottom(drawn);
}

DrawnScene Painter::PaintWithDepth(mjData* data, const mjvCamera& camera) {
  return Draw(data, camera, Points(3, 0), true);
}

std::vector<bool> Painter::PixelsOf(const Belongs& belongs, bool alone, mjData* data,
                                    const mjvCamera& camera) {
  const mjrRect area{0, 0, width_, height_};
  const std::size_t pixels = static_cast<std::size_t>(width_) * height_;
  std::vector<unsigned char> ids(3 * pixels);
  std::vector<bool> is_it(1);  // by a geom's number in the picture, which begins at 1
  CatchMujoco([&] {
    Update(data, camera);
    if (alone) {
      const auto end = std::remove_if(scene_.geoms, scene_.geoms + scene_.ngeom,
                                      [&](const mjvGeom& geom) { return !belongs(geom); });
      scene_.ngeom = static_cast<int>(end - scene_.geoms);
    }
    for (int i = 0; i < scene_.ngeom; ++i) {
      const mjvGeom& geom = scene_.geoms[i];
      if (geom.segid < 0) continue;
      const std::size_t id = static_cast<std::size_t>(geom.segid) + 1;
      if (id >= is_it.size()) is_it.resize(id + 1);
      is_it[id] = belongs(geom);
    }
    scene_.flags[mjRND_SEGMENT] = scene_.flags[mjRND_IDCOLOR] = 1;
    mjr_render(area, &scene_, &context_);
    scene_.flags[mjRND_SEGMENT] = scene_.flags[mjRND_IDCOLOR] = 0;
    mjr_readPixels(ids.data(), nullptr, area, &context_);
  });
  std::vector<bool> found;
  found.reserve(pixels);
  for (int y = height_ - 1; y >= 0; --y) {
    for (int x = 0; x < width_; ++x) {
      const unsigned char* rgb = &ids[3 * (static_cast<std::size_t>(y) * width_ + x)];
      const std::size_t id = rgb[0] + (std::size_t{rgb[1]} << 8) + (std::size_t{rgb[2]} << 16);
      found.push_back(id < is_it.size() && is_it[id]);
    }
  }
  return found;
}

}  // namespace physpring
